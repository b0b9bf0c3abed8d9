#!/bin/sh
# explain_metamorphic.sh: recordings in other units, orders, names, clocks, files and headers get the same model and the same answer. check: all
. tests/cli/common
command -v python3 >/dev/null || { echo "there is no python3, which draws and compares"; exit 77; }

# A case whose answer hangs on the last bits is left aside (see metamorphic.py), so that the outcome does not. METAMORPHIC_SEED draws others.
hidden=$ROOT/tests/hidden seed=${METAMORPHIC_SEED:-1}
${CC:-cc} -std=c99 -O2 -ffp-contract=off "$hidden"/worlds/*.c "$hidden/random.c" "$hidden/path.c" "$hidden/kinds.c" -lm -o worlds &&
    ./worlds quick 101 cases truth.json >made || fail "the generator: $(cat made)"
python3 "$hidden/metamorphic.py" --command "$PALPATE" --cases cases --truth truth.json --out out --seed "$seed" --draws 4 >answers 2>&1 ||
    fail "with METAMORPHIC_SEED=$seed: $(cat answers)"
[ "$(grep -c -- '-> same$' answers)" -ge 2 ] || fail "not half of the answers were compared: $(cat answers)"
done_testing
