#!/bin/sh
# run.sh: installs into a scratch folder and builds outside.c against what is there, as a stranger would:
# shared and static, as C and as C++; then uninstalls and looks for leftovers.
set -eu
cd "$(dirname "$0")/../.."
BUILD=${BUILD:-build} MAKE=${MAKE:-make}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
stage=$work/stage lib=$work/stage/usr/local/lib

fail() { echo "$*"; exit 1; }

rm -f "$BUILD"/firmware/*.bin # an install makes them
$MAKE --no-print-directory install BUILD="$BUILD" DESTDIR="$stage" PREFIX=/usr/local
[ "$("$stage/usr/local/bin/palpate" --version)" = "palpate $(sed -n 's/.*PALP_VERSION "\(.*\)"/\1/p' include/palpate/version.h)" ] ||
    fail "the installed command does not tell its version"

rules=$stage/usr/local/lib/udev/rules.d/70-palpate.rules
grep -q '"0483".*"df11".*uaccess' "$rules" || fail "no rule for the boot loader"

# The installed command finds an image for each kind of board, where there was a compiler to make it.
mkdir "$work/bin"
printf '#!/bin/sh\necho "$*" >"%s/flashed"\n' "$work" >"$work/bin/stm32flash"
chmod +x "$work/bin/stm32flash"
if command -v arm-none-eabi-gcc >/dev/null; then
    for board in stm32f405 stepper_hx711 stepper_ads1220; do
        PATH=$work/bin:$PATH "$stage/usr/local/bin/palpate" firmware flash --port /dev/ttyUSB7 --board $board || fail "no image for $board"
        grep -q -- '-w .*/lib/palpate/.*\.bin ' "$work/flashed" || fail "$board was given $(cat "$work/flashed")"
    done
fi

export PKG_CONFIG_SYSROOT_DIR="$stage" PKG_CONFIG_PATH="$lib/pkgconfig"
flags=$(pkg-config --cflags palpate)
shared=$(pkg-config --libs palpate)
static=$(pkg-config --static --libs palpate | sed 's/-lpalpate/-l:libpalpate.a/')
case "$flags" in *"$stage/usr/local/include"*) ;; *) fail "pkg-config --cflags gave: $flags" ;; esac

try() { # name compiler and language flags...
    name=$1; shift
    # shellcheck disable=SC2086
    "$@" -Wall -Wextra -Wpedantic -Werror $flags -o "$work/shared" tests/install/outside.c -x none $shared -lm
    # shellcheck disable=SC2086
    "$@" -Wall -Wextra -Wpedantic -Werror $flags -o "$work/static" tests/install/outside.c -x none $static
    LD_LIBRARY_PATH=$lib "$work/shared" || fail "$name, shared: failed"
    LD_LIBRARY_PATH=$lib ldd "$work/shared" | grep -q "libpalpate.so.[0-9.]* => $lib" || fail "$name: not the shared library"
    "$work/static" || fail "$name, static: failed"
    if ldd "$work/static" | grep -q libpalpate; then fail "$name: not the static library"; fi
    echo "$name: shared and static work"
}

for f in doc/simulator.md doc/pictures examples/minimal.c examples/poke; do
    [ -e "$stage/usr/local/share/doc/palpate/$f" ] || fail "$f is not installed"
done

tried_cxx=
try gcc gcc -std=c99 -x c
if command -v clang >/dev/null; then try clang clang -std=c99 -x c; fi
for cxx in g++ clang++; do
    if command -v $cxx >/dev/null; then try $cxx $cxx -std=c++11 -x c++; tried_cxx=1; fi
done
[ -n "$tried_cxx" ] || echo "no C++ compiler: not tried as C++"

# The README's program, pressing a model as its text says.
sed -n '/^```c$/,/^```$/p' README.md | sed '/^```/d' >"$work/press.c"
cat >"$work/network.json" <<'END'
{"palpate": {"model": 1}, "kind": "network", "specimen": {"height_mm": 24, "radius_mm": 12},
 "stiffness": {"kind": "polynomial", "coefficients_N": [0.54, -2.34, 33.25, -124.03, 177.63]},
 "arms": [{"stiffness_N": 1, "viscosity_Ns": 1}],
 "mesh": {"kind": "lattice", "nodes": [3, 3, 3], "size_mm": [24, 24, 24]}, "formulation": "history"}
