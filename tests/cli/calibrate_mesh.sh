#!/bin/sh
# calibrate_mesh.sh: the lumped material on meshes of tetrahedra: three sizes of two bodies, a lattice, another solver. check: once
. tests/cli/common

L=$DATA/lumped_n1.json M=$ROOT/data/meshes
# on MESH MODEL: the model on another mesh.
on() { sed "s|\"path\": \"[^\"]*\"|\"path\": \"$1\"|; s|\"height_mm\": [0-9.]*, ||" "$2"; }
# forces MODEL DEPTH: depth and force of a relaxed press.
forces() { expect 0 simulate "$1" --protocol static --depth-mm "$2" --relaxed --out press.csv; grep '^[0-9]' press.csv | cut -d, -f2,3; }
# worst A B: largest difference of two presses at the same depths, by the second's largest force, percent.
worst() {
    paste -d, "$1" "$2" | awk -F, '{ d = $2 - $4; d = d < 0 ? -d : d; w = d > w ? d : w; p = $4 > p ? $4 : p }
        END { print 100 * w / p }'
}
below() { awk -v a="$2" -v b="$3" 'BEGIN { exit !(a != "" && a < b) }' || fail "$1: $2, not below $3"; }

# 1. Each mesh of a body takes the lumped force (half of what the goal asks), and writes what it did.
for mesh in cylinder_tetra box_tetra sphere_4.4 sphere_3.8 sphere_3.2 liver_9 liver_7.5 liver_6.5; do
    case $mesh in sphere*) d=5 ;; liver*) d=8 ;; *) d=7 ;; esac
    expect 0 calibrate $L --mesh $M/$mesh.msh --stage static --steps 100 --depth-mm $d --out $mesh.json --json
    near "$mesh: depth reached" "$(value out reached_depth_mm)" $d 1e-6
    grep -q '"scaling": "continuum", "area_mm2": 452.389' $mesh.json || fail "$mesh: no scaling in the model"
    forces $mesh.json $d >got
    awk -F, '{ e = $1 / 24; print $1 "," e * (8.18 + e * (-0.70 + e * (47.47 + e * (-131.36 + e * 146.89)))) }' got >wanted
    below "$mesh: error, % of the largest force" "$(worst got wanted)" 2.5
done

# 2. One material for all meshes: what the cylinder took, on three sizes of each body, within 5 % of the solid (CalculiX,
#    0.2845 and 1.710 N per kPa) at small strain, and of the middle size to a strain of 0.25.
stiffness() { awk -F, -v h="$2" '$1 > 0 { print $2 / ($1 / h); exit }' "$1"; }
forces cylinder_tetra.json 0.024 >cylinder
modulus=$(stiffness cylinder 24 | awk '{ print $1 / 0.4694 }')
for body in "sphere 18 0.2845 4.4 3.8 3.2" "liver 30 1.710 9 7.5 6.5"; do # height, solid, sizes
    set -- $body
    name=$1 height=$2 solid=$3 middle=$5
    shift 3
    for size in $middle "$@"; do
        on $M/${name}_$size.msh cylinder_tetra.json >$name.json
        forces $name.json "$(awk -v h="$height" 'BEGIN { print 0.001 * h }')" >small
        near "$name $size: stiffness" "$(stiffness small "$height")" "$(awk -v a="$solid" -v b="$modulus" 'BEGIN { print a * b }')" 0.05
        forces $name.json "$(awk -v h="$height" 'BEGIN { print 0.25 * h }')" >${name}_$size
        below "$name $size beside $middle, %" "$(worst ${name}_$size ${name}_$middle)" 5
    done
done

# 3. The lattice meshed as tetrahedra: its law times one factor gives its force within 3 %.
expect 0 calibrate $L --nodes 5 --stage static --steps 100 --depth-mm 7 --out lattice.json
forces lattice.json 7 >lattice
sed 's|"mesh": {.*}|"mesh": {"kind": "file", "path": "'$M'/box_tetra.msh", "scaling": "continuum"}|' lattice.json >tetra.json
forces tetra.json 7 >tetra
paste -d, tetra lattice | awk -F, '$4 > 0 { a += $2 * $4; b += $2 * $2 } END { printf "%.12g\n", a / b }' >factor
awk -F, -v f="$(cat factor)" '{ print $1 "," f * $2 }' tetra >scaled
paste -d, scaled lattice | awk -F, '$4 > 0 { d = $2 / $4 - 1; if (d < 0) d = -d; if (d > 0.03) { print; bad = 1 } }
    END { exit bad || NR < 50 }' || fail "the lattice as tetrahedra: a force off by more than 3 %"
