#!/bin/sh
# tests/run.sh NAME...: runs these test programs, scripts and gates, $JOBS at once, and adds up their results. A program
# or script prints "N passed, N failed, N skipped" last, a gate "ok", "FAIL" or "skip" and its name. What one prints
# comes in one piece, when it ends. B: the build folder.
B=${B:-build}
results=$B/tests/results

# What takes long, the longest first: the others fill the gaps. What waits for a window, or measures, comes alone, at the
# end.
long='web.sh page.sh webgl.sh test_quality processors.sh fuzz.sh threads_and_cpus.sh cli.sh test_pack test_gles build.sh
      xr.sh matrix.sh fit_same.sh test_fit_steps'
alone='window.sh web_speed.sh'

# run_one NAME: its output and "passed failed skipped seconds processor-seconds name", in the folder of results.
run_one() {
    log=$results/$1.log
    start=$(date +%s)
    if [ -e "tests/scripts/$1" ]; then
        sh "tests/scripts/$1" >"$log" 2>&1
    elif [ -e "tests/gates/$1" ]; then
        sh "tests/gates/$1" >"$log" 2>&1
    else
        "$B/tests/$1" >"$log" 2>&1
    fi
    status=$?
    seconds=$(($(date +%s) - start))
    last=$(tail -n 1 "$log")
    if printf '%s\n' "$last" | grep -Eqx '[0-9]+ passed, [0-9]+ failed, [0-9]+ skipped'; then
        counts=$(printf '%s\n' "$last" | tr -dc '0-9 ')
    elif [ ! -e "tests/gates/$1" ]; then
        counts='0 1 0'
        echo "FAIL $1: ended early (status $status)" >>"$log"
    else
        case $status in 0) counts='1 0 0' ;; 77) counts='0 0 1' ;; *) counts='0 1 0' ;; esac
    fi
    times >"$results/$1.times"
    echo "$counts $seconds $(awk 'END { gsub(/[ms]/, " "); print int($1 * 60 + $2 + $3 * 60 + $4 + 0.5) }' \
        "$results/$1.times") $1" >"$results/$1.result"
    until mkdir "$results/lock" 2>/dev/null; do sleep 0.1; done
    echo "== $1"
    cat "$log"
    rmdir "$results/lock"
}

if [ "$1" = --one ]; then
    [ -z "$2" ] || run_one "$2"
    exit 0
fi

# What scripts make has the variables of this make, and jobs of its own.
MAKEFLAGS=$(printf '%s\n' "$MAKEFLAGS" | sed -e 's/ *-j[0-9]*//' -e 's/ *--jobserver-[a-z]*=[0-9a-zA-Z:,/_-]*//g')
export MAKEFLAGS
unset MAKELEVEL
rm -rf "$results"
mkdir -p "$results" || exit 1

# chosen NAME...: those of them that are to be run, once each.
chosen() {
    for name in "$@"; do
        case " $wanted " in *" $name "*) echo "$name" ;; esac
    done | awk '!seen[$0]++'
}
wanted=$*
chosen $long "$@" | grep -Fvx "$(printf '%s\n' $alone)" | xargs -P "${JOBS:-1}" -n 1 sh tests/run.sh --one
for name in $(chosen $alone); do
    run_one "$name"
done

cd "$results" || exit 1
# section TITLE: the lines that come in, where there are any, and the title above them.
section() { awk -v title="== $1" 'NR == 1 { print title } { print }'; }
awk '/^  skipped: / { why = ": " substr($0, 12); next }
    /^skip / { print FILENAME " " substr($0, 6) why; why = "" }' *.log | sed 's/\.log / /' | section skipped
grep '^FAIL' *.log /dev/null | sed 's/\.log:FAIL / /' | section failed
cat *.result >all
sort -k 4rn all | awk 'NR <= 10 { printf "%4d (%d) %s\n", $4, $5, $6 }' | section "slowest, seconds (of a processor)"
awk '{ passed += $1; failed += $2; skipped += $3 }
    END { printf "%d passed, %d failed, %d skipped\n", passed, failed, skipped; exit failed != 0 }' all
