#!/bin/sh
# Tests texts of the command fixsplat: help, suggestions, --quiet, man pages and completions.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh

share=$work/share
says() { grep -Eq -- "$2" "$1" || { cat "$1"; return 1; }; }
silent() { [ ! -s "$1" ] || { cat "$1"; return 1; }; }

# ---- Help ------------------------------------------------------------------------------------------------------------

commands=$("$fixsplat" --help | awk '/^Commands:/ { on = 1; next } /^[^ ]/ { on = 0 } on { print $1 }')
check "commands" equal "$(echo $commands)" "render view info convert fit compare mesh collide select publish make-scene bench demo doctor associate"
for command in $commands; do
    "$fixsplat" "$command" --help >logs/wanted
    for way in "help $command" "$command -h" "$command --json -h"; do
        [ "$way" != "$command --json -h" ] || [ "$command" = info ] || continue
        succeeds "$way" $way
        check "$way: as --help" cmp logs/out logs/wanted
    done
    succeeds "$command -V" "$command" -V
    check "$command -V: the version" equal "$(cat logs/out)" "$("$fixsplat" --version)"
done

"$fixsplat" help --table >logs/table
for command in $commands; do
    count=$(cut -f 1 logs/table | grep -cx -- "$command")
    "$fixsplat" "$command" --help >logs/short
    "$fixsplat" "$command" --help all >logs/all
    check "$command --help all: every option" equal "$(grep -cE '^  (-[a-zA-Z], )?--[a-z]' logs/all)" "$count"
    for way in "help $command all" "$command -h all" "$command --help=all"; do
        succeeds "$way" $way
        check "$way: as --help all" cmp logs/out logs/all
    done
    if [ "$count" -gt 12 ]; then
        shown=$(grep -cE '^  (-[a-zA-Z], )?--[a-z]' logs/short)
        check "$command --help: at most ten options, three examples" equal \
            "$([ "$shown" -ge 8 ] && [ "$shown" -le 10 ] && grep -c '^  [$] ' logs/short)" 3
        check "$command --help: its last line" equal "$(tail -n 1 logs/short)" \
            "fixsplat $command --help all: $((count - shown)) more options"
    else
        check "$command --help: every option" cmp logs/short logs/all
    fi
done
fails "--help of another word" 2 "--help=most: expected all" render --help=most
for topic in cameras formats backends; do
    succeeds "help $topic" help $topic
    check "help $topic: says something" says logs/out '^  '
done
"$fixsplat" help formats >logs/formats
sed -n '/^    Scenes, by the endings/,/^[^ ]/ s/^    //p' "$root/docs/convert.md" >logs/page
check "help formats: the list of docs/convert.md" sh -c 'grep -v "^$" logs/formats | diff - logs/page'
"$fixsplat" make-scene knot --count 500 -o knot.ply 2>/dev/null
succeeds "version" version
fails "help: two words" 2 "takes one" help render view
fails "help: nothing near" 2 "no help on 'zzzzzz'; see" help zzzzzz
fails "help: near" 2 "did you mean cameras" help camera
fails "a command that is near" 2 "no command 'rendr'; did you mean render" rendr x.ply
fails "a command that is not" 2 "no command 'frobnicate'; see" frobnicate
fails "an option that is near" 2 "unknown option: --szie; did you mean --size" info --szie 3x3
fails "an option that is not" 2 "unknown option: --zzzzzz; see" info --zzzzzz
fails "a letter that is not" 2 "unknown option: -z" info -z
fails "a value that is missing" 2 "render: --size: its value is missing" render x.ply --size
fails "a value that is missing, of an option's beginning" 2 "render: --siz: its value is missing" render x.ply --siz
fails "a value too many, of an option's beginning" 2 "info: --js=3: it takes no value" info x.ply --js=3
fails "an option of another command" 2 "info: unknown option: --orbit, which fixsplat render has; see: fixsplat info" \
    info x.ply --orbit 3
fails "scenes for pictures" 2 "compare takes two pictures, and a.sog is a scene; .* fixsplat info A --compare B$" \
    compare a.sog b.sog
fails "a picture without -o" 2 "render: a.png is a picture: -o is missing before it" render knot.ply a.png
fails "a letter's value that is missing" 2 "render: -o: its value is missing" render x.ply -o
fails "a value too many" 2 "info: --json=3: it takes no value" info x.ply --json=3
fails "a scene in place of a command: as view" 2 "view: --cert needs --web" knot.ply --cert x
fails "another film of ffmpeg" 2 "-o - [|] ffmpeg -i - x.mkv" render knot.ply -o x.mkv

# ---- --quiet ---------------------------------------------------------------------------------------------------------

run convert knot.ply knot.splat
check "a note" says logs/err "cannot hold the SH"
succeeds "--quiet behind the command" convert knot.ply knot.splat --quiet
succeeds "--quiet before it" --quiet convert knot.ply knot.splat
fails "--quiet: errors stay" 1 "none.ply" --quiet convert none.ply knot.splat
succeeds "a file whose name begins with --quiet" convert knot.ply -- --quiet.ply
check "a file whose name begins with --quiet: is there" test -s ./--quiet.ply

{ printf 'ply\nformat ascii 1.0\nelement vertex 3\n'
  printf 'property float %s\n' x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3
  printf '%s\n' end_header '0 0 0 1 0 0 1 -1 -1 -1 1 0 0 0' '1 0 0 1 0 0 1 -1 -1 -1 1 0 0 0' \
      'nan 0 0 1 0 0 1 -1 -1 -1 1 0 0 0'; } >noted.ply