forces box_tetra.json 7 >calibrated
below "the lattice and the tetrahedra, both calibrated, %" "$(worst calibrated lattice)" 3

# 4. Arms too.
expect 0 calibrate $DATA/lumped_n2.json --mesh $M/box_tetra.msh --stage all --depth-mm 3,5 --hold-s 50 --strain-dependent --out arms.json --json
values out max_error_percent | awk '$1 > 1 { print; bad = 1 } END { exit bad || NR < 2 }' || fail "arms: an error above 1 %"

# 5. CalculiX on the scaled network agrees.
if command -v ccx >/dev/null; then
    expect 0 export box_tetra.json --strain 0.1,0.2 --out deck.inp
    OMP_NUM_THREADS=1 ccx -i deck >log 2>&1 || fail "ccx"
    awk '/time/ { t = $NF + 0 } !/force/ && NF == 3 && t == 2 { print -$2 }' deck.dat >theirs
    forces box_tetra.json 4.8 >ours
    near "CalculiX at strain 0.2" "$(cat theirs)" "$(awk -F, '$1 > f { f = $1; v = $2 } END { print v }' ours)" 1e-4
fi

# 6. What is refused, and hexahedra by themselves.
expect 1 calibrate $L --nodes 3 --scaling volume
says "the lattice: scaling needs a mesh of tetrahedra"
expect 2 calibrate $L --start lattice.json --scaling none
says "--scaling and --area-mm2 go with --nodes or --mesh"
expect 2 calibrate $L --mesh $M/box_tetra.msh --scaling none --area-mm2 5
says "--area-mm2 goes with --scaling volume or continuum"
expect 1 calibrate $L --mesh $M/box_hexa.msh --scaling continuum
says "box_hexa.msh: scaling needs a mesh of tetrahedra"
expect 0 calibrate $L --mesh $M/box_hexa.msh --hex-diagonals --stage static --steps 100 --out hexa.json
grep -q '"scaling": "continuum", "area_mm2": 452.389' hexa.json || fail "hexahedra with diagonals were not scaled"
expect 0 calibrate $L --nodes 3 --scaling none --stage static --steps 100 --out plain.json
grep -q scaling plain.json && fail "--scaling none scales"
grep -q '"size_mm": \[24, 24, 24\], "scaling": "continuum"}' lattice.json || fail "a lattice was not scaled"

# 7. Poisson's ratio: the law is fitted with it, the model has it, and what cannot says so.
expect 0 calibrate $L --nodes 4 --stage static --steps 200 --depth-mm 7 --poisson 0.45 --out solid.json
grep -q '"poisson_ratio": 0.45' solid.json || fail "no Poisson's ratio in the model"
expect 0 calibrate $L --start solid.json --stage static --steps 200 --depth-mm 7 --out again.json
grep -q '"poisson_ratio": 0.45' again.json || fail "--start lost Poisson's ratio"
expect 0 calibrate $L --start solid.json --stage static --steps 200 --depth-mm 7 --poisson 0.25 --out springs.json
grep -q 'poisson_ratio' springs.json && fail "springs alone have 0.25"
forces solid.json 7 >solid.csv
forces $L 7 >lumped.csv
near "pressed by 7 mm" "$(tail -1 solid.csv | cut -d, -f2)" "$(tail -1 lumped.csv | cut -d, -f2)" 0.01
expect 0 export solid.json --strain 0.1 --out deck.inp # calculix.sh compares the forces
grep -q '^\*HYPERFOAM' deck.inp || fail "no solids in the deck"
expect 1 calibrate $L --mesh $M/box_hexa.msh --stage static --poisson 0.4 --steps 100
says "an element between any two corners"
expect 2 calibrate $L --nodes 3 --poisson 0.2
says "--poisson is from 0.25 to 0.49"
expect 0 calibrate $L --mesh $M/box_tetra.msh --stage static --steps 100 --depth-mm 2 --poisson 0.49 --out tetra.json
says "tetrahedra lock"
sed 's/"poisson_ratio": 0.45/"volume_modulus_Pa": 4260.41/' solid.json >volume.json
expect 0 calibrate $L --start volume.json --stage static --steps 200 --depth-mm 7 --out volumes.json
grep -q '"volume_modulus_Pa": 4260.41' volumes.json || fail "--start lost the volume modulus"
expect 0 export volumes.json --strain 0.1 --out deck.inp
grep -q 'TYPE=C3D4' deck.inp || fail "no tetrahedra in the deck"
done_testing
