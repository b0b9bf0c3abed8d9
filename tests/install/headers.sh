#!/bin/sh
# headers.sh: every public header compiles on its own, twice in a row, in C99 and C++ where there is a compiler; its first
# comment says whether it is stable (version.h), and a stable one includes stable ones only.
set -eu
cd "$(dirname "$0")/../.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/windows"
echo 'typedef struct _iobuf FILE;' >"$work/windows/stdio.h"
first() { sed '/\*\//q' "include/palpate/$1" | tr -s ' *\n' ' '; }
stable() { first "$1" | grep -q '\bStable\.'; }
for h in include/palpate/*.h; do
    stable "${h##*/}" || first "${h##*/}" | grep -q "\bMay change\." || [ "$h" = include/palpate/palpate.h ] ||
        { echo "$h: the first comment does not say Stable. or May change."; exit 1; }
    ! stable "${h##*/}" || for used in $(sed -n 's|^.include <palpate/\([^>]*\)>.*|\1|p' "$h"); do
        stable "$used" || { echo "$h is stable and includes $used, which may change"; exit 1; }
    done
    name=palpate/${h##*/}
    for cc in "gcc -std=c99 -x c" "clang -std=c99 -x c" "g++ -std=c++11 -x c++" "clang++ -std=c++11 -x c++"; do
        command -v "${cc%% *}" >/dev/null || continue
        # shellcheck disable=SC2086
        printf '#include <%s>\n#include <%s>\nint palpate_header_check(void);\n' "$name" "$name" |
            $cc -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror -Iinclude -c -o "$work/o" - ||
            { echo "$name does not stand alone ($cc)"; exit 1; }
    done
    for language in c c++; do # what Microsoft's compiler sees; stdio.h is the system's
        command -v clang >/dev/null || continue
        clang -x $language -target x86_64-pc-windows-msvc -fms-extensions -ffreestanding -Wall -Wextra -Werror -Iinclude -isystem "$work/windows" \
            -fsyntax-only "$h" || { echo "$name is not for Windows ($language)"; exit 1; }
    done
done
