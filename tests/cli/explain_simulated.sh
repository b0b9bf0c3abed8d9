#!/bin/sh
# explain_simulated.sh: what is hidden in measurements of another program's model is named, with its size; nothing hidden, nothing. check: once
. tests/cli/common
SOURCE=$ROOT/data/simulated

# runs FOLDER EFFECT SIZE NOISE: of the specimen that CalculiX has computed (data/simulated).
runs() {
    mkdir -p "$1"
    awk -v out="$1/run_" -v kind="$2" -v size="$3" -v noise="$4" -v seed=7 -f "$SOURCE/runs.awk" "$SOURCE/calculix.csv"
}

# The table is what CalculiX gives.
if command -v ccx >/dev/null; then
    (cd "$ROOT" && PALPATE=$PALPATE data/simulated/make.sh) >again.csv
    cmp -s again.csv "$SOURCE/calculix.csv" || fail "data/simulated/calculix.csv is not what CalculiX gives"
else
    echo "ccx is not installed: its table is taken as it is"
fi

# ---- effects that palpate did not compute ----
runs sim none 0 0
runs none none 0 0.004
expect 0 explain --simulated sim/*.csv none/*.csv --result none.json
grep -q '"verdict": "agrees"' none.json && grep -q '"effects": \[\]' none.json || fail "nothing hidden: $(cat out)"
grep -q "^As it is, recorded minus simulation" out || fail "not said of the simulation: $(cat out)"

# named EFFECT SIZE PARAMETER [OPTION...]: it alone, with its size to 3 %.
named() {
    runs "$1" "$1" "$2" 0.004
    effect=$1 size=$2 parameter=$3
    shift 3
    expect 0 explain --simulated sim/*.csv "$effect"/*.csv "$@" --result "$effect.json" --out "$effect.model"
    set -- "$effect" "$size" "$parameter"
    grep -q '"verdict": "explained"' "$1.json" || fail "$1: $(cat out)"
    [ "$(grep -c '"evidence_standard_error"' "$1.json")" -eq 1 ] || fail "$1: not one effect: $(cat out)"
    grep -q "\"id\": \"$1\"" "$1.model" || fail "$1 is not in the file of --out: $(cat out)"
    near "$1" "$(value "$1.json" "$3")" "$2" 0.03
}
named frame_compliance 0.01 compliance_mm_N
# Without a height the lumped model has strains of another scale, which change nothing.
mkdir -p bare_sim bare
for i in 1 2 3 4; do
    grep -v height sim/run_$i.csv >bare_sim/run_$i.csv
    grep -v height frame_compliance/run_$i.csv >bare/run_$i.csv
done
expect 0 explain --simulated bare_sim/*.csv bare/*.csv --candidates frame_compliance --result bare.json
near "frame without a height" "$(value bare.json compliance_mm_N)" "$(value frame_compliance.json compliance_mm_N)" 1e-3
named contact_offset 0.1 offset_mm
some="--candidates contact_offset,sensor_lag,sensor_drift,coulomb_friction,sensor_gain,toe_region,relaxation_arm"
named sensor_lag 0.08 time_s $some
named sensor_drift 0.004 force_N_s $some
named coulomb_friction 0.03 force_N $some
named sensor_gain 0.03 gain $some
grep -q "too soft or too stiff by that factor" out || fail "a gain may be the simulated stiffness: $(cat out)"

# The lumped model that is written follows the simulated force to a thousandth of the peak.
expect 0 explain --simulated sim/*.csv none/*.csv --max-effects 0 --out lumped.json --report page.html --json
near "lumped model off the simulation" "$(value out lumped_off_N)" 0 0 0.013
expect 0 simulate lumped.json --like sim/run_4.csv --out again.csv
awk -F, 'NR == FNR { if ($1 ~ /^[0-9]/) f[$1] = $3; next } $1 in f { d = $3 - f[$1]; if (d < 0) d = -d; if (d > most) most = d; n++ }
    END { exit !(n > 50 && most < 0.013) }' sim/run_4.csv again.csv || fail "the model of --out does not follow the simulation"

# ---- a network's own simulation, with arms ----
cat >network.json <<'J'
{"palpate": {"model": 1}, "kind": "network", "specimen": {"height_mm": 24},
 "stiffness": {"kind": "polynomial", "coefficients_N": [0.54, -2.34, 33.25, -124.03, 177.63]},
 "arms": [{"stiffness_N": 0.3, "viscosity_Ns": 0.2}, {"stiffness_N": 0.2, "viscosity_Ns": 2}], "formulation": "history",
 "mesh": {"kind": "lattice", "nodes": [3, 3, 3], "size_mm": [24, 24, 24]}}
J
mkdir -p path net lag
n=0
for press in "4 1 3" "6 4 5" "6 1 2"; do
    n=$((n + 1))
    echo "$press" | awk '{ up = ($1 + 0.5) / $2
        print "# palpate.experiment: 1\n# specimen.height_mm: 24\ntime_s,depth_mm,force_N"
        for (i = 0; i / 20 <= 2 * up + $3; i++) { t = i / 20
            printf "%.9g,%.9g,0\n", t, t < up ? t * $2 - 0.5 : t < up + $3 ? $1 : $1 - (t - up - $3) * $2 } }' >path/$n.csv
    expect 0 simulate network.json --like path/$n.csv --out net/$n.csv
    sed 's/"arms"/"effects": [{"id": "sensor_lag", "parameters": {"time_s": 0.1}}], "arms"/' network.json >slow.json
    expect 0 simulate slow.json --like path/$n.csv --noise-N 0.005 --seed $n --out lag/$n.csv
    awk -v seed=$n 'BEGIN { FS = OFS = ","; srand(seed) }
        /^[0-9]/ { $3 += 0.005 * sqrt(-2 * log(1 - rand())) * cos(6.283185307 * rand()) } { print }' net/$n.csv >path/$n.csv
done
expect 0 explain --simulated net/*.csv path/*.csv --result null.json
grep -q '"verdict": "agrees"' null.json || fail "a network with nothing hidden: $(cat out)"
expect 0 explain --simulated net/*.csv lag/*.csv --result lag.json
grep -q '"verdict": "explained"' lag.json || fail "a lag beside a network's forces: $(cat out)"
near "lag beside a network's forces" "$(value lag.json time_s)" 0.1 0.03

# ---- which goes with which, and what they must share ----
for i in 1 2 3 4; do cp sim/run_$i.csv sim_$i.csv; done
expect 0 explain --simulated sim_?.csv none/*.csv --max-effects 0
grep -q "^palpate explain: sim_1.csv is taken for the simulation of none/run_1.csv, by their order" err || fail "by order: $(cat err)"
expect 2 explain --simulated sim_1.csv none/run_1.csv none/run_2.csv
says "no two of the 3 files have one name, and their number is odd"
expect 2 explain --simulated sim/run_1.csv none/run_1.csv none/../none/run_1.csv
says "more than two files are called run_1.csv"
expect 2 explain --simulated --model network.json sim/run_1.csv none/run_1.csv
says "either --model MODEL.json or --simulated"
expect 1 explain --simulated sim/run_1.csv none/run_1.csv none/run_2.csv
says "none/run_2.csv: no simulated run goes with it"
expect 1 explain --simulated sim/run_1.csv sim/run_2.csv none/run_1.csv
says "sim/run_2.csv: no simulated run goes with it"
mkdir -p other short broken
stretch() { awk -F, -v by="$2" '/^[0-9]/ { printf "%s,%.9g,%s\n", $1, $2 * by, $3; next } { print }' "$1"; }
stretch none/run_1.csv 1.1 >other/run_1.csv # the lumped model follows these forces: it knows what a path that differs changes
expect 0 explain --simulated sim/run_?.csv other/run_1.csv none/run_2.csv none/run_3.csv none/run_4.csv --max-effects 0
stretch none/run_4.csv 1.1 >other/run_4.csv
expect 1 explain --simulated sim/run_4.csv other/run_4.csv
says "other/run_4.csv: goes to"
for i in 1 2 3; do stretch path/$i.csv 0.8 >other/$i.csv; done
expect 1 explain --simulated net/*.csv other/1.csv path/2.csv path/3.csv
says "net/1.csv: its path differs from that of other/1.csv by up to 0.8 mm"
head -n 120 sim/run_1.csv >short/run_1.csv
expect 1 explain --simulated short/run_1.csv none/run_1.csv
says "short/run_1.csv: ends after"
sed '50s/,.*/,1.5,newtons/' sim/run_1.csv >broken/run_1.csv
expect 1 explain --simulated broken/run_1.csv none/run_1.csv
says "broken/run_1.csv:50"

# A run in air needs no simulated one.
{ echo "# palpate.experiment: 1" && echo "# specimen.kind: \"none\"" && echo "time_s,depth_mm,force_N" &&
    awk 'BEGIN { srand(3); for (i = 0; i < 100; i++) printf "%g,%g,%.6f\n", i / 10, i / 20 - 8, 0.004 * (rand() - 0.5) }'; } >air.csv
expect 0 explain --simulated sim/*.csv none/*.csv air.csv --max-effects 0
done_testing
