#!/bin/sh
# Mutation testing. Makes small random changes of the code (tests/mutants.awk). For each change, builds a copy of the
# tree and runs tests until one fails. A surviving change needs a test, unless its effect is invisible.
#
#     sh tests/mutants.sh [SEED] [COUNT] [FILES]              FILES: a pattern of grep -E for paths
#     sh tests/mutants.sh --show SEED N [FILES]               prints the diff of change N of a seed
#
# JOBS: number of parallel changes. FOLDER: keeps the copies of the tree there, for a faster second run.
show=
[ "$1" != --show ] || { show=1; shift; }
seed=${1:-1} count=${2:-30} pattern=${3:-.}
JOBS=${JOBS:-$(nproc)}
case $(uname -m) in x86_64) simd=x86 ;; *) simd=arm ;; esac

draw() {
    find src kernels/*.[ch] kernels/gl kernels/gles kernels/fit kernels/simd/lanes kernels/simd/$simd port/backend \
        port/gl port/http port/posix port/window port/board/*.[ch] tools -name '*.[ch]' -o -name '*.inc' | grep -v cuda | grep -E -- "$pattern" | LC_ALL=C sort |
        xargs awk -v seed="$seed" -v count="$count" -f tests/mutants.awk
}

changed() {
    TEXT=$3 awk -v line="$2" '{ print FNR == line ? ENVIRON["TEXT"] : $0 }' "$1"
}

tab=$(printf '\t')
if [ "$show" ]; then
    draw | sed -n "$count p" | while IFS=$tab read -r file line old new; do
        changed "$file" "$line" "$new" | diff -u --label "a/$file" --label "b/$file" "$file" -
    done
    exit
fi

if [ -z "$FOLDER" ]; then
    folder=$(mktemp -d /tmp/mutants-XXXXXX) || exit 1
    trap 'rm -rf "$folder"' EXIT
    trap 'exit 1' INT TERM
else
    mkdir -p "$FOLDER" && folder=$(cd "$FOLDER" && pwd) || exit 1
fi
export FXS_SCENES=$folder/none     # captured scenes are too slow
ulimit -c 0
ulimit -v 8388608

build() {
    make -s -f Makefile -f "$folder/keep.mk" CFLAGS=-O1 NVCC=none "$@"
}

names() { make -n NVCC=none "$1" | sed -n 's/.* tests\/run\.sh *//p' | tr ' ' '\n'; }

built_for() {
    case $1 in
    *.sh) echo build/fixsplat ;;
    *) echo "build/tests/$1" ;;
    esac
}

by_words() {
    file=$1
    shift
    printf '%s\n' "$@" | awk -v file="$file" 'BEGIN { for (n = split(file, words, /[^a-z0-9]+/); n; n--) has[words[n]] }
        { shared = 0
          for (n = split($0, words, /[_.]/); n; n--)
              shared += words[n] != "test" && words[n] != "sh" && words[n] in has
          print shared, $0 }'
}

