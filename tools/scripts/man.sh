#!/bin/sh
# man.sh PROGRAM FOLDER: makes manual pages of the program and its commands with help2man.
program=$1 folder=$2
if ! command -v help2man >/dev/null; then
    echo "no manual pages: no help2man here"
    exit 0
fi
mkdir -p "$folder" || exit 1
version=$("$program" --version) || exit 1
commands=$("$program" --help | awk '/^Commands:/ { on = 1; next } /^[^ ]/ { on = 0 } on { print $1 }')
pages="fixsplat $(printf 'fixsplat-%s ' $commands)"
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

# help2man names a manual page after the program that it runs, so a script of that name runs the program.
page() {
    printf '#!/bin/sh\nexec "%s" %s "$@"\n' "$program" "$3" >"$work/$1"
    chmod +x "$work/$1"
    { echo "[see also]"; for other in $pages; do [ $other = $1 ] || echo ".BR $other (1),"; done; } |
        sed '$s/,$//' >"$work/also"
    help2man --no-info --help-option="--help all" --version-string="${version#fixsplat }" --source="$version" \
        --name="$2" --include="$work/also" "$work/$1" >"$folder/$1.1"
}

page fixsplat "renders 3D Gaussian splatting scenes in fixed point" || exit 1
for command in $commands; do
    page fixsplat-$command "$("$program" --help | sed -n "s/^  $command  *//p" | head -n 1)" $command || exit 1
done
