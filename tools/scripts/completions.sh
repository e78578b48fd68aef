#!/bin/sh
# completions.sh PROGRAM FOLDER: writes shell completions for bash, zsh and fish below a folder `share`. Commands and
# options come from the program's help.
program=$1 folder=$2
mkdir -p "$folder/bash-completion/completions" "$folder/zsh/site-functions" "$folder/fish/vendor_completions.d" || exit 1
list() { "$program" --help | awk -v title="$1" '$0 == title { on = 1; next } /^[^ ]/ { on = 0 } on { print $1 }'; }
commands=$(list Commands:)
topics=$(list "Topics of help:")
backends="auto $("$program" help backends | awk '/^  / { print $1 }')"
work=$(mktemp) || exit 1
trap 'rm -f "$work"' EXIT

# Writes a line for each option of the program, with tab-separated fields: command, name, letter, value, choices, help.
"$program" help --table | awk -F '\t' -v OFS='\t' -v backends="$(echo $backends)" '
    $4 ~ /^\[/ { $4 = "" }
    $2 == "backend" && $5 == "" { $5 = backends }
    { print }' >"$work"

# options COMMAND: prints the names of a command's options. values and branches BEFORE AFTER: print branches of a
# shell's case statement, for bash and zsh.
options() { awk -F '\t' -v c="$1" '$1 == c { print "--" $2; if ($3 != "") print "-" $3 }' "$work"; }
values() { awk -F '\t' -v before="$1" -v after="$2" '$5 != "" { printf "    \"%s --%s\") %s%s%s ;;\n", $1, $2, before, $5, after }' "$work"; }
branches() { for command in $commands; do echo "    $command) $1$(echo $(options "$command"))$2 ;;"; done; }

cat >"$folder/bash-completion/completions/fixsplat" <<END
_fixsplat()
{
    local word=\${COMP_WORDS[COMP_CWORD]} before=\${COMP_WORDS[COMP_CWORD-1]} names=
    [ "\$word" = = ] && word= || { [ "\$before" = = ] && before=\${COMP_WORDS[COMP_CWORD-2]}; }
    COMPREPLY=()
    case "\${COMP_WORDS[1]} \$before" in
$(values "names='" "'")
    "help help") names='$(echo $commands $topics)' ;;
    esac
    if [ "\$COMP_CWORD" = 1 ]; then
        names='$(echo $commands) help --help --version --quiet --kernels'
    elif [ -z "\$names" ] && [ "\${word#-}" != "\$word" ]; then
        case \${COMP_WORDS[1]} in
$(branches "names='" "'")
        esac
    fi
    [ -z "\$names" ] || COMPREPLY=(\$(compgen -W "\$names" -- "\$word"))
}
complete -o default -F _fixsplat fixsplat
END

cat >"$folder/zsh/site-functions/_fixsplat" <<END
#compdef fixsplat
if (( CURRENT == 2 )); then
    compadd -- $(echo $commands) help --help --version --quiet --kernels
    return
fi
case "\$words[2] \$words[CURRENT-1]" in
$(values "compadd -- " "; return")
    "help help") compadd -- $(echo $commands $topics); return ;;
esac
if [[ \$PREFIX != -* ]]; then
    _files
    return
fi
case \$words[2] in
$(branches "compadd -- " "")
esac
END

{
    for command in $commands help; do
        does=$("$program" --help | sed -n "s/^  $command  *//p" | head -n 1 | tr -d "\\\\'")
        echo "complete -c fixsplat -n __fish_use_subcommand -f -a $command -d '$does'"
    done
    echo "complete -c fixsplat -n '__fish_seen_subcommand_from help' -f -a '$(echo $commands $topics)'"
    awk -F '\t' '{
        gsub(/[\\\047]/, "", $6)
        sub(/[.;:(].*/, "", $6)
        printf "complete -c fixsplat -n \047__fish_seen_subcommand_from %s\047 -l %s", $1, $2
        printf "%s%s -d \047%s\047\n", $3 == "" ? "" : " -s " $3,
               $5 != "" ? " -x -a \047" $5 "\047" : $4 != "" ? " -r -F" : "", $6
    }' "$work"
} >"$folder/fish/vendor_completions.d/fixsplat.fish"
