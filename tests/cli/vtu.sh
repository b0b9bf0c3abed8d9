#!/bin/sh
# vtu.sh: meshio reads the frames that simulate draws: the mesh of the model, its displacements and strains. check: once
. tests/cli/common
cat >lattice.json <<'J'
{"palpate": {"model": 1}, "kind": "network", "specimen": {"kind": "cylinder", "height_mm": 24, "radius_mm": 12},
 "stiffness": {"kind": "polynomial", "coefficients_N": [40]}, "arms": [{"stiffness_N": 20, "viscosity_Ns": 20}],
 "mesh": {"kind": "lattice", "nodes": [5, 4, 3], "size_mm": [24, 24, 24]}}
J
sed "s|{\"kind\": \"lattice\".*}|{\"kind\": \"file\", \"path\": \"$ROOT/data/meshes/box_tetra.msh\"}}|" lattice.json >tetra.json
for model in lattice tetra; do
    expect 0 simulate $model.json --protocol ramp_hold --depth-mm 2 --ramp-s 1 --hold-s 1 --dt-ms 100 --vtu $model --out $model.csv
done
python_with meshio meshio
"$python" -B "$ROOT/tests/cli/vtu.py" lattice lattice.csv || fail "the lattice is another"
"$python" -B "$ROOT/tests/cli/vtu.py" tetra tetra.csv "$ROOT/data/meshes/box_tetra.msh" || fail "the mesh of tetrahedra is another"
done_testing
