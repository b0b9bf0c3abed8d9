#!/bin/sh
# regions.sh: a network model with regions is read, pressed, calibrated and written again; what is wrong in it is named by its line.
. tests/cli/common

model() { # REGIONS, in a lattice of 24 mm
    cat <<J
{"palpate": {"model": 2}, "kind": "network",
 "stiffness": {"kind": "polynomial", "coefficients_N": [10]}, "arms": [{"stiffness_N": 3, "viscosity_Ns": 1}],
 "mesh": {"kind": "lattice", "nodes": [5, 5, 5], "size_mm": [24, 24, 24], "scaling": "continuum"},
 "poisson_ratio": 0.45,
 "regions": [$1]}
J
}
sphere='"sphere": {"centre_mm": [12, 14, 12], "radius_mm": 7}'
skin='{"name": "skin", "box": {"low_mm": [0, 18, 0], "high_mm": [24, 24, 24]}, "material": {"stiffness": {"kind": "polynomial", "coefficients_N": [20, 5]}, "arms": [{"stiffness_N": 8, "viscosity_Ns": 8}]}, "poisson_ratio": 0.3}'
last() { tail -n 1 "$1" | cut -d, -f3; }
press() { # NAME
    expect 0 simulate "$1.json" --protocol ramp_hold --depth-mm 2 --ramp-s 0.5 --hold-s 2 --out "$1.csv"
    last "$1.csv"
}

# ---- forces: a factor is the same material times it, a soft part makes it softer ----
model '' >plain.json
model "{\"name\": \"nodule\", $sphere, \"stiffness_factor\": 10}" >factor.json
model "{\"name\": \"nodule\", $sphere, \"material\": {\"stiffness\": {\"kind\": \"polynomial\", \"coefficients_N\": [100]}, \"arms\": [{\"stiffness_N\": 30, \"viscosity_Ns\": 10}]}}" >material.json
model "{\"name\": \"cyst\", $sphere, \"stiffness_factor\": 0.1}" >soft.json
model "{\"name\": \"nodule\", $sphere, \"stiffness_factor\": 10}, $skin" >both.json
plain=$(press plain) stiff=$(press factor)
near "a material that is a factor" "$(press material)" "$stiff" 1e-9
awk -v p="$plain" -v s="$stiff" -v c="$(press soft)" 'BEGIN { exit !(s > 1.1 * p && c < 0.95 * p) }' || fail "stiff $stiff, plain $plain"
press both >/dev/null
model '{"name": "capsule", "membrane": {}, "material": {"stiffness": {"kind": "polynomial", "coefficients_N": [60]}}}' >capsule.json
awk -v p="$plain" -v s="$(press capsule)" 'BEGIN { exit !(s > 1.1 * p) }' || fail "a capsule of no effect"
sed 's/"model": 2/"model": 1/' plain.json >old.json
near "a file of version 1" "$(press old)" "$plain" 1e-12

# ---- fibres: stiffer along them than across; kept by a command that writes the model; refused by name where they do not work ----
fibre() { model "{\"name\": \"muscle\", \"box\": {\"low_mm\": [0, 0, 0], \"high_mm\": [24, 24, 24]}, \"stiffness_factor\": 1, \"fibre\": {\"direction\": $1, \"stiffness_Pa\": $2}}"; }
fibre '[0, 2, 0]' 20000 >along.json
fibre '[1, 0, 0]' 20000 >across.json
awk -v p="$plain" -v a="$(press along)" -v c="$(press across)" 'BEGIN { exit !(a > 1.5 * p && c > p && c < 0.7 * a) }' ||
    fail "fibres: along $(last along.csv), across $(last across.csv), none $plain"
for i in 1 2 3 4 5 6 7 8 9; do
    x=$((4 + 8 * (i % 3))) z=$((4 + 8 * (i / 4)))
    expect 0 simulate along.json --protocol static --relaxed --depth-mm 2 --tip sphere --tip-radius-mm 4 --tip-x-mm $x --tip-z-mm $z --out map_$i.csv
