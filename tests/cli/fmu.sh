#!/bin/sh
# fmu.sh: FMUs of models: FMPy finds no fault with them, and their forces are those of palpate simulate. check: once
. tests/cli/common
expect 0 export "$DATA/lumped_n2.json" --to fmu --out lumped.fmu 2>/dev/null
if grep -q "built without minizip" err; then
    echo "this palpate was built without minizip: install libminizip-dev and build it again"; exit 77
fi
expect 0 export "$DATA/network_27.json" --to fmu --out network.fmu
cp network.fmu first.fmu
expect 0 export "$DATA/network_27.json" --to fmu --out network.fmu
cmp network.fmu first.fmu || fail "the same model gives another file"
cat >box.json <<'J'
{"palpate": {"model": 1}, "kind": "network", "specimen": {"kind": "cylinder", "height_mm": 24, "radius_mm": 12},
 "stiffness": {"kind": "polynomial", "coefficients_N": [2, 1]}, "arms": [{"stiffness_N": 1, "viscosity_Ns": 0.3}],
 "mesh": {"kind": "file", "path": "mesh/box.msh"}}
J
cat >softens.json <<'J'
{"palpate": {"model": 1}, "kind": "lumped", "specimen": {"kind": "cylinder", "height_mm": 24, "radius_mm": 12},
 "stiffness": {"kind": "polynomial", "coefficients_N": [2, 1]}, "arms": [],
 "effects": [{"id": "toe_region", "parameters": {"length_mm": 1}}]}
J
mkdir mesh && cp "$ROOT/data/meshes/box_tetra.msh" mesh/box.msh
expect 0 export box.json --to fmu --out box.fmu
mv mesh elsewhere # the FMU has its own
expect 1 export softens.json --to fmu --out none.fmu; says "its effect toe_region is of the specimen or contact"
expect 2 export "$DATA/lumped_n2.json" --to fmu; says "name the FMU by --out"
expect 2 export "$DATA/lumped_n2.json" --to fmu --depth-mm 3 --out none.fmu; says "takes its depths from the importer"
expect 1 export "$DATA/lumped_n2.json" --to fmu --out /dev/null; says "/dev/null: cannot write: it is no regular file"
expect 1 export no.json --to fmu --out none.fmu; says "no.json"
[ -e none.fmu ] && fail "an FMU although it failed"

press() { # MODEL OPTIONS...: MODEL.csv
    model=$1; shift
    expect 0 simulate "$DATA/$model.json" --dt-ms 10 --out "$name.csv" "$@"
}
name=lumped; press lumped_n2 --protocol ramp_hold --depth-mm 6 --ramp-s 1 --hold-s 5
name=cycles; press lumped_n2 --protocol cyclic --depth-mm 6 --rate-mm-s 4 --cycles 2
name=network; press network_27 --protocol ramp_hold --depth-mm 6 --ramp-s 1 --hold-s 2
mv elsewhere mesh
expect 0 simulate box.json --protocol ramp_hold --depth-mm 3 --ramp-s 1 --hold-s 1 --dt-ms 20 --out box.csv
expect 0 simulate box.json --protocol ramp_hold --depth-mm 2 --ramp-s 1 --hold-s 1 --dt-ms 20 --tip sphere --tip-radius-mm 8 --out sphere.csv
mv mesh elsewhere
python_with fmpy fmpy
"$python" -B "$ROOT/tests/cli/fmu.py" 2>said || { fail "fmu.py"; tail -n 5 said; }
done_testing
