#!/bin/sh
# man.sh PROGRAM FOLDER: a manual page for the command and one for each of its words, of what --help prints.
program=$1 folder=$2
mkdir -p "$folder" || exit 1
version=$("$program" --version) || exit 1
commands=$("$program" --help | awk '/^Commands:/ { on = 1; next } /^[^ ]/ { on = 0 } on { print $1 }')

# page NAME DOES: of the help on standard input.
page() {
    awk -v name="$1" -v does="$2" -v version="$version" -v commands="$commands" '
    function plain(text) { gsub(/\\/, "\\e", text); gsub(/-/, "\\-", text); return text }
    function put(text) { text = plain(text); print (text ~ /^[.'\'']/ ? "\\&" : "") text }
    function section(title) { print ".SH " title; fresh = 1; examples = 0 }
    function is_item(i) { return line[i] ~ /^  ? ?[^ ]/ }
    { line[NR] = $0 }
    END {
        printf ".TH %s 1 - \"%s\" \"User commands\"\n", plain(toupper(name)), version
        section("NAME")
        put(name " - " does)
        for (i = 1; i <= NR; i++) {
            text = line[i]
            words = text
            sub(/^ */, "", words)
            if (text ~ /^Usage: /) {
                section("SYNOPSIS")
                print ".nf"
                for (; line[i] != ""; i++) { text = line[i]; sub(/^(Usage:)? */, "", text); put(text) }
                print ".fi"
                section("DESCRIPTION")
            } else if (i == 1) {
                continue
            } else if (text == "Examples:") {
                section("EXAMPLES")
                print ".nf"
                for (i++; i <= NR && line[i] != ""; i++) { text = line[i]; sub(/^ */, "", text); put(text) }
                print ".fi"
            } else if (text ~ /^Exit status: /) {
                section("EXIT STATUS")
                put(substr(text, 14))
            } else if (text ~ /^[^ ].*:$/ && is_item(i + 1)) {
                sub(/:$/, "", text)
                gsub(/"/, "", text)
                print ".SS \"" plain(text) "\""
                fresh = 1
            } else if (is_item(i)) {
                at = match(words, /  +/)
                print ".TP"
                print "\\fB" plain(at ? substr(words, 1, at - 1) : words) "\\fP"
                if (at)
                    put(substr(words, at + RLENGTH))
                listed = 1
                paragraph = fresh = 0
            } else if (text == "") {
                paragraph = 1
            } else {
                if (paragraph && !fresh || listed && text !~ /^ /)
                    print ".PP"
                put(words)
                paragraph = fresh = 0
                listed = listed && text ~ /^ /
            }
        }
        section("SEE ALSO")
        pages = name == "fixsplat" ? "" : "fixsplat(1)"
        count = split(commands, all, /[ \n]+/)
        for (i = 1; i <= count; i++)
            if (name != "fixsplat-" all[i])
                pages = pages (pages == "" ? "" : ", ") "fixsplat-" all[i] "(1)"
        put(pages)
    }'
}

"$program" --help | page fixsplat "renders 3D Gaussian splatting scenes in fixed point" >"$folder/fixsplat.1"
for command in $commands; do
    does=$("$program" --help | sed -n "s/^  $command  *//p" | head -n 1)
    "$program" help "$command" | { echo; page "fixsplat-$command" "$does"; } | sed 1d >"$folder/fixsplat-$command.1"
done
