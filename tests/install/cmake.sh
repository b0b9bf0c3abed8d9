#!/bin/sh
# cmake.sh: installs into a scratch folder, moves it, and builds examples/cmake there; libpalpate-sim has what sim.h
# declares and needs no NLopt; archives link alone; a wrong version is refused.
set -eu
cd "$(dirname "$0")/../.."
BUILD=${BUILD:-build} MAKE=${MAKE:-make}
command -v cmake >/dev/null && command -v c++ >/dev/null || { echo "no cmake or no C++ compiler: not tried"; exit 0; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "$*"; exit 1; }

$MAKE --no-print-directory install BUILD="$BUILD" DESTDIR="$work/stage" PREFIX=/opt/there >/dev/null
mv "$work/stage/opt/there" "$work/moved" # the package finds itself wherever it is
lib=$work/moved/lib

# What the headers of sim.h declare is in the library, and no solver that fits.
for header in $(sed -n 's,^#include <palpate/\(.*\)>,\1,p' include/palpate/sim.h); do
    tr '\n' ' ' <"include/palpate/$header" | grep -o 'PALP_API [^;(]*(' | grep -o 'palp_[a-z0-9_]*($' | tr -d '('
done | sort >"$work/declared"
nm -D --defined-only "$lib/libpalpate-sim.so" | sed -n 's/.* T \(palp_[a-z0-9_]*\).*/\1/p' | sort >"$work/defined"
[ "$(wc -l <"$work/declared")" -gt 100 ] || fail "sim.h declares $(wc -l <"$work/declared") functions"
[ -z "$(comm -23 "$work/declared" "$work/defined")" ] || fail "libpalpate-sim lacks: $(comm -23 "$work/declared" "$work/defined")"
if ldd "$lib/libpalpate-sim.so" | grep -q nlopt; then fail "libpalpate-sim needs NLopt"; fi

network=$PWD/data/sedef2008/network_27.json
# build NAME: the project that stands in this folder's examples/cmake
build() {
    name=$1
    cmake -S examples/cmake -B "$work/$name" -DCMAKE_PREFIX_PATH="$work/moved" >"$work/log" 2>&1 &&
        cmake --build "$work/$name" >>"$work/log" 2>&1 || fail "$name does not build: $(tail -n 20 "$work/log")"
    "$work/$name/press" "$network" >"$work/pressed" || fail "$name: press failed"
    "$work/$name/minimal" "$network" >"$work/minimal" || fail "$name: minimal failed"
    [ "$(wc -l <"$work/pressed") $(wc -l <"$work/minimal")" = "10 10" ] || fail "$name printed $(cat "$work/pressed" "$work/minimal")"
}
build shared
ldd "$work/shared/press" | grep -q "libpalpate-sim.so.[0-9.]* => $lib" || fail "press is not linked with $lib/libpalpate-sim.so"
cp "$work/pressed" "$work/by_shared"

# The same as archives, and a project that asks for another version.
mkdir "$work/own"
cp -r examples "$work/own"
sed -i 's/palpate::sim)/palpate::sim_static)/; s/palpate::palpate)/palpate::palpate_static)/' "$work/own/examples/cmake/CMakeLists.txt"
(cd "$work/own" && build static)
if ldd "$work/static/press" | grep -q libpalpate; then fail "press is not linked with the archive"; fi
cmp -s "$work/pressed" "$work/by_shared" || fail "the archive answers otherwise: $(diff "$work/pressed" "$work/by_shared")"
for version in 0.2 1.0; do
    sed "s/palpate 0.1 CONFIG/palpate $version CONFIG/" examples/cmake/CMakeLists.txt >"$work/own/examples/cmake/CMakeLists.txt"
    if cmake -S "$work/own/examples/cmake" -B "$work/other" -DCMAKE_PREFIX_PATH="$work/moved" >"$work/log" 2>&1; then fail "version $version is taken"; fi
    grep -q "compatible with requested" "$work/log" || fail "version $version: $(cat "$work/log")"
done
echo "CMake: shared, static and versions work"
