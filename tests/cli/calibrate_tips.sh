#!/bin/sh
# calibrate_tips.sh: a network from runs of spheres and plates at once: law, arms and Poisson's ratio of a known network; forces of CalculiX.
. tests/cli/common

cat >true.json <<'J'
{"palpate": {"model": 1}, "kind": "network", "stiffness": {"kind": "polynomial", "coefficients_N": [8, 0, 40]},
 "arms": [{"stiffness_N": 6, "viscosity_Ns": 4.8}], "poisson_ratio": 0.42, "edge_correction": true,
 "mesh": {"kind": "lattice", "nodes": [4, 4, 4], "size_mm": [24, 24, 24], "scaling": "continuum"}}
J
slow="--protocol static --relaxed --depth-mm 2 --sample-Hz 2 --force"
held="--protocol ramp_hold --ramp-s 1 --hold-s 10 --depth-mm 2 --sample-Hz 10 --force"
sed 's/"arms": .*}],/"arms": [],/' true.json >rest.json # contact is as stiff as the elements with their arms
expect 0 simulate rest.json $slow --out plate.csv
expect 0 simulate rest.json $slow --tip sphere --tip-radius-mm 6 --out sphere.csv
expect 0 simulate true.json $held --tip sphere --tip-radius-mm 12 --out held.csv

# Slow presses by a plate and a sphere: the law at rest and Poisson's ratio.
net="$DATA/lumped_n1.json --nodes 4 --degree 2 --json"
expect 0 calibrate $net plate.csv sphere.csv --stage static --out static.json
near "Poisson's ratio" "$(value out poisson_ratio)" 0.42 0.01
values out max_error_percent | awk '!($1 < 0.5) { bad = 1 } END { exit bad || NR != 2 }' || fail "forces: $(values out max_error_percent | tr '\n' ' ')"
expect 0 simulate static.json $slow --tip sphere --tip-radius-mm 12 --out big.csv
expect 0 simulate rest.json $slow --tip sphere --tip-radius-mm 12 --out wanted.csv
near "force of a sphere that it was not fitted to" "$(tail -n 1 big.csv | cut -d, -f3)" "$(tail -n 1 wanted.csv | cut -d, -f3)" 0.01
# A sphere alone: Poisson's ratio as given.
expect 0 calibrate $net sphere.csv --stage static --poisson 0.42 --out one.json
expect 0 simulate one.json $slow --tip sphere --tip-radius-mm 12 --out big.csv
near "the same, fitted to one sphere" "$(tail -n 1 big.csv | cut -d, -f3)" "$(tail -n 1 wanted.csv | cut -d, -f3)" 0.01
grep -q '"poisson_ratio": 0.42' one.json || fail "the ratio given is not in the model"
# With a dwell: the arms too.
expect 0 calibrate $net plate.csv held.csv --poisson 0.42 --out arms.json
near "time of the arm" "$(awk -v k="$(value out stiffness_N)" -v b="$(value out viscosity_Ns)" 'BEGIN { print b / k }')" 0.8 0.02
near "its stiffness" "$(value out stiffness_N)" 6 0.02
expect 0 calibrate $DATA/lumped_n1.json --nodes 4 --degree 2 plate.csv held.csv --poisson 0.42
grep -q 'Plates and spheres at once' out && grep -q 'sphere of 12 mm' out || fail "text: $(cat out)"

# Forces of CalculiX on a cube of 24 mm, G = 1000 Pa, ratio 0.45: depth and force of a file are a run of its tip.
forces() { # RADIUS FILE
    { printf '# palpate.experiment: 1\n# specimen.height_mm: 24\n# tip.kind: "sphere"\n# tip.radius_mm: %s\ntime_s,depth_mm,force_N\n0,0,0\n' "$1"
    awk -F, -v r="$1" '$1 == "cylinder" && $2 == "sphere" && $3 == r && $4 == 0.45 && $6 == 12 { print $5, $7 * 1000 * 0.024 ^ 2 / $5 ^ 1.5 }' "$ROOT/data/tips/block.csv" |
        sort -n | awk '{ d[NR] = $1; c[NR] = $2 } END { # force over depth^1.5 is nearly straight
            for (x = 0.1; x < 2.05; x += 0.1) { k = x < 1 ? 1 : 2
                printf "%g,%g,%.9g\n", 10 * x, x, x ^ 1.5 * (c[k] + (c[k + 1] - c[k]) * (x - d[k]) / (d[k + 1] - d[k])) } }'; } >"$2"
}
forces 5 five.csv; forces 10 ten.csv
expect 0 calibrate $DATA/lumped_n1.json --nodes 7 --degree 2 five.csv ten.csv --stage static --poisson 0.45 --json
values out max_error_percent | awk '!($1 < 10) { bad = 1 } END { exit bad || NR != 2 }' || fail "CalculiX: $(values out max_error_percent | tr '\n' ' ')"

bad() { # code text arguments...
    code=$1 text=$2; shift 2
    expect "$code" "$@"
    says "$text"
}
bad 2 "no run has a dwell" calibrate $net sphere.csv
bad 2 "need --method nlopt" calibrate $net sphere.csv --method fixed_point --stage static
bad 2 "without a dwell" calibrate $net held.csv --stage static
sed '/tip.radius_mm/d' sphere.csv >sizeless.csv; bad 1 "needs its tip.radius_mm" calibrate $net sizeless.csv
sed 's/"sphere"/"flat"/' sphere.csv >flat.csv; bad 1 'its tip.kind "flat" presses no network' calibrate $net flat.csv
done_testing
