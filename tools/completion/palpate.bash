# palpate.bash: completion for bash: commands, options and their choices as palpate's own help names them; else files.
_palpate() {
    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command=${COMP_WORDS[1]} words=
    COMPREPLY=()
    if [ "$COMP_CWORD" -eq 1 ] || [ "$before" = help ]; then
        words="$(palpate --help | sed -n 's/^  \([a-z][a-z-]*\)  .*/\1/p') help --help --version"
    elif [ "${word:0:1}" = - ]; then
        words=$(palpate help "$command" 2>/dev/null | sed -n 's/^  \(--[A-Za-z-]*\).*/\1/p')
    elif [ "${before:0:2}" = -- ]; then
        words=$(palpate help "$command" 2>/dev/null | sed -n "s/^  $before \([a-z0-9_]*|[a-z0-9_|]*\)\( .*\)*\$/\1/p" | tr '|' ' ')
    fi
    # shellcheck disable=SC2207 # none of the words has a blank
    [ -z "$words" ] || COMPREPLY=($(compgen -W "$words" -- "$word"))
}
complete -o default -F _palpate palpate
