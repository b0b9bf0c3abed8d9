#!/bin/sh
# completion.sh: what bash completes: commands, options, choices; and that zsh can read its file.
. tests/cli/common
command -v bash >/dev/null || { echo "there is no bash"; exit 77; }
PATH=$(dirname "$PALPATE"):$PATH
export PATH

# completes WANTED words...: the last word is the one being typed
completes() {
    wanted=$1; shift
    got=$(bash -c '. "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _palpate; echo "${COMPREPLY[*]}"' \
        "$ROOT/tools/completion/palpate.bash" "$@")
    [ "$got" = "$wanted" ] || fail "$*: \"$got\", not \"$wanted\""
}
completes "calibrate-device characterize calibrate" palpate c
completes "calibrate-device calibrate" palpate cal
completes "report reduce" palpate help re
completes "--version" palpate --v
completes "--depth-mm" palpate simulate --dep
completes "ramp_hold" palpate simulate model.json --protocol r
completes "--json" palpate characterize run.csv --j
completes "--force" palpate export --forc
completes "" palpate simulate mod
! command -v zsh >/dev/null || zsh -n "$ROOT/tools/completion/_palpate" || fail "zsh cannot read its file"
done_testing
