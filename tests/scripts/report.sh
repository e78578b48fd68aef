#!/bin/sh
# Tests tests/run.sh with programs that pass, fail, skip, end early or never end.
. tests/scripts/lib/check.sh
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
mkdir "$work/tests"

program() { { echo '#!/bin/sh'; cat; } >"$work/tests/$1" && chmod +x "$work/tests/$1"; }
program good <<'END'
printf 'noise before\001\377 it\n'
echo 'ok   first "of" <two> & more'
echo '  skipped: no such thing here'
echo 'skip second'
echo '1 passed, 0 failed, 1 skipped'
END
program bad <<'END'
echo '  test.c:7: not so: a[b[0]]>c && "c"'
echo 'FAIL third'
echo 'ok   fourth'
echo '1 passed, 1 failed, 0 skipped'
exit 1
END
program early <<'END'
echo 'ok   fifth'
exit 3
END
program last <<'END'
test -e "$B/tests/results/early.result" && echo 'ok   sixth'
echo '1 passed, 0 failed, 0 skipped'
END

B=$work JOBS=2 ALONE=last sh tests/run.sh last good bad early >"$work/said" 2>&1
check "status" [ $? = 1 ]
check "sum" equal "$(tail -n 1 "$work/said")" '3 passed, 2 failed, 1 skipped'
check "says what was skipped" grep -qx 'good second: no such thing here' "$work/said"
check "says what failed" grep -qx 'bad third' "$work/said"
check "says what ended early" grep -qx 'early early: ended early (status 3)' "$work/said"
if ! have python3; then
    skip junit.xml "no python3 here"
else
    python3 - "$work/tests/junit.xml" >"$work/read" 2>&1 <<'END'
import sys, xml.etree.ElementTree as xml
for suite in sorted(xml.parse(sys.argv[1]).getroot(), key=lambda suite: suite.get("name")):
    assert suite.tag == "testsuite" and float(suite.get("time")) >= 0
    print(suite.get("name"), suite.get("tests"), suite.get("failures"), suite.get("skipped"))
    for case in suite:
        assert case.tag == "testcase" and case.get("classname") == suite.get("name")
        print("-", case.get("name"), *("".join((inside.tag, ": ", inside.text or "")).strip() for inside in case))
END
    check "junit.xml" equal "$(cat "$work/read")" "bad 2 1 0
- third failure:   test.c:7: not so: a[b[0]]>c && \"c\"
- fourth
early 2 1 0
- fifth
- early: ended early (status 3) failure:
good 2 0 1
- first \"of\" <two> & more
- second skipped:   skipped: no such thing here
last 1 0 0
- sixth"
fi

# ---- Endless tests and signals ---------------------------------------------------------------------------------------

program endless <<'END'
sleep 60 &
(trap '' TERM; sleep 60; sleep 60) &
echo $$ $! >"$B/processes"
echo 'ok   seventh'
wait
END
program patient <<'END'
sleep 2
echo '1 passed, 0 failed, 0 skipped'
END
program liar <<'END'
echo '1 passed, 0 failed, 0 skipped'
exit 4
END
program listener <<'END'
for signal in HUP INT PIPE TERM; do
    sh -c "kill -$signal \$\$; echo FAIL $signal is ignored"
done
[ "$(cat)" ] || echo 'ok   eighth'
echo '1 passed, 0 failed, 0 skipped'
END

none_left() {
    tries=50
    while cut -d ' ' -f 3 $(sed 's|[0-9]*|/proc/&/stat|g' "$work/processes") 2>/dev/null | grep -v Z; do
        [ $((tries -= 1)) -gt 0 ] || return
        sleep 0.1
    done
}

LIMIT=1 JOBS=2 LONG=patient B=$work sh tests/run.sh endless patient >"$work/said" 2>&1
check "limit: status" [ $? = 1 ]
check "limit: says what reached it" grep -qx 'endless endless: reached its limit of 1 seconds' "$work/said"
check "limit: a long test has more time" equal "$(tail -n 1 "$work/said")" '1 passed, 1 failed, 0 skipped'
check "limit: in junit.xml" grep -q '"endless: reached its limit' "$work/tests/junit.xml"
check "limit: no process is left" none_left
rm "$work/processes"
B=$work sh tests/run.sh --one endless >"$work/said" 2>&1 &
until [ -s "$work/processes" ]; do sleep 0.1; done
kill $!
wait $!
check "a signal: no process is left" none_left
B=$work sh tests/run.sh liar >"$work/said" 2>&1
check "says what passed and yet failed" grep -qx 'liar liar: none failed, but status 4' "$work/said"
(trap '' HUP INT PIPE TERM; echo word | B=$work ALONE=listener sh tests/run.sh listener) >"$work/said" 2>&1
check "no signal is ignored, and there is no input" equal "$(grep -E 'FAIL|eighth' "$work/said")" 'ok   eighth'
finish
