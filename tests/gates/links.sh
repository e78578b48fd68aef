#!/bin/sh
# Checks that Markdown pages refer only to links, anchors, paths and files that exist. Fenced code is skipped.
cd "$(dirname "$0")/../.." || exit 1
kept='( -name .git -o -name build -o -name node_modules ) -prune -o'
pages=$(find . $kept -name '*.md' -print | sed 's|^\./||' | sort)
here=${TMPDIR:-/tmp}/links.$$
find . $kept -print | sed 's|^\./||' >"$here"

examples='golden.sh'

faults=$(awk -v examples=" $examples " '
    function says(why) { printf "%s:%d: %s\n", FILENAME, FNR, why }
    function plain(path) {
        while (path ~ /[^\/]+\/\.\.(\/|$)/)
            sub(/[^\/]+\/\.\.(\/|$)/, "", path)
        sub(/^\.\//, "", path)
        sub(/\/$/, "", path)
        return path
    }
    function anchor_of(text) {
        sub(/^#+ +/, "", text)
        text = tolower(text)
        gsub(/[^a-z0-9 _-]/, "", text)
        gsub(/ /, "-", text)
        return text
    }
    function there(path,    pattern, p) {
        if (path !~ /\*/)
            return path in exists
        pattern = path
        gsub(/\./, "[.]", pattern)
        gsub(/\*/, "[^/]*", pattern)
        for (p in exists)
            if (p ~ "^" pattern "$")
                return 1
        return 0
    }
    function check_link(to,    at, anchor, folder) {
        if (to ~ /^[a-z]+:/)
            return
        at = index(to, "#")
        anchor = at ? substr(to, at + 1) : ""
        to = at ? substr(to, 1, at - 1) : to
        folder = FILENAME
        if (!sub(/\/[^\/]*$/, "/", folder))
            folder = ""
        to = to == "" ? FILENAME : plain(folder to)
        if (!(to in exists))
            says("no file " to)
        else if (at && !((to, anchor) in headings))
            says("no heading #" anchor " in " to)
    }
    function check_name(name) {
        sub(/ .*/, "", name)
        if (name ~ /^test_[a-z0-9_]+$/)
            name = name ".c"
        if (name !~ /^[A-Za-z0-9_.\/*-]+\.(c|h|cu|cuh|inc|sh|mk|awk|frag|vert|js|ts|py)$/ || name ~ /\*|^build\// ||
            index(examples, " " name " "))
            return
        gsub(/.*\//, "", name)
        if (!(name in names))
            says("no file is called " name)
    }
    pass == 0 {
        exists[$0] = 1
        sub(/.*\//, "")
        names[$0] = 1
        next
    }
    FNR == 1 { fenced = 0 }
    /^ *```/ { fenced = !fenced; next }
    fenced { next }
    pass == 1 {
        if (/^#+ /) {
            anchor = anchor_of($0)
            again = (FILENAME, anchor) in headings ? "-" ++repeated[FILENAME, anchor] : ""
            headings[FILENAME, anchor again] = 1
        }
        next
    }
    {
        for (rest = $0; match(rest, /\]\([^) ]*\)/); rest = substr(rest, RSTART + RLENGTH))
            check_link(substr(rest, RSTART + 2, RLENGTH - 3))
        for (rest = $0; match(rest, /`[^`]+`/); rest = substr(rest, RSTART + RLENGTH))
            check_name(substr(rest, RSTART + 1, RLENGTH - 2))
        rest = " " $0
        while (match(rest, /[^A-Za-z0-9_.\/~-](src|kernels|port|tools|tests|make|docs)\/[A-Za-z0-9_.\/*-]*/)) {
            path = substr(rest, RSTART + 1, RLENGTH - 1)
            rest = substr(rest, RSTART + RLENGTH)
            sub(/[.\/-]*$/, "", path)
            if (!there(path))
                says("no file " path)
        }
    }' pass=0 "$here" pass=1 $pages pass=2 $pages)
rm -f "$here"

if [ -n "$faults" ]; then
    printf '%s\n' "$faults"
    echo "FAIL links"
    exit 1
fi
echo "ok   links"