done
expect 0 inclusion along.json map_*.csv --subdivisions 0 --out kept.json
grep -q '"fibre": {"direction": \[0, 2, 0\], "stiffness_Pa": 20000}' kept.json || fail "fibres: $(grep fibre kept.json)"
expect 1 calibrate "$DATA/lumped_n1.json" --start along.json --stage static --out none.json
says 'along.json: region "muscle" has fibres'
expect 1 export along.json --depth-mm 1 --out deck.inp
says 'fibre'
expect 1 reduce along.json map_1.csv map_2.csv --out small.json
says 'fibres'
fibre '[0, 0, 0]' 20000 >wrong.json
expect 1 simulate wrong.json --protocol static --depth-mm 1
says 'must be three numbers that are not all 0'
fibre '[0, 1, 0]' -1 >wrong.json
expect 1 simulate wrong.json --protocol static --depth-mm 1
says 'stiffness_Pa'
model "{\"name\": \"capsule\", \"membrane\": {}, \"material\": {\"stiffness\": {\"kind\": \"polynomial\", \"coefficients_N\": [60]}}, \"fibre\": {\"direction\": [1, 0, 0], \"stiffness_Pa\": 1}}" >wrong.json
expect 1 simulate wrong.json --protocol static --depth-mm 1
says 'does not go with a membrane'

# ---- what is drawn ----
expect 0 simulate both.json --protocol static --depth-mm 1 --vtu frames --out drawn.csv
grep -q 'Name="stiffness_N"' frames/*.vtu || fail "no stiffness of the elements in a frame"

# ---- calibrate: the law of all but the regions, which the new model keeps ----
cat >lumped.json <<'J'
{"palpate": {"model": 1}, "kind": "lumped", "specimen": {"kind": "cylinder", "height_mm": 24, "radius_mm": 12},
 "stiffness": {"kind": "polynomial", "coefficients_N": [8, 4]}, "arms": []}
J
expect 0 calibrate lumped.json --start factor.json --nodes 7 --stage static --depth-mm 6 --out fitted.json --json
grep -q '"palpate": {"model": 4}' fitted.json || fail "the version of a model with corrected edges"
grep -q '"name": "nodule", "sphere": {"centre_mm": \[12, 14, 12\], "radius_mm": 7}, "stiffness_factor": 10}' fitted.json || fail "regions: $(grep -A2 regions fitted.json)"
expect 0 simulate fitted.json --protocol static --depth-mm 2 --relaxed --out network.csv
expect 0 simulate lumped.json --protocol static --depth-mm 2 --relaxed --out lumped.csv
near "force of the network" "$(last network.csv)" "$(last lumped.csv)" 0.01
expect 1 calibrate --check factor.json
grep -q 'has regions.*check the network without them' err || fail "check: $(cat err)"
expect 1 export material.json --depth-mm 1 --out deck.inp
grep -q 'only their stiffness_factor and poisson_ratio can be exported' err || fail "export: $(cat err)"

expect 0 calibrate lumped.json --start capsule.json --nodes 5 --stage static --depth-mm 6 --out inside.json --json
expect 0 simulate inside.json --protocol static --depth-mm 2 --relaxed --out network.csv
near "force of the network in a capsule" "$(last network.csv)" "$(last lumped.csv)" 0.01

# ---- calibrate: the stiffness of a region, from spheres over it and beside it, and the plate ----
model "{\"name\": \"nodule\", \"sphere\": {\"centre_mm\": [7, 15, 12], \"radius_mm\": 6}, \"stiffness_factor\": 5}" >hidden.json
sed 's/"stiffness_factor": 5/"stiffness_factor": 1/; s/\[10\]/[4]/' hidden.json >start.json
for x in 7 17; do
    expect 0 simulate hidden.json --protocol static --relaxed --depth-mm 2 --tip sphere --tip-radius-mm 4 --tip-x-mm $x --tip-z-mm 12 \
        --sample-Hz 5 --noise-N 0.0003 --seed $x --out at$x.csv
done
grep -q '^# tip.x_mm: 7' at7.csv || fail "the place of the sphere: $(grep tip at7.csv)"
awk -v a="$(last at7.csv)" -v b="$(last at17.csv)" 'BEGIN { exit !(a > 1.15 * b) }' || fail "the nodule is not felt: $(last at7.csv), $(last at17.csv)"
for x in 7 17; do expect 0 simulate hidden.json --like at$x.csv --out again$x.csv; done
grep -q '^# tip.x_mm: 7' again7.csv || fail "the place of --like: $(grep tip again7.csv)"
awk -v a="$(last again7.csv)" -v b="$(last again17.csv)" 'BEGIN { exit !(a > 1.15 * b) }' || fail "--like presses elsewhere: $(last again7.csv), $(last again17.csv)"
expect 0 simulate hidden.json --protocol static --relaxed --depth-mm 2 --sample-Hz 5 --noise-N 0.0003 --out plate.csv
expect 0 calibrate lumped.json at7.csv at17.csv plate.csv --start start.json --stage static --degree 1 --poisson 0.45 --fit-region nodule --out found.json --json
near "stiffness of the nodule" "$(sed -n '/"nodule"/,/}/s/.*"stiffness": *\([0-9.]*\).*/\1/p' out)" 5 0.15
grep -q '"stiffness_factor": [45]\.' found.json || fail "regions of the model: $(grep stiffness_factor found.json)"
sed '/tip.z_mm/d' at7.csv >half.csv
expect 1 calibrate lumped.json half.csv --stage static --start start.json
grep -q 'half.csv: the place of a sphere needs both' err || fail "half a place: $(cat err)"
expect 2 calibrate lumped.json at7.csv --stage static --start start.json --fit-region lump
grep -q 'has no region "lump"' err || fail "an unknown region: $(cat err)"
expect 2 calibrate lumped.json --stage static --start start.json --fit-region nodule
grep -q 'needs runs of spheres' err || fail "no runs: $(cat err)"
expect 1 simulate hidden.json --protocol static --depth-mm 1 --tip sphere --tip-radius-mm 4 --tip-x-mm 90 --tip-z-mm 12 --out none.csv
grep -q 'nothing of it is below a sphere at x = 90' err || fail "beside the network: $(cat err)"

