#!/bin/sh
# rheos.sh: a table as RHEOS.jl writes it (stress, strain, time; no names; NaN rows first) is read, and solids with parameters that it publishes come back.
. tests/cli/common
command -v python3 >/dev/null || { echo "there is no python3"; exit 77; }

# value NAME: of the fit; a table of h = 10 mm and 100 mm2, stress in kPa: K in N is a tenth of the modulus in kPa.
value() { awk -v n="\"$1\"," '/"correlation"/ { exit } $2 == n { on = 1 } on && $1 == "\"value\":" { sub(",", "", $2); print $2; exit }' out; }
bring() { # NAME CA A KB KG
    python3 -B "$ROOT/tests/cli/rheos.py" relax "$2" "$3" "$4" "$5" >"$1.csv" || fail "rheos.py"
    expect 0 import "$1.csv" --out runs --map stress=1,strain=2,time=3 --units strain=1,stress=kPa --specimen-height-mm 10 --specimen-area-mm2 100
    grep -q "rows that are not numbers" err || fail "$(cat err)"
}

# Sixteen arms stand for the element: it is its storage and loss that come back to a percent; its numbers, which trade against each other, to five.
# The fractional standard linear solid with the parameters that its source has (src/models/zener.jl), and those of its manual's fit.
for solid in "default 0.5 0.5 1.0 0.2" "manual 2.0 0.5 0.5 0.7" "slow 1.0 0.3 1.0 0.5"; do
    set -- $solid
    bring $solid
    expect 0 characterize runs/$1.csv --arms fractional --degree 2 --contact known --json --spectrum spectrum.csv
    near "exponent of $1" "$(value exponent)" "$3" 0.05
    near "K_frac of $1" "$(value K_frac)" "$(awk "BEGIN { print 0.1 * $4 }")" 0.05
    near "tau_frac of $1" "$(value tau_frac)" "$(awk "BEGIN { print exp(log($2 / $4) / $3) }")" 0.05
    near "long-term stiffness of $1" "$(awk "BEGIN { print $(value c0) + 0.1 * $(value c1) }")" "$(awk "BEGIN { print 0.1 * $5 }")" 0.05
    # Frequency in rad/s, G' and G'' in kPa, three columns as RHEOS reads them.
    awk -F, '/^model,/ && $2 > 0.01 { printf "%.9g,%s,%s\n", 6.283185307 * $2, $10 / 1000, $11 / 1000 }' spectrum.csv >dynamic.csv
    [ "$(wc -l <dynamic.csv)" -gt 8 ] || fail "$(wc -l <dynamic.csv) frequencies"
    miss=$(python3 -B "$ROOT/tests/cli/rheos.py" compare "$2" "$3" "$4" "$5" <dynamic.csv)
    awk -v m="$miss" 'BEGIN { exit !(m < 0.01) }' || fail "storage and loss of $1 are $miss off the closed form"
done

# The Maxwell solid of its tutorial's fit: eta 4.0054, k 2.0030.
bring maxwell 4.0054 1 2.0030 0.001
# Its long-term stiffness is less than a law may have: the fit stays at that bound.
expect 0 characterize runs/maxwell.csv --arms 1 --degree 2 --contact known --json
near "k" "$(value K_1)" 0.2003 0.01
near "eta" "$(value b_1)" 0.40054 0.01

# A strain without a unit: what to give is said.
expect 1 import default.csv --out none --map stress=1,strain=2,time=3 --specimen-height-mm 10 --specimen-area-mm2 100
says "units strain=1"
done_testing
