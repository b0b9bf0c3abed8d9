#!/bin/sh
# format.sh: the shape of the C sources. Without an argument: no line is longer than the 110 columns that CONTRIBUTING.md
# promises. With --style: clang-format, of the version that .clang-format was written for, would change nothing.
set -u
cd "$(dirname "$0")/.." || exit 1
# The tables are a script's output, which is compared with it as it is.
files=$(find lib include tools firmware tests bench examples -name '*.[ch]' ! -name indentation_tables.h | sort)

if [ "${1-}" = --style ]; then
    case $(clang-format --version 2>/dev/null) in
    *" 14."*) exec clang-format --dry-run -Werror $files ;;
    *) echo "there is no clang-format 14"; exit 77 ;;
    esac
fi
# Characters, not bytes: a letter beyond ASCII takes one column.
LC_ALL=C.UTF-8 awk 'length > 110 { printf "%s:%d: %d columns\n", FILENAME, FNR, length; long = 1 } END { exit long }' $files
