#!/bin/sh
# tests/run.sh NAME...: runs these test programs, scripts and gates, $JOBS at once, and adds up their results. A program
# or script prints "N passed, N failed, N skipped" last, a gate "ok", "FAIL" or "skip" and its name. What one prints
# comes in one piece, when it ends. B: the build folder.
B=${B:-build}
results=$B/tests/results

# What takes long, the longest first: the others fill the gaps.
long='processors.sh fuzz.sh test_quality threads_and_cpus.sh matrix.sh test_pack cli.sh test_gles'

# run_one NAME: its output and "passed failed skipped seconds name", in the folder of results.
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
    echo "$counts $seconds $1" >"$results/$1"
    until mkdir "$results/lock" 2>/dev/null; do sleep 0.1; done
    echo "== $1"
    cat "$log"
    rmdir "$results/lock"
}

if [ "$1" = --one ]; then
    run_one "$2"
    exit 0
fi

# What scripts make has the variables of this make, and jobs of its own.
MAKEFLAGS=$(printf '%s\n' "$MAKEFLAGS" | sed -e 's/ *-j[0-9]*//' -e 's/ *--jobserver-[a-z]*=[0-9a-zA-Z:,/_-]*//g')
export MAKEFLAGS
unset MAKELEVEL
rm -rf "$results"
mkdir -p "$results" || exit 1
for name in $long "$@"; do
    case " $* " in *" $name "*) echo "$name" ;; esac
done | awk '!seen[$0]++' | xargs -P "${JOBS:-1}" -n 1 sh tests/run.sh --one

cd "$results" || exit 1
# section TITLE: the lines that come in, where there are any, and the title above them.
section() { awk -v title="== $1" 'NR == 1 { print title } { print }'; }
awk '/^  skipped: / { why = ": " substr($0, 12); next }
    /^skip / { print FILENAME " " substr($0, 6) why; why = "" }' *.log | sed 's/\.log / /' | section skipped
grep '^FAIL' *.log /dev/null | sed 's/\.log:FAIL / /' | section failed
cat $(ls | grep -v '\.log$') >all
sort -k 4rn all | awk '{ print $4, $5 }' | head -n 10 | section "slowest, seconds"
awk '{ passed += $1; failed += $2; skipped += $3 }
    END { printf "%d passed, %d failed, %d skipped\n", passed, failed, skipped; exit failed != 0 }' all
