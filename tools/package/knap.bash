# Completion of knap for bash: commands, options, their values, keys and built-in scenarios as the program itself names them.
# `bash knap.bash offer N WORD...` prints what is offered for the N-th word, a line each; zsh (_knap) and fish (knap.fish) call it.
_knap() {
    local word="${COMP_WORDS[COMP_CWORD]}" before="${COMP_WORDS[COMP_CWORD - 1]}" knap="${COMP_WORDS[0]}" command="${COMP_WORDS[1]}" words="" files="yes" earlier="" names="" help option file key="" name
    # KEY=VALUE is one word, or three where = ends a word, as in bash itself
    if [[ "$word" == "=" ]]; then key="$before" before="${COMP_WORDS[COMP_CWORD - 2]}" word=""
    elif [[ "$before" == "=" ]]; then key="${COMP_WORDS[COMP_CWORD - 2]}" before="${COMP_WORDS[COMP_CWORD - 3]}"
    elif [[ "$before" =~ ^(-s|--set)$ && "$word" == *=* ]]; then key="${word%%=*}" earlier="${word%%=*}="; fi
    if ((COMP_CWORD == 1)); then
        words="--help --version $("$knap" --help 2>/dev/null | sed -n '/^Subcommands:/,$ s/^  \([a-z][a-z]*\) .*/\1/p')"
        files=""
    else
        help="$("$knap" "$command" --help 2>/dev/null)"
        option="$(grep -m 1 -E -- "^  (-[^ ]*,)?$before(,[^ ]*)? (TEXT|INT|UINT|FLOAT|PATH)" <<<"$help" || true)"  # of what has a value
        if [[ "$word" == -* ]]; then
            words="$(sed -n 's/^  \(-[^ ]*\).*/\1/p' <<<"$help" | tr ',' '\n' | sed 's/[:=].*//')"
            files=""
        elif [[ -n "$key" && "$before" =~ ^(-s|--set)$ ]]; then  # its words; of a named table, as interface.default.coupling, those of interface.*
            name="$(sed -E 's/\[[0-9]*\]/\\[\\]/g; s/^([a-z]+)\.([^.]+)(\..*)/&|\1.[*]\3/' <<<"$key")"
            words="$("$knap" schema --markdown 2>/dev/null | sed -n -E "s/^\| \`($name)\` \| (one of ([^|]*)|(true or false)) \|.*/\3\4/p" |
                     sed 's/ or /,/' | tr ', ' '\n\n' | grep -v '[*]')"
            files=""
            word="${word#"$earlier"}"
            earlier+="${word%"${word##*,}"}"  # of a list, for knap sweep
            word="$earlier${word##*,}"
        elif [[ "$before" == -s || "$before" == --set ]]; then
            # in place of *: default, the names in the scenario of this line, the one that was typed
            names="interface.default $(for file in "${COMP_WORDS[@]}"; do
                [[ "$file" == *.toml && -r "$file" ]] && sed -n 's/^ *\[\([a-z]*\.[^]". ]*\)[].].*/\1/p' "$file"
            done | sort -u)"
            if [[ "$word" =~ ^[a-z]+\.[^.=]+\. ]]; then names="$(printf '%s\n' $names "${BASH_REMATCH[0]%.}" | sort -u)"; fi
            while read -r key; do
                if [[ "$key" != *'*'* ]]; then words+=" $key"; continue; fi
                for name in $names; do
                    if [[ "$name" == "${key%%.*}".* ]]; then words+=" $name${key#*'*'}"; fi
                done
            done < <("$knap" schema --markdown 2>/dev/null | sed -n 's/^| `\([a-z][]a-zA-Z_.0-9[*]*\)`.*/\1=/p' | sed 's/\[\]/[0]/g')
            compopt -o nospace
        elif [[ "$before" == -* && "$option" =~ \{([^}]*)\} ]]; then
            words="${BASH_REMATCH[1]//,/ }"
            files=""
            earlier="${word%"${word##*,}"}"  # of a list
        elif [[ "$before" == --from ]]; then
            words="$("$knap" list 2>/dev/null | sed 's/ .*//')"
            files=""
        elif [[ "$before" == -* && -n "$option" ]]; then
            [[ "$option" =~ ^[^A-Z]*PATH ]] || files=""
        elif [[ "$command" =~ ^(run|check|mesh|study|sweep|calibrate)$ ]]; then
            words="$("$knap" list 2>/dev/null | sed 's/ .*//')"
        elif [[ "$command" =~ ^(render|info)$ ]]; then
            files="directories"
        fi
    fi
    mapfile -t COMPREPLY < <(compgen -P "$earlier" -W "$words" -- "${word#"$earlier"}")
    if [[ -z "$files" ]]; then
        compopt +o filenames  # explicit/explicit is none
    else
        mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen $([[ "$files" == directories ]] && echo -d || echo -f) -- "$word")
    fi
}
if [[ "${BASH_SOURCE[0]}" != "$0" ]]; then
    complete -o filenames -F _knap knap
elif [[ "${1:-}" == offer ]]; then
    compopt() { :; }
    COMP_CWORD=$(($2 - 1)) COMP_WORDS=("${@:3}")
    _knap
    for offered in "${COMPREPLY[@]}"; do
        if [[ -d "$offered" && "$offered" != */ ]]; then offered+=/; fi
        printf '%s\n' "$offered"
    done
fi
