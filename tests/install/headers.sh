#!/bin/sh
# headers.sh: every public header compiles on its own, twice in a row, in C99 and C++ where there is a compiler.
set -eu
cd "$(dirname "$0")/../.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for h in include/palpate/*.h; do
    name=palpate/${h##*/}
    for cc in "gcc -std=c99 -x c" "clang -std=c99 -x c" "g++ -std=c++11 -x c++" "clang++ -std=c++11 -x c++"; do
        command -v "${cc%% *}" >/dev/null || continue
        # shellcheck disable=SC2086
        printf '#include <%s>\n#include <%s>\nint palpate_header_check(void);\n' "$name" "$name" |
            $cc -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror -Iinclude -c -o "$work/o" - ||
            { echo "$name does not stand alone ($cc)"; exit 1; }
    done
done
