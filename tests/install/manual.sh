#!/bin/sh
# manual.sh: the manual pages can be made, and each command's names the options that its --help names.
set -eu
cd "$(dirname "$0")/../.."
BUILD=${BUILD:-build} MAKE=${MAKE:-make}
command -v scdoc >/dev/null || { echo "there is no scdoc"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

options() { grep -o -e '--[a-z][A-Za-z-]*' | LC_ALL=C sort -u; }

$MAKE --no-print-directory man BUILD="$BUILD"
for header in include/palpate/*.h; do
    grep -qF "*${header##*/}*" doc/palpate.3.scd || { echo "palpate(3) does not name ${header##*/}"; exit 1; }
done
for page in doc/palpate-*.1.scd; do
    command=${page#doc/palpate-} command=${command%.1.scd}
    "$BUILD/palpate" "$command" --help | sed -n 's/^  \(--[^ ]*\).*/\1/p' | options >"$work/help"
    sed -n 's/^\\fB\(--[^\\]*\)\\fR.*/\1/p' "$BUILD/man/palpate-$command.1" | options >"$work/page"
    [ "$(wc -l <"$work/help")" -gt 1 ] || { echo "palpate $command --help names no options"; exit 1; }
    diff -u "$work/help" "$work/page" || { echo "$page (+) is not in line with palpate $command --help (-)"; exit 1; }
done
