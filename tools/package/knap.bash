# Completion of knap for bash: commands, options and built-in scenarios as the program itself names them.
_knap() {
    local word="${COMP_WORDS[COMP_CWORD]}" before="${COMP_WORDS[COMP_CWORD - 1]}" knap="${COMP_WORDS[0]}" command="${COMP_WORDS[1]}" words
    if ((COMP_CWORD == 1)); then
        words="--help --version $("$knap" --help 2>/dev/null | sed -n '/^Subcommands:/,$ s/^  \([a-z][a-z]*\) .*/\1/p')"
    elif [[ "$word" == -* ]]; then
        words="$("$knap" "$command" --help 2>/dev/null | sed -n 's/^  \(-[^ ]*\).*/\1/p' | tr ',' '\n' | sed 's/[:=].*//')"
    elif [[ "$before" == -s || "$before" == --set ]]; then
        words="$("$knap" schema --markdown 2>/dev/null | sed -n 's/^| `\([a-z_.0-9]*\)`.*/\1=/p')"
        compopt -o nospace
    elif [[ "$command" =~ ^(run|check|mesh|study|sweep)$ ]]; then
        words="$("$knap" list 2>/dev/null)"
    fi
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
    if ((COMP_CWORD > 1)) && [[ "$word" != -* ]]; then
        mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen -f -- "$word")
    fi
}
complete -o filenames -F _knap knap
