#!/bin/sh
# tests/run.sh NAME...: runs test programs, scripts and gates, $JOBS at once; those in $ALONE run alone. A program or
# script ends with "N passed, N failed, N skipped". A gate prints "ok", "FAIL" or "skip". Writes junit.xml. LIMIT:
# seconds per test (600); names in $LONG have six times as long.
B=${B:-build}
results=$B/tests/results

# run_one NAME: writes a test's output, and "passed failed skipped seconds processor-seconds name", to the results
# folder.
run_one() {
    name=$1 log=$results/$1.log limit=${LIMIT:-600} fault=
    set -- "$B/tests/$name"
    for folder in scripts gates; do
        [ ! -e "tests/$folder/$name" ] || set -- sh "tests/$folder/$name"
    done
    case " $LONG " in *" $name "*) limit=$((limit * 6)) ;; esac
    start=$(date +%s.%N)
    timeout -k 10 "$limit" env --default-signal "$@" >"$log" 2>&1 </dev/null &
    group=$!
    trap 'kill $group; wait $group; kill -s KILL -- -$group; exit 1' HUP INT TERM
    wait $group
    status=$?
    kill -s KILL -- -$group 2>/dev/null
    seconds=$(awk "BEGIN { print $(date +%s.%N) - $start }")
    last=$(tail -n 1 "$log")
    if printf '%s\n' "$last" | grep -Eqx '[0-9]+ passed, [0-9]+ failed, [0-9]+ skipped'; then
        counts=$(printf '%s\n' "$last" | tr -dc '0-9 ')
        case $status/$last in [!0]*', 0 failed,'*) fault="none failed, but status $status" ;; esac
    elif [ ! -e "tests/gates/$name" ]; then
        fault="ended early (status $status)"
    else
        case $status in 0) counts='1 0 0' ;; 77) counts='0 0 1' ;; *) counts='0 1 0' ;; esac
        case $counts in *1\ 0) grep -q '^FAIL' "$log" || fault="status $status" ;; esac
    fi
    case $status in 124 | 137) [ "${seconds%.*}" -lt "$limit" ] || fault="reached its limit of $limit seconds" ;; esac
    [ -z "$fault" ] || { counts='0 1 0'; echo "FAIL $name: $fault" >>"$log"; }
    times >"$results/$name.times"
    echo "$counts $seconds $(awk 'END { gsub(/[ms]/, " "); print $1 * 60 + $2 + $3 * 60 + $4 }' \
        "$results/$name.times") $name" >"$results/$name.result"
    until mkdir "$results/lock" 2>/dev/null; do sleep 0.1; done
    echo "== $name"
    cat "$log"
    rmdir "$results/lock"
}

if [ "$1" = --one ]; then
    [ -z "$2" ] || run_one "$2"
    exit 0
fi

# Scripts that call make must not use the job server of the outer make.
MAKEFLAGS=$(printf '%s\n' "$MAKEFLAGS" | sed -e 's/ *-j[0-9]*//' -e 's/ *--jobserver-[a-z]*=[0-9a-zA-Z:,/_-]*//g')
export MAKEFLAGS
unset MAKELEVEL
rm -rf "$results"
mkdir -p "$results" || exit 1
built() { ls -l --full-time "$B/fixsplat" "$B/probe.mk" "$B"/with 2>/dev/null; }
built_before=$(built)

is_alone() { case " $ALONE " in *" $1 "*) ;; *) false ;; esac; }
for name; do
    is_alone "$name" || echo "$name"
done | xargs -P "${JOBS:-1}" -n 1 sh tests/run.sh --one
for name; do
    is_alone "$name" && sh tests/run.sh --one "$name"
done

# A test must not rebuild the programs that other tests run.
if [ "$built_before" != "$(built)" ]; then
    echo "FAIL run.sh: a test built $B/fixsplat anew" | tee "$results/run.sh.log"
    echo "0 1 0 0 0 run.sh" >"$results/run.sh.result"
fi

cd "$results" || exit 1
section() { awk -v title="== $1" 'NR == 1 { print title } { print }'; }
awk '/^  skipped: / { why = ": " substr($0, 12); next }
    /^skip / { print FILENAME " " substr($0, 6) why; why = "" }' *.log | sed 's/\.log / /' | section skipped
grep '^FAIL' *.log /dev/null | sed 's/\.log:FAIL / /' | section failed
cat *.result >all
sort -k 4rn all | awk 'NR <= 10 { printf "%4.0f (%.0f) %s\n", $4, $5, $6 }' |
    section "slowest, seconds (of a processor)"

# Each log is a <testsuite>. Each line with ok, FAIL or skip is a <testcase>, after the lines with its reason.
awk '{ print $4, $6 }' all | while read -r seconds name; do
    LC_ALL=C tr -d '\000-\010\013-\037' <"$name.log" | LC_ALL=C tr '\177-\377' '?' |
        awk -v suite="$name" -v seconds="$seconds" '
            function escaped(text) {
                gsub(/&/, "\\&amp;", text); gsub(/</, "\\&lt;", text); gsub(/>/, "\\&gt;", text)
                gsub(/"/, "\\&quot;", text)
                return text
            }
            !/^(ok|FAIL|skip) / { why = why $0 "\n"; next }
            {
                inside = $1 == "FAIL" ? "failure" : $1 == "skip" ? "skipped" : ""
                number[$1]++
                sub(/^[a-zA-Z]+ +/, "")
                cases = cases "<testcase classname=\"" suite "\" name=\"" escaped($0) "\">" \
                    (inside ? "<" inside ">" escaped(why) "</" inside ">" : "") "</testcase>\n"
                why = ""
            }
            END {
                printf "<testsuite name=\"%s\" time=\"%.3f\" tests=\"%d\" failures=\"%d\" skipped=\"%d\">\n",
                    suite, seconds, number["ok"] + number["FAIL"] + number["skip"], number["FAIL"], number["skip"]
                printf "%s</testsuite>\n", cases
            }'
done >suites
{ printf '%s\n' '<?xml version="1.0" encoding="US-ASCII"?>' '<testsuites>'; cat suites; echo '</testsuites>'; } \
    >../junit.xml

awk '{ passed += $1; failed += $2; skipped += $3 }
    END { printf "%d passed, %d failed, %d skipped\n", passed, failed, skipped; exit failed != 0 }' all
