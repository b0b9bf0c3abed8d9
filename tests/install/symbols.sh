#!/bin/sh
# symbols.sh: the shared and the static library must export what the public headers declare PALP_API, all of it and
# nothing else, and lib/palpate.map must list just that; tests/lib/test_null*.c must know all that takes a pointer. With --map it prints the map that the headers ask for.
set -eu
cd "$(dirname "$0")/../.."
BUILD=${BUILD:-build}

declared() {
    cat include/palpate/*.h | tr '\n' ' ' | grep -o 'PALP_API [^;(]*(' | grep -o 'palp_[a-z0-9_]*($' | tr -d '(' | LC_ALL=C sort
}

if [ "${1-}" = --map ]; then
    echo "/* palpate.map: what the shared library exports; \`make symbols\` writes it from the headers. */"
    echo "PALPATE_0 {"
    echo "global:"
    declared | sed 's/.*/    &;/'
    echo "local:"
    echo "    *;"
    echo "};"
    exit
fi

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
declared >"$work/headers"
[ -s "$work/headers" ] || { echo "no PALP_API function found in the headers"; exit 1; }
sed -n 's/^ *\(palp_[a-z0-9_]*\);$/\1/p' lib/palpate.map | LC_ALL=C sort >"$work/map"
nm -D --defined-only "$BUILD/libpalpate.so" | awk '$2 != "A" { sub(/@.*/, "", $3); print $3 }' | LC_ALL=C sort >"$work/exported"
diff -u "$work/headers" "$work/map" || { echo "lib/palpate.map is not what the headers declare: make symbols"; exit 1; }
diff -u "$work/map" "$work/exported" || { echo "the library does not export what lib/palpate.map lists"; exit 1; }
nm --defined-only -g "$BUILD/libpalpate.a" | awk 'NF == 3 { print $3 }' | LC_ALL=C sort >"$work/archive"
diff -u "$work/map" "$work/archive" || { echo "the static library does not export what lib/palpate.map lists"; exit 1; }
cat include/palpate/*.h | tr '\n' ' ' | grep -o 'PALP_API [^;]*;' | grep -e '([^)]*[*[]' | grep -o 'palp_[a-z0-9_]*(' | while read -r name; do
    cat tests/lib/test_null*.c | grep -qF "$name" || { echo "tests/lib/test_null*.c have no row for $name)"; exit 1; }
done
echo "$(wc -l <"$work/exported") functions exported, as declared"
