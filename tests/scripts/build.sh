#!/bin/sh
# A build after a change of compiler, flags or libraries found; setup beside another apt-get.
. tests/scripts/lib/check.sh
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
object=$work/build/tools/backend.o

# A compiler that does not find the header named in HIDDEN.
cat >"$work/cc" <<'END'
#!/bin/sh
case " $* " in
*' -E '*) cat >"$0.probe"; [ "$HIDDEN" ] && grep -q "$HIDDEN" "$0.probe" && exit 1; exec cc "$@" <"$0.probe" ;;
esac
exec cc "$@"
END
chmod +x "$work/cc"

# build HIDDEN OPTION...: the object that the back ends are in. Prints whether it was made anew.
build() {
    HIDDEN=$1
    export HIDDEN
    shift
    env -u MAKEFLAGS make B="$work/build" CC="$work/cc" NVCC=none "$@" "$object" >"$work/log" 2>&1 || cat "$work/log"
    if grep -q -- '-c -o' "$work/log"; then echo anew; else echo kept; fi
}

# is NAME EXPECTED SAID
is() { if [ "$2" = "$3" ]; then ok "$1"; else fail "$1" "$3"; fi; }

is "first: built" anew "$(build osmesa.h)"
is "the same again: kept" kept "$(build osmesa.h)"
if echo '#include <GL/osmesa.h>' | cc -E -x c - >/dev/null 2>&1; then
    is "a library found: built anew" anew "$(build '')"
    check "a library found: used" grep -q fxs_osmesa_open "$object"
    is "a library gone: built anew" anew "$(build osmesa.h)"
else
    skip "a library found" "no GL/osmesa.h here"
fi
is "other flags: built anew" anew "$(build osmesa.h CFLAGS=-O1)"
is "other flags again: kept" kept "$(build osmesa.h CFLAGS=-O1)"
is "flags with quotes: built anew" anew "$(build osmesa.h CFLAGS="-DWORDS='\"it is\"'")"
is "flags with quotes again: kept" kept "$(build osmesa.h CFLAGS="-DWORDS='\"it is\"'")"
echo '# other' >>"$work/cc"
sed -i 's/^exec cc "$@"$/case $1 in --version) echo other ;; *) exec cc "$@" ;; esac/' "$work/cc"
is "another version of the compiler: built anew" anew "$(build osmesa.h CFLAGS="-DWORDS='\"it is\"'")"

# ---- Setup beside another apt-get ------------------------------------------------------------------------------------

mkdir "$work/bin"
cat >"$work/bin/apt-get" <<'END'
#!/bin/sh
echo "$@" >>"$APT_LOG"
case $* in
*update*) [ "$(grep -c update "$APT_LOG")" -gt 2 ] || { echo "E: Could not get lock lists/lock." >&2; exit 100; } ;;
esac
END
echo 'exit 1' >"$work/bin/dpkg-query"
echo 'exit 0' >"$work/bin/sleep"
echo 'exec "$@"' >"$work/bin/sudo"
chmod +x "$work/bin"/*
check "setup: ends well" env PATH="$work/bin:$PATH" APT_LOG="$work/apt" sh tools/setup.sh one two
check "setup: waits for the lock of update" [ "$(grep -c update "$work/apt")" = 3 ]
check "setup: installs, waiting for the lock of dpkg" grep -q 'Lock::Timeout=300 install .*one two$' "$work/apt"
finish
