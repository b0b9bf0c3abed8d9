#!/bin/sh
# inclusion.sh: a ball or a layer in a network is found from a map of presses; where there is none, none is found; bad input.
. tests/cli/common

model() { # REGIONS
    cat <<J
{"palpate": {"model": 2}, "kind": "network",
 "stiffness": {"kind": "polynomial", "coefficients_N": [10]}, "arms": [{"stiffness_N": 3, "viscosity_Ns": 1}],
 "mesh": {"kind": "lattice", "nodes": [6, 5, 6], "size_mm": [24, 18, 24], "scaling": "continuum"},
 "regions": [$1]}
J
}
model '' >plain.json
model '{"name": "hidden", "sphere": {"centre_mm": [10, 10, 15], "radius_mm": 5}, "stiffness_factor": 6}' >hidden.json
map() { # MODEL NAME
    for x in 5 10 14 19; do
        for z in 5 12 19; do
            expect 0 simulate "$1.json" --protocol ramp_hold --depth-mm 1.5 --ramp-s 2 --hold-s 0.5 --tip sphere --tip-radius-mm 5 --tip-x-mm $x --tip-z-mm $z \
                --noise-N 1e-4 --seed $((x + z)) --sample-Hz 50 --out "$2_${x}_$z.csv"
        done
    done
}
map hidden ball
map plain none

# ---- a ball, in recordings whose forces relax: the answer, the model with it, and its place in a page of programs ----
expect 0 inclusion plain.json ball_*.csv --subdivisions 0 --out found.json --json
cp out found_json
grep -q '"found": true' out || fail "not found: $(cat out)"
awk '/"[xyz]_mm": {/ { key = $1 } /"low"/ { low = $2 } /"high"/ { high = $2 + 0; k++
        if (key ~ /x_mm/ && !seen[key]++ && !(low - 1 < 10 && 10 < high + 1)) bad = 1
        if (key ~ /z_mm/ && !seen[key]++ && !(low - 1 < 15 && 15 < high + 1)) bad = 1 } END { exit bad || k < 5 }' out || fail "place: $(cat out)"
grep -q '"name": "inclusion", "sphere"' found.json || fail "no region in the model: $(cat found.json)"
expect 0 simulate found.json --protocol static --depth-mm 1
expect 0 inclusion plain.json ball_*.csv --subdivisions 0
grep -q 'A ball of another stiffness is there' out && grep -q 'Press next at' out || fail "words: $(cat out)"

# ---- none ----
expect 0 inclusion plain.json none_*.csv --subdivisions 0
grep -q 'Neither a ball nor a layer is found' out || fail "something where nothing is: $(cat out)"

# ---- a layer, by relaxed presses of one depth whose gain is known, and its box in the model ----
model '{"name": "skin", "box": {"low_mm": [-1, 11, -1], "high_mm": [25, 19, 25]}, "stiffness_factor": 6}' >skin.json
for x in 5 12 19; do
    for z in 5 12 19; do
        expect 0 simulate skin.json --protocol static --relaxed --depth-mm 1.5 --tip sphere --tip-radius-mm 5 --tip-x-mm $x --tip-z-mm $z \
            --noise-N 1e-4 --seed $((x + z)) --out "skin_${x}_$z.csv"
    done
done
expect 0 inclusion plain.json skin_*.csv --subdivisions 0 --gain known --out layered.json --json
grep -q '"kind": "layer"' out || fail "no layer: $(cat out)"
grep -q '"name": "inclusion", "box"' layered.json || fail "no layer in the model: $(cat layered.json)"
expect 0 inclusion plain.json skin_*.csv --subdivisions 0 --gain known
grep -q 'A layer of another stiffness is there' out && grep -q 'thickness' out || fail "words: $(cat out)"

# ---- a ball in tetrahedra, which have no finer lattice ----
tetrahedra() { # REGIONS
    sed -e "s|\"mesh\".*|\"mesh\": {\"kind\": \"file\", \"path\": \"$ROOT/data/meshes/box_tetra.msh\", \"scaling\": \"continuum\"},|" \
        -e "s|\"regions\".*|\"regions\": [$1]}|" plain.json
}
tetrahedra '' >soft.json
tetrahedra '{"name": "hidden", "sphere": {"centre_mm": [10, 16, 14], "radius_mm": 5.5}, "stiffness_factor": 8}' >ball.json
for x in 6 10 14 18; do
    for z in 6 12 18; do
        expect 0 simulate ball.json --protocol static --relaxed --depth-mm 1.5 --tip sphere --tip-radius-mm 5 --tip-x-mm $x --tip-z-mm $z \
            --noise-N 1e-4 --seed $((x * z)) --out "tetra_${x}_$z.csv"
    done
done
expect 0 inclusion soft.json tetra_*.csv --json
grep -q '"kind": "ball"' out || fail "no ball in tetrahedra: $(cat out)"

# ---- bad input ----
expect 2 inclusion plain.json
says 'name a NETWORK.json and presses'
expect 1 inclusion plain.json ball_5_*.csv
says 'at least 8 presses'
expect 1 inclusion "$DATA/lumped_n1.json" ball_*.csv
says 'is a lumped model'
sed '/tip.[xz]_mm/d' ball_5_5.csv >nowhere.csv
expect 1 inclusion plain.json nowhere.csv ball_*.csv
says 'nowhere.csv: a press of a map is by a sphere at a place'
sed '/tip.x_mm/d' ball_5_5.csv >half.csv
expect 1 inclusion plain.json half.csv ball_*.csv
says 'half.csv: the place of a sphere needs both'
sed 's/\(tip.kind: *"\{0,1\}\)sphere/\1flat/' ball_5_5.csv >flat.csv
expect 1 inclusion plain.json flat.csv ball_*.csv
says 'flat.csv: its tip.kind "flat"'
sed 's/tip.x_mm: 5/tip.x_mm: 500/' ball_5_5.csv >away.csv
expect 1 inclusion plain.json away.csv ball_*.csv
says 'away.csv: nothing of the network is below the sphere'
expect 1 inclusion plain.json ball_*.csv --out ball_5_5.csv

done_testing
