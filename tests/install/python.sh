#!/bin/sh
# python.sh: installs the library into a scratch folder, makes the Python package's wheel without a network, installs it in
# a bare environment, and runs its tests and its example there. The package finds the library in each of its three ways.
set -eu
cd "$(dirname "$0")/../.."
ROOT=$PWD BUILD=${BUILD:-build} MAKE=${MAKE:-make}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "$*"; exit 1; }

python=
for p in "${PYTHON:-python3}" /usr/bin/python3; do
    if [ -z "$python" ] && "$p" -c 'import numpy, ensurepip' 2>/dev/null; then python=$p; fi
done
[ -n "$python" ] || { echo "no Python with NumPy and venv (tools/install-deps python)"; exit 77; }

# Without the board's images, which other tests make at the same time.
$MAKE --no-print-directory install FW_IMAGES= BUILD="$BUILD" PREFIX="$work/usr" >"$work/log" 2>&1 || fail "make install: $(tail -n 20 "$work/log")"
"$python" -m venv --system-site-packages "$work/env"
inside=$work/env/bin/python
# --no-index: nothing may come from a network.
"$inside" -m pip --no-cache-dir wheel -q --no-index --no-deps -w "$work" ./python || fail "the wheel cannot be made"
"$inside" -m pip --no-cache-dir install -q --no-index "$work"/palpate-*.whl || fail "the wheel cannot be installed"

export OPENBLAS_NUM_THREADS=1 PALPATE="$work/usr/bin/palpate" DATA="$ROOT/data" INCLUDE="$work/usr/include"
lib=$work/usr/lib version=$(sed -n 's/^.define PALP_VERSION "\(.*\)"/\1/p' include/palpate/version.h)
says_version() { [ "$("$@" "$inside" -c 'import palpate; print(palpate.c.palp_version())')" = "$version" ]; }
cd "$work"
says_version env PALPATE_LIBRARY="$lib/libpalpate.so" || fail "PALPATE_LIBRARY is not taken"
says_version env LD_LIBRARY_PATH="$lib" || fail "the loader's library is not taken"
if PALPATE_LIBRARY=$work/none.so "$inside" -c 'import palpate' 2>"$work/said"; then fail "a library that is not there is taken"; fi
grep -q 'ImportError: libpalpate was not found; set PALPATE_LIBRARY' "$work/said" || fail "without a library: $(cat "$work/said")"
ln -s "$lib/libpalpate.so" "$("$inside" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')/palpate/"
says_version env || fail "the library in the package's folder is not taken"

"$inside" -W error::RuntimeWarning "$ROOT/python/test_palpate.py" || fail "the package's tests failed"
mkdir "$work/example"
"$inside" "$ROOT/python/example.py" "$work/example" >"$work/said" || fail "the example failed: $(cat "$work/said")"
grep -q 'the sphere feels [0-9.]* N in [1-9]' "$work/said" || fail "the example said: $(cat "$work/said")"
# The README's first lines run as they are.
sed -n '/^```python$/,/^```$/p' "$ROOT/python/README.md" | sed '/^```/d' >"$work/readme.py"
cp "$ROOT/data/sedef2008/network_27.json" network.json
[ "$("$inside" "$work/readme.py" | wc -l)" -ge 5 ] || fail "the README's program does not run"
"$inside" -m pip uninstall -q -y palpate