"$fixsplat" render knot.ply --size 64x48 -o a.png
for arguments in 'render noted.ply --size 64x48 -o b.png' 'info noted.ply' 'bench noted.ply --size 64x48' \
    'convert noted.ply b.ply' 'convert noted.ply b.fxs'; do
    run $arguments
    check "$arguments: a note" equal "$status $(grep -c '^fixsplat: noted.ply: left out 1 of 3' logs/err)" "0 1"
    succeeds "$arguments --quiet" $arguments --quiet
    FIXSPLAT_QUIET=1 "$fixsplat" $arguments >logs/out 2>logs/err
    check "$arguments, FIXSPLAT_QUIET" silent logs/err
done
if have script; then
    for arguments in 'make-scene landscape --count 300000 -o c.ply' 'render knot.ply --size 64x48 --orbit 9 -o c.y4m' \
        'convert knot.ply c.sog' 'compare a.png a.png --diff c.png' 'convert c.ply c.fxs'; do
        script -qec "'$fixsplat' $arguments" /dev/null </dev/null >logs/loud
        script -qec "'$fixsplat' $arguments --quiet" /dev/null </dev/null >logs/said
        case $arguments in
        compare*) check "$arguments --quiet: the result alone" equal "$(tr -d '\r' <logs/said)" equal ;;
        *)
            check "$arguments: a bar on a terminal" says logs/loud '%'
            check "$arguments --quiet: nothing on a terminal" silent logs/said ;;
        esac
    done
else
    skip "--quiet on a terminal" "no script(1) here"
fi

# ---- JSON ------------------------------------------------------------------------------------------------------------

"$fixsplat" info --backends --json >logs/backends
"$fixsplat" info knot.ply --json >logs/info
if have python3; then
    check "info --backends --json" python3 - logs/backends <<'END'
import json, sys
all = {b["name"]: b for b in json.load(open(sys.argv[1]))}
assert all["cpu"]["here"] and all["cpu"]["why_not"] is None and all["cpu"]["can"]["trace"], all["cpu"]
assert all["cuda"]["here"] or all["cuda"]["why_not"], all["cuda"]
END
    check "info --json" python3 - logs/info <<'END'
import json, sys
info = json.load(open(sys.argv[1]))
assert len(info["seen"]) == 2 and len(info["seen"][0]) == 3 and info["levels"] == 1, info
END
else
    skip "JSON" "no python3 here"
fi

# ---- Man pages and completions ---------------------------------------------------------------------------------------

check "completions are made" sh "$root/tools/scripts/completions.sh" "$fixsplat" "$share"
if have help2man; then
    check "pages are made" sh "$root/tools/scripts/man.sh" "$fixsplat" "$share/man/man1"
    for page in fixsplat $(for c in $commands; do echo "fixsplat-$c"; done); do
        if have groff; then
            groff -man -ww -Tutf8 "$share/man/man1/$page.1" >logs/page 2>logs/err
            check "$page.1: without a warning" silent logs/err
        fi
        check "$page.1: has its parts" sh -c 'for part in NAME SYNOPSIS DESCRIPTION EXAMPLES "\"SEE ALSO\""; do
            grep -q "^.SH $part" "$0" || { echo "no $part"; exit 1; }; done' "$share/man/man1/$page.1"
    done
    have groff || skip "pages, drawn" "no groff here"
    sed 's/\\-/-/g' "$share/man/man1/fixsplat-render.1" >logs/plain
    check "render's page has every option" sh -c '"$0" help --table | cut -f 1,2 | sed -n "s/^render.//p" >logs/options
        while read -r option; do grep -qE -- "--$option([^a-z-]|\$)" logs/plain || { echo "no $option"; exit 1; }; done \
            <logs/options; [ "$(wc -l <logs/options)" -gt 40 ]' "$fixsplat"
else
    skip "pages" "no help2man here"
fi
mkdir -p bin && ln -sf "$(command -v sh)" bin/sh
check "without help2man: no pages, said" equal "$(PATH=$work/bin sh "$root/tools/scripts/man.sh" "$fixsplat" "$share/none")" \
    "no manual pages: no help2man here"

if have bash; then
    complete() {
        bash -c '. "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _fixsplat; printf "%s\n" "${COMPREPLY[@]}"' \
            "$share/bash-completion/completions/fixsplat" "$@" | tr '\n' ' '
    }
    check "bash: a command" equal "$(complete fixsplat comp)" "compare "
    check "bash: an option" equal "$(complete fixsplat render --orb)" "--orbit "
    check "bash: a value of few" equal "$(complete fixsplat convert x.ply x.fxs --profile '')" "default compact small "
    check "bash: a recipe" equal "$(complete fixsplat fit x --recipe m)" "mcmc "
    check "bash: a topic" equal "$(complete fixsplat help cam)" "cameras "
else
    skip "bash" "not here"
fi
for shell in zsh fish; do
    case $shell in
    zsh) file=zsh/site-functions/_fixsplat ;;
    fish) file=fish/vendor_completions.d/fixsplat.fish ;;
    esac
    if have $shell; then check "$shell: reads it" $shell -n "$share/$file"; else skip "$shell" "not here"; fi
done

finish
