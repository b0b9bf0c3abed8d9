#!/bin/sh
# import_vendors.sh: exports after the layouts of some forty testers, each without a hint but for the height. check: once
. tests/cli/common
command -v python3 >/dev/null || { echo "there is no python3"; exit 77; }
key() { sed -n "s/^# $2: //p" "$1"; }

python3 "$ROOT/tests/cli/import_vendors.py" files || fail "files"
[ "$(ls files | wc -l)" -gt 40 ] || fail "$(ls files | wc -l) files"
mkdir made
for file in files/*; do
    name=$(basename "$file") && mkdir "made/$name" # with an ending of a file it has to be there
    "$PALPATE" import "$file" --out "made/$name" >/dev/null 2>err && continue
    grep -q "has no height of the specimen" err || { fail "$name"; tail -n 1 err; }
    expect 0 import "$file" --specimen-height-mm 20 --out "made/$name"
done
python3 "$ROOT/tests/cli/import_vendors.py" --compare made || fail "numbers"

# ---- specimens side by side: said, and one alone ----
expect 0 import files/pasco.csv --specimen-height-mm 20 --out side
grep -q "so 2 specimens become a run each" err || fail "side by side is not said"
expect 0 import files/pasco.csv --specimen-height-mm 20 --map time=4,depth=6,force=5 --out one
[ "$(ls one)" = pasco.csv ] || fail "one: $(ls one)"
grep '^[0-9]' side/pasco_02.csv | cut -d, -f1-3 >second
grep '^[0-9]' one/pasco.csv | cut -d, -f1-3 | cmp -s - second || fail "one: not the second specimen"

# ---- no time: by the file, by --rate, and neither ----
sed 1d files/notime.csv >bare.csv
expect 1 import bare.csv --specimen-height-mm 20 --out bare; says "the sampling rate by --rate HZ"
expect 0 import bare.csv --specimen-height-mm 20 --rate 10 --out bare
grep '^[0-9]' made/notime.csv/notime.csv | cut -d, -f1-3 >timed
grep '^[0-9]' bare/bare.csv | cut -d, -f1-3 | cmp -s - timed || fail "--rate"
expect 0 import files/pandas.csv --specimen-height-mm 20 --rate 100 --out bare # a time that is wrong
[ "$(tail -n 1 bare/pandas.csv | cut -d, -f1)" = 0.7 ] || fail "--rate in place of a time: $(tail -n 1 bare/pandas.csv)"
expect 2 import files/pandas.csv --specimen-height-mm 20 --rate 100 --map time=2 --out bare

# ---- what pressed, for characterize: by the file, and by the options before it ----
[ "$(key made/piuma.txt/piuma.csv tip.radius_mm)" = 0.0245 ] || fail "tip radius: $(key made/piuma.txt/piuma.csv tip.radius_mm)"
expect 0 import files/piuma.txt --specimen-height-mm 1 --tip sphere --out tip
grep -q "the tip is a sphere, radius 0.0245 mm" err || fail "the tip is not said"
[ "$(key tip/piuma.csv tip.kind)" = '"sphere"' ] || fail "tip: $(key tip/piuma.csv tip.kind)"
expect 0 import files/piuma.txt --specimen-height-mm 1 --tip cone --tip-angle-deg 30 --out tip --force
[ "$(key tip/piuma.csv tip.half_angle_deg)" = 30.0 ] || fail "tip: angle"
{ printf 'Probe: cylindrical, flat\nProbe diameter (mm): 4\n'; cat files/exponent.txt; } >probe.txt
expect 0 import probe.txt --specimen-height-mm 20 --out tip
[ "$(key tip/probe.csv tip.kind) $(key tip/probe.csv tip.radius_mm)" = '"flat" 2.0' ] || fail "probe: $(key tip/probe.csv tip.kind)"
done_testing
