# Sourced by tests of the web server. The caller defines `get` (curl) and `at` (the server's address).

# ready NUMBER [STATE [VERSION]]: waits up to 30 seconds until scene NUMBER has this state and version.
ready() {
    tries=0
    until get "$at/scenes/$1.json" | grep -q "\"state\": \"${2:-ready}\", \"version\": ${3:+$3,}"; do
        [ $((tries += 1)) -lt 300 ] || { get "$at/scenes/$1.json"; return 1; }
        sleep 0.1
    done
}