# candidates FILE: prints "WORDS NAME" for each test NAME that may detect a change of FILE. WORDS is the number of
# words that NAME shares with FILE.
candidates() {
    by_words "$1" $programs
    by_words "$1" $long | grep -v '^0'
    case $1 in
    tools/*) by_words "$1" $scripts | grep -v '^0'; printf '0 %s\n' cli.sh films.sh ;;
    port/http/*) echo 1 serve.sh ;;
    port/posix/*) printf '0 %s\n' files.sh cli.sh cameras.sh levels.sh ;;
    esac
}

ordered() {
    candidates "$1" | awk -v times="$folder/times" 'BEGIN { while ((getline <times) > 0) time[$2] = $1 }
        $2 in time { print $1, time[$2], $2 }' | sort -k 1,1rn -k 2,2n | awk '!seen[$3]++ { print $3 }'
}

sums() { find build/src build/kernels build/port build/tools -name '*.o' -exec cksum {} + | LC_ALL=C sort; }

symbols() { nm --defined-only -f posix "$@" | awk 'NF > 2 { print $1 }' | sort -u; }

run_test() {
    limit=$(awk -v name="$1" '$2 == name { print int($1 * 4 + 10) }' "$folder/times")
    case $1 in
    *.sh) timeout "$limit" sh "tests/scripts/$1" >test.log 2>&1 ;;
    *) timeout "$limit" "build/tests/$1" >test.log 2>&1 ;;
    esac
}

# Prints the outcome of a change, with the name of the failed test.
judge() {
    build all >build.log 2>&1 || { echo "does not compile"; return; }
    objects=$(sums | comm -23 - "$folder/sums" | cut -d ' ' -f 3)
    [ "$objects" ] || { echo "same code"; return; }
    symbols -g $objects >changed.symbols
    for test in $(ordered "$1"); do
        case $test in *.sh) ;; *) comm -12 changed.symbols "$folder/symbols.$test" | grep -q . || continue ;; esac
        build "$(built_for "$test")" >build.log 2>&1 || { echo "does not compile"; return; }
        run_test "$test" || { echo "caught by $test"; return; }
    done
    echo SURVIVED
}

restore() {
    find build "$1" -newer "$folder/stamp.$2" -type f | while read -r file; do
        cp -p "$folder/tree/$file" "$file"
    done
}

work() {
    cd "$folder/tree.$1" || exit 1
    number=0
    while IFS=$tab read -r file line old new; do
        number=$((number + 1))
        mkdir "$folder/taken/$number" 2>/dev/null || continue
        start=$(date +%s)
        touch "$folder/stamp.$1"
        changed "$file" "$line" "$new" >changed.c && cat changed.c >"$file"
        outcome=$(judge "$file")
        restore "$file" "$1" 2>/dev/null
        printf '%s %s, %d s: %s:%s\n  - %s\n  + %s\n' $number "$outcome" $(($(date +%s) - start)) "$file" "$line" \
            "${old#"${old%%[! ]*}"}" "${new#"${new%%[! ]*}"}"
    done <"$folder/list"
}

draw >"$folder/list"
[ -s "$folder/list" ] || { echo "no file is called $pattern"; exit 1; }
checked=$(names check)
programs=$(echo "$checked" | grep -v '\.sh$')
long=$(names test | grep '^test_' | grep -Fvx "$checked")
scripts=$(names test | grep '\.sh$' | while read -r name; do [ ! -e "tests/scripts/$name" ] || echo "$name"; done)
wanted=$(cut -f 1 "$folder/list" | sort -u | while read -r file; do candidates "$file"; done |
    cut -d ' ' -f 2 | sort -u)
echo .SECONDARY: >"$folder/keep.mk"
rm -rf "$folder"/tree.* "$folder/taken"
mkdir -p "$folder/tree" "$folder/taken"
tar cf - Makefile make src kernels port tools tests | tar xf - -C "$folder/tree" || exit 1

cd "$folder/tree" || exit 1
build -j"$JOBS" all $(for test in $wanted; do built_for "$test"; done) >build.log 2>&1 ||
    { cat build.log; exit 1; }
sums >"$folder/sums"
for test in $wanted; do
    case $test in *.sh) ;; *) symbols "build/tests/$test" >"$folder/symbols.$test" ;; esac
done
B=build JOBS=$JOBS sh tests/run.sh $wanted >run.log
awk '$2 == 0 { print $4, $6 }' build/tests/results/*.result >"$folder/times"
awk '$2 { print "red without a change, and left out: " $6 }' build/tests/results/*.result

for job in $(seq "$JOBS"); do
    cp -a "$folder/tree" "$folder/tree.$job"
    work "$job" >"$folder/out.$job" &
done
wait
cat "$folder"/out.* | sed 'N; N; s/\n/\r/g' | sort -n | tr '\r' '\n' >"$folder/report"
cat "$folder/report"
of() { grep -Ec "^[0-9]+ $1" "$folder/report"; }
echo "$(of .) changes: $(of caught) caught, $(of SURVIVED) survived, $(of 'same code') are the same code," \
    "$(of 'does not') do not compile"