END
# shellcheck disable=SC2086
gcc -std=c99 -Wall -Wextra -Wpedantic -Werror "$work/press.c" $flags $shared -o "$work/press"
(cd "$work" && LD_LIBRARY_PATH=$lib ./press) >"$work/pressed" || fail "the README's program failed"
[ "$(wc -l <"$work/pressed")" = 6 ] || fail "the README's program printed: $(cat "$work/pressed")"

# The examples, in C and as C++; they press that model too.
example() { # name, compiler and language flags...
    name=$1; shift
    for source in examples/*.c; do
        more=$(sed -n 's,^/\* link: \(.*\) \*/$,\1,p' "$source") program=$work/${source##*/}
        # shellcheck disable=SC2086
        "$@" -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror $flags -o "${program%.c}" "$source" -x none $shared $more -lm ||
            fail "$name: $source does not build"
    done
    lines=$(LD_LIBRARY_PATH=$lib "$work/minimal" "$work/network.json" | grep -c '^ *[0-9.]* ms *[0-9.]* N$') || fail "$name: minimal failed"
    [ "$lines" = 10 ] || fail "$name: minimal printed $lines lines"
    LD_LIBRARY_PATH=$lib "$work/nodule" data/models/phantom_11.json >"$work/felt" || fail "$name: nodule failed"
    awk '{ with[NR] = $4; without[NR] = $9 } END { exit !(NR == 7 && with[4] > 1.1 * without[4] && with[1] < 1.05 * without[1]) }' "$work/felt" ||
        fail "$name: the nodule is not felt: $(cat "$work/felt")"
    LD_LIBRARY_PATH=$lib "$work/suture" >"$work/sewn" || fail "$name: suture failed"
    awk '{ touch = $(NF - 2) > touch ? $(NF - 2) : touch } END { exit !(/torn/ && NR > 7 && touch >= 4) }' "$work/sewn" ||
        fail "$name: the suture does not close the gap and tear: $(cat "$work/sewn")"
    LD_LIBRARY_PATH=$lib "$work/jaws" "$work/network.json" | awk '{ squeeze = $8; pull = $13 } END { exit !(NR == 20 && pull > squeeze) }' ||
        fail "$name: the jaws do not lift"
    LD_LIBRARY_PATH=$lib "$work/haptic_loop" "$work/network.json" 0.3 | grep -q '^[1-9][0-9]* ticks, ' || fail "$name: haptic_loop failed"
    LD_LIBRARY_PATH=$lib "$work/cut" "$work/network.json" | tail -n 1 | grep -q '^1.000,-*0.0000,49,0,' || fail "$name: cut failed"
    if LD_LIBRARY_PATH=$lib "$work/minimal" "$work/none.json" 2>"$work/said"; then fail "$name: minimal needs no model"; fi
    grep -q '^minimal: .*none.json: ' "$work/said" || fail "$name: minimal said: $(cat "$work/said")"
    echo "$name: the examples work"
}
example gcc gcc -std=c99 -x c
if command -v clang >/dev/null; then example clang clang -std=c99 -x c; fi
if command -v g++ >/dev/null; then example g++ g++ -std=c++11 -x c++; fi

# What doc/simulator.md shows stands in an example, to the letter.
sed -n '/^```c$/,/^```$/p' doc/simulator.md | grep -v '^```' >"$work/shown"
[ -s "$work/shown" ] || fail "doc/simulator.md shows no code"
while IFS= read -r line; do
    grep -qxF -e "$line" examples/*.c || fail "doc/simulator.md shows what no example has: $line"
done <"$work/shown"

unset PKG_CONFIG_SYSROOT_DIR PKG_CONFIG_PATH
$MAKE --no-print-directory uninstall BUILD="$BUILD" DESTDIR="$stage" PREFIX=/usr/local
left=$(find "$stage" ! -type d)
[ -z "$left" ] || fail "uninstall left: $left"