# ---- a reduced network has its regions; one with a material of its own is refused ----
sed '/poisson_ratio/d' factor.json >reducible.json
for depth in 2 3 4; do expect 0 simulate reducible.json --protocol static --depth-mm $depth --rate-mm-s 2 --sample-Hz 10 --out of_$depth.csv; done
expect 0 reduce reducible.json --runs of_2.csv,of_3.csv,of_4.csv --hold-out 0.3 --out reduced.json
for kind in reduced reducible; do expect 0 simulate $kind.json --protocol static --depth-mm 2.5 --rate-mm-s 2 --out $kind.csv; done
near "a reduced network" "$(last reduced.csv)" "$(last reducible.csv)" 0.02
sed '/poisson_ratio/d' material.json >own.json
expect 1 reduce own.json --runs of_2.csv,of_3.csv --hold-out 0.5 --out none.json
grep -q 'region with a material of its own' err || fail "reduce: $(cat err)"

# ---- what is wrong ----
wrong() { # REGIONS WORDS
    model "$1" >wrong.json
    expect 1 simulate wrong.json --protocol static --depth-mm 1 --out none.csv
    grep -q "wrong.json:[0-9]*: .*$2\|wrong.json.*$2\|lattice.*$2" err || fail "\"$2\" expected: $(cat err)"
    [ ! -e none.csv ] || fail "a file was written"
}
wrong "{$sphere, \"stiffness_factor\": 10}" 'name'
wrong "{\"name\": \"a\", $sphere}" 'needs either stiffness_factor or material'
wrong "{\"name\": \"a\", $sphere, \"stiffness_factor\": 0}" 'must be greater than 0'
wrong "{\"name\": \"a\", $sphere, \"stiffness_factor\": 2, \"poisson_ratio\": 0.5}" 'must be from 0.25 to below 0.5'
wrong '{"name": "a", "box": {"low_mm": [0, 5, 0], "high_mm": [9, 5, 9]}, "stiffness_factor": 2}' 'must have every coordinate'
wrong '{"name": "a", "sphere": {"centre_mm": [0, 5], "radius_mm": 3}, "stiffness_factor": 2}' 'must be three coordinates'
wrong '{"name": "a", "sphere": {"centre_mm": [90, 5, 5], "radius_mm": 3}, "stiffness_factor": 2}' 'no part of the mesh is in the region "a"'
wrong '{"name": "a", "stiffness_factor": 2}' 'no group of volumes called "a"'
wrong '{"name": "a", "membrane": {}, "stiffness_factor": 2}' 'is a membrane'
wrong '{"name": "a", "membrane": {"set": "nowhere"}, "material": {"stiffness": {"kind": "polynomial", "coefficients_N": [9]}}}' 'no node set "nowhere"'
wrong "$skin, $skin" 'has the name of another region'
wrong '{"name": "a", "stiffness_factor": 2, "colour": 1}' 'colour'
done_testing
