#!/bin/sh
# symbols.sh: the shared and the static library must export what the public headers declare PALP_API, all of it and
# nothing else, and lib/palpate.map must list just that; tests/lib/test_null*.c must know all that takes a pointer.
# lib/palpate.abi must list the declarations of the headers, so that no function, structure or constant changes unseen.
#   --map   prints the map that the headers ask for
#   --abi   prints that list; fails if a released soname would get another interface (CHANGELOG.md says what is unreleased)
set -eu
cd "$(dirname "$0")/../.."
BUILD=${BUILD:-build}

declared() {
    cat include/palpate/*.h | tr '\n' ' ' | grep -o 'PALP_API [^;(]*(' | grep -o 'palp_[a-z0-9_]*($' | tr -d '(' | LC_ALL=C sort
}

version=$(sed -n 's/^.define PALP_VERSION "\(.*\)"/\1/p' include/palpate/version.h)
case $version in 0.*) major=${version%.*} ;; *) major=${version%%.*} ;; esac

# One declaration a line, without comments, layout and names of parameters.
declarations() {
    for h in include/palpate/*.h; do echo "#include <palpate/${h##*/}>"; done | ${CC:-gcc} -std=c99 -Iinclude -E - |
        awk '/^# /{ on = $3 ~ /^"include\/palpate/ } on && !/^#/' | tr -s ' \n\t' ' ' |
        sed 's/__attribute__((visibility("default"))) *//g' |
        awk 'BEGIN { RS = ";" } { text = text $0 ";"; depth += gsub(/{/, "{") - gsub(/}/, "}") }
             depth == 0 { gsub(/^ +/, "", text); print text; text = "" }' |
        sed -e 's/palp_/@/g; s/\* */*/g' -e '/{/!s/\([ *]\)[a-z_][a-zA-Z0-9_]*\(\(\[[^]]*\]\)*[,)]\)/\1\2/g' -e 's/ \([]),;]\)/\1/g' -e 's/\([[(]\) /\1/g; s/@/palp_/g' |
        grep '[a-z]' | LC_ALL=C sort
}
# What a program built with the recorded interface would miss.
changed() { sed 1d lib/palpate.abi | LC_ALL=C comm -23 - "$1"; }

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
declarations >"$work/declarations"
{ echo "soname libpalpate.so.$major"; cat "$work/declarations"; } >"$work/abi"
if [ "${1-}" = --abi ]; then
    if [ -e lib/palpate.abi ] && [ "$(head -n 1 lib/palpate.abi)" = "soname libpalpate.so.$major" ] &&
        [ -n "$(changed "$work/declarations")" ] && ! grep -q "^## $major[. ].*unreleased" CHANGELOG.md; then
        { echo "libpalpate.so.$major is released, and this would change in it:"; changed "$work/declarations"
          echo "raise PALP_VERSION (include/palpate/version.h), so that the soname changes"; } >&2
        exit 1
    fi
    cat "$work/abi"
    exit
fi
if [ "${1-}" = --map ]; then
    echo "/* palpate.map: what the shared library exports; \`make symbols\` writes it from the headers. */"
    echo "PALPATE_$major {"
    echo "global:"
    declared | sed 's/.*/    &;/'
    echo "local:"
    echo "    *;"
    echo "};"
    exit
fi

declared >"$work/headers"
[ -s "$work/headers" ] || { echo "no PALP_API function found in the headers"; exit 1; }
sed -n 's/^ *\(palp_[a-z0-9_]*\);$/\1/p' lib/palpate.map | LC_ALL=C sort >"$work/map"
nm -D --defined-only "$BUILD/libpalpate.so" | awk '$2 != "A" { sub(/@.*/, "", $3); print $3 }' | LC_ALL=C sort >"$work/exported"
diff -u "$work/headers" "$work/map" || { echo "lib/palpate.map is not what the headers declare: make symbols"; exit 1; }
diff -u "$work/map" "$work/exported" || { echo "the library does not export what lib/palpate.map lists"; exit 1; }
readelf -d "$BUILD/libpalpate.so" | grep -qF "soname: [libpalpate.so.$major]" || { echo "the soname is not libpalpate.so.$major"; exit 1; }
diff -u lib/palpate.abi "$work/abi" || { echo "lib/palpate.abi is not what the headers declare: make symbols"; exit 1; }
nm --defined-only -g "$BUILD/libpalpate.a" | awk 'NF == 3 { print $3 }' | LC_ALL=C sort >"$work/archive"
diff -u "$work/map" "$work/archive" || { echo "the static library does not export what lib/palpate.map lists"; exit 1; }
cat include/palpate/*.h | tr '\n' ' ' | grep -o 'PALP_API [^;]*;' | grep -e '([^)]*[*[]' | grep -o 'palp_[a-z0-9_]*(' | while read -r name; do
    cat tests/lib/test_null*.c | grep -qF "$name" || { echo "tests/lib/test_null*.c have no row for $name)"; exit 1; }
done
echo "$(wc -l <"$work/exported") functions exported, as declared"
