# For the tools, which source it: no_options ARGUMENT ... ends the script where an argument is an option, since the script has taken
# those that it knows. With -h or --help it prints the head comment of the script; any other option is an error, exit code 2.
usage() {
    sed -n '2,${/^#/!q; s/^# \{0,1\}//p}' "${BASH_SOURCE[-1]}"
}

no_options() {
    local argument
    for argument in "$@"; do
        case "$argument" in
            -h | --help)
                usage
                exit 0
                ;;
            -*)
                echo "${BASH_SOURCE[-1]##*/}: unknown option $argument; usage:" >&2
                usage >&2
                exit 2
                ;;
        esac
    done
}
