#!/bin/sh
# Each change of tests/mutants.txt has its place: its fragment stands in its file exactly once.
cd "$(dirname "$0")/../.." || exit 1
lost=$(awk '
    function times_in(file, fragment,    text, at, n) {
        while ((getline text < file) > 0)
            for (; (at = index(text, fragment)) > 0; n++)
                text = substr(text, at + 1)
        close(file)
        return n + 0
    }
    /^#/ || !/ ==> / { next }
    {
        at = index($0, " | ")
        file = substr($0, 1, at - 1)
        fragment = substr($0, at + 3)
        fragment = substr(fragment, 1, index(fragment, " ==> ") - 1)
        n = times_in(file, fragment)
        if (n != 1)
            print NR ": " file " has it " n " times: " fragment
    }' tests/mutants.txt)
if [ "$lost" ]; then
    echo "$lost"
    echo "FAIL mutants: tests/mutants.txt"
    exit 1
fi
echo "ok   mutants"
