#!/bin/sh
# calculix.sh: CalculiX on the exported decks agrees to 1e-4.
. tests/cli/common
command -v ccx >/dev/null || { echo "ccx is not installed"; exit 77; }
OMP_NUM_THREADS=1
export OMP_NUM_THREADS

agrees() { # name, model, wanted forces at strain 0.1, 0.2, 0.3, 0.4
    expect 0 export "$2" --strain 0.1,0.2,0.3,0.4 --out "$1.inp"
    grep -c '^\*STEP' "$1.inp" | grep -q '^4$' || fail "$1: not four steps"
    # at most 199 points a table: CalculiX resamples longer ones
    awk '/^\*/ { spring = /^\*SPRING/; n = 0; next } spring && ++n > 199 { exit 1 }' "$1.inp" || fail "$1: a longer table"
    ccx -i "$1" >"$1.log" 2>&1 || { fail "ccx $1"; tail -n 5 "$1.log"; }
    step=0
    for wanted in $3; do
        step=$((step + 1))
        got=$(awk -v s=$step '/time/ { t = $NF + 0 } !/force/ && NF == 3 && t == s { print -$2 }' "$1.dat")
        near "$1 at strain 0.$step" "$got" "$wanted" 1e-4
    done
}
sed 's/\[3, 3, 3\]/[5, 5, 5]/' $DATA/network_27.json >5.json
agrees deck27 $DATA/network_27.json "0.851966 1.831668 2.961096 4.306510"
agrees deck125 5.json "2.551424 5.479929 9.052187 13.264005"

# Any model: the network that simulate presses gives the same.
cat >spline.json <<'J'
{"palpate": {"model": 1}, "kind": "network", "specimen": {"height_mm": 30},
 "stiffness": {"kind": "spline", "strain": [0, 0.1, 0.2, 0.4], "stiffness_N": [0.5, 0.6, 0.9, 1.4]},
 "arms": [], "mesh": {"kind": "lattice", "nodes": [3, 4, 3], "size_mm": [20, 30, 25]}, "formulation": "history"}
J
expect 0 simulate spline.json --protocol static --depth-mm 6 --relaxed --json
ours=$(value out final_force_N)
expect 0 export spline.json --depth-mm 6 --out box.inp
ccx -i box >box.log 2>&1 || fail "ccx box"
near "box of 30 mm at 6 mm" "$(awk '!/force/ && NF == 3 { f = -$2 } END { print f }' box.dat)" "$ours" 1e-4
expect 0 export spline.json --depth-mm 6
cmp -s out box.inp || fail "standard output differs from --out"

# A region that is stiffer, and does not end at nodes.
sed 's/"mesh"/"regions": [{"name": "nodule", "sphere": {"centre_mm": [9, 14, 11], "radius_mm": 8}, "stiffness_factor": 6}], "mesh"/' spline.json >region.json
expect 0 simulate region.json --protocol static --depth-mm 6 --relaxed --json
stiffer=$(value out final_force_N)
awk -v a="$stiffer" -v b="$ours" 'BEGIN { exit !(a > 1.1 * b) }' || fail "a region of no effect: $stiffer"
expect 0 export region.json --depth-mm 6 --out region.inp
ccx -i region >region.log 2>&1 || fail "ccx region"
near "box with a stiff region" "$(awk '!/force/ && NF == 3 { f = -$2 } END { print f }' region.dat)" "$stiffer" 1e-4

# With Poisson's ratio. A tetrahedron's volume is that of CalculiX. A cell's is the mean over it, and at its middle in CalculiX, which
# differs where cells bend: at 5 nodes a side by 0.4 % of the force at a strain of 0.1, by 1.1 % at 0.2.
solid() { # name, file, depth in mm, tolerance
    expect 0 simulate "$2" --protocol static --depth-mm "$3" --relaxed --json
    ours=$(value out final_force_N)
    expect 0 export "$2" --depth-mm "$3" --out "$1.inp"
    ccx -i "$1" >"$1.log" 2>&1 || fail "ccx $1"
    near "$1 at $3 mm" "$(awk '!/force/ && NF == 3 { f = -$2 } END { print f }' "$1.dat")" "$ours" "$4"
}
cp "$ROOT/data/meshes/sphere_4.4.msh" .
cat >tetrahedra.json <<'J'
{"palpate": {"model": 1}, "kind": "network", "stiffness": {"kind": "polynomial", "coefficients_N": [8, 0, 40]}, "arms": [],
 "poisson_ratio": 0.4, "mesh": {"kind": "file", "path": "sphere_4.4.msh", "scaling": "continuum"}}
J
solid tetrahedra tetrahedra.json 1 3e-4
sed 's/"mesh": .*/"mesh": {"kind": "lattice", "nodes": [5, 5, 5], "size_mm": [24, 24, 24], "scaling": "continuum"}}/; s/0.4,/0.45,/' tetrahedra.json >cells.json
solid cells cells.json 2.4 0.006
sed 's/"poisson_ratio": 0.45, //' cells.json >springs.json
expect 0 simulate springs.json --protocol static --depth-mm 2.4 --relaxed --json
awk -v a="$ours" -v b="$(value out final_force_N)" 'BEGIN { exit !(a > 1.05 * b) }' || fail "Poisson's ratio makes no difference: $ours"
# Cells at the edges of bonded faces are softer; and a stiff region with a ratio of its own.
sed 's/"poisson_ratio"/"edge_correction": true, &/' cells.json >edges.json
before=$ours
solid edges edges.json 2.4 0.006
awk -v a="$ours" -v b="$before" 'BEGIN { exit !(a < 0.95 * b) }' || fail "corrected edges make no difference: $ours"
sed 's/"mesh"/"regions": [{"name": "nodule", "sphere": {"centre_mm": [4, 4, 4], "radius_mm": 1.5}, "stiffness_factor": 3, "poisson_ratio": 0.3}], &/' \
    tetrahedra.json >nodule.json
solid nodule nodule.json 1 3e-4
done_testing
