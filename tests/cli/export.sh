#!/bin/sh
# export.sh: solids of other programs: CalculiX and MuJoCo, where they are installed, give the force that the file says; every scene
# is well-formed; units do not matter; what cannot be exported is refused. check: once
. tests/cli/common
command -v python3 >/dev/null || { echo "there is no python3"; exit 77; }
OMP_NUM_THREADS=1
export OMP_NUM_THREADS
cat >network.json <<'J'
{"palpate": {"model": 1}, "kind": "network", "specimen": {"kind": "cylinder", "height_mm": 24, "radius_mm": 12},
 "stiffness": {"kind": "polynomial", "coefficients_N": [8.18, -0.7, 47.47, -131.36, 146.89]},
 "arms": [{"stiffness_N": 1.3, "viscosity_Ns": 17.9}, {"stiffness_N": 1, "viscosity_Ns": 1.5}],
 "poisson_ratio": 0.4, "mesh": {"kind": "lattice", "nodes": [4, 5, 4], "size_mm": [24, 24, 24], "scaling": "continuum"}}
J

# ---- CalculiX: the force of each law, and of a mesh of tetrahedra, is that of the result ----
solid() { # name, options...
    name=$1; shift
    expect 0 export "$@" --out "$name.inp" --json
    ccx -i "$name" >"$name.log" 2>&1 || fail "ccx $name"
    near "$name" "$(awk '!/force/ && NF == 3 { f = -$2 } END { print f }' "$name.dat")" "$(value out "${key:-ramp_N}")" 1e-4
}
if command -v ccx >/dev/null; then
    for law in neo-hookean mooney-rivlin yeoh; do
        solid "held_$law" network.json --to calculix --law $law --depth-mm 6
    done
    solid slides network.json --to calculix --law neo-hookean --depth-mm 6 --slide --poisson 0.3
    cp "$ROOT/data/meshes/cylinder_tetra.msh" .
    sed 's/"mesh": .*/"mesh": {"kind": "file", "path": "cylinder_tetra.msh", "scaling": "continuum"}}/' network.json >cylinder.json
    solid cylinder cylinder.json --to calculix --law neo-hookean --depth-mm 3
    # Abaqus' keywords: CalculiX skips *VISCOELASTIC and gives the relaxed force, which a long dwell ends at.
    expect 0 export network.json --to abaqus --depth-mm 6 --hold-s 1e5 --out abaqus.inp --json
    sed 's/TOTALS=YES/TOTALS=ONLY/; s/^RF2/RF/; s/,MODULI=LONG TERM//; s/^\*VISCO,.*/*STATIC/' abaqus.inp >plain.inp
    ccx -i plain >plain.log 2>&1 || fail "ccx plain"
    near "Abaqus' deck" "$(awk '!/force/ && NF == 3 { f = -$2 } END { print f }' plain.dat)" "$(value out dwell_N)" 1e-4
else
    echo "ccx is not installed: no deck was run"
fi

# ---- recordings: the stated error is that of the force ----
cp "$DATA/lumped_n1.json" lumped.json
expect 0 simulate lumped.json --protocol ramp_hold --depth-mm 5 --rate-mm-s 1 --hold-s 60 --sample-Hz 10 --air-s 1 --noise-N 0.005 \
    --seed 3 --out run.csv
expect 0 export lumped.json --to abaqus --runs run.csv --hold-s 60 --nodes 5 --out lumped.inp --json
grep -q '"against": "recordings"' out || fail "not against the recording"
last=$(tail -n 50 run.csv | awk -F, '{ s += $3 } END { print s / NR }')
near "the end of the dwell" "$(value out dwell_N)" "$last" 0 "$(value out worst_N)"
peak=$(value out peak_N)
rms=$(value out rms_N)
awk -v r="$rms" -v p="$peak" -v m="$(value out model_rms_N)" 'BEGIN { exit !(r > 0.004 && r < 0.02 * p && m > 0.004 && m < 0.006) }' ||
    fail "errors $rms of $peak"
grep -q "against 1 recording" lumped.inp || fail "the deck does not state its error"
expect 0 export lumped.json --to abaqus --nodes 5 --out own.inp
grep -q "against the model's own (no recording was given)" own.inp || fail "the deck does not say what it was fitted to"
grep -q "error at most" err || fail "the terminal does not say the error"

# ---- each scene is well-formed, and has the parameters of the result ----
for to in febio sofa mujoco newton vega; do
    expect 0 export network.json --to $to --depth-mm 6 --out scene.$to --json
    mv out $to.json
    grep -q "error at most" scene.$to || fail "$to: no stated error"
done
python3 - <<'P' || fail "a scene"
import ast, json, math
import xml.etree.ElementTree as xml
result = {t: json.load(open(t + ".json")) for t in ("febio", "sofa", "mujoco", "newton", "vega")}
young = lambda r: 2 * (1 + r["poisson_ratio"]) * r["shear_Pa"]
same = lambda a, b: math.isclose(float(a), b, rel_tol=1e-9) or (print(a, b), exit(1))
root = xml.parse("scene.febio").getroot()
same(root.find("Material/material/elastic/E").text, 1e-6 * young(result["febio"]))
same(root.find("Material/material/g1").text, result["febio"]["arms"][0]["share"])
same(len(root.findall("Mesh/Nodes/node")), 80)
same(len(root.findall("Mesh/Elements/elem")), 216)
same(len(root.find("Mesh/NodeSet[@name='held15']").text.split(",")), 16)
root = xml.parse("scene.sofa").getroot()
law = root.find("Node/TetrahedronHyperelasticityFEMForceField").get("ParameterSet").split()
same(law[0], result["sofa"]["shear_Pa"])
same(law[1], result["sofa"]["lambda_Pa"])
same(len(root.find("Node/TetrahedronSetTopologyContainer").get("tetrahedra").split()), 4 * 216)
root = xml.parse("scene.mujoco").getroot()
same(root.find("deformable/flex/elasticity").get("young"), young(result["mujoco"]))
same(len(root.find("deformable/flex").get("body").split()), 80)
names = {t.targets[0].id: t.value for t in ast.parse(open("scene.newton").read()).body if isinstance(t, ast.Assign) and
         isinstance(t.targets[0], ast.Name)}
same(len(names["VERTICES"].args[0].elts), 80)
same(len(names["TOP"].args[0].elts), 16)
text = open("scene.vega").read()
same(text.split("ENU,")[1].split(",")[1], young(result["vega"]))
same(text.split("TET\n")[1].split()[0], 216)
P

# A name of a file ends neither a comment nor a string.
odd='a--b"""\<&-->.json'
cp network.json "$odd"
expect 0 export "$odd" --to febio --depth-mm 2 --out odd.feb
expect 0 export "$odd" --to newton --depth-mm 2 --out odd.py
python3 -c "import ast, xml.etree.ElementTree as x; x.parse('odd.feb'); ast.parse(open('odd.py').read())" || fail "an odd name"

# ---- MuJoCo, where its package is ----
if python3 -c "import mujoco" 2>/dev/null; then
    python3 "$ROOT/tests/cli/export_run.py" mujoco scene.mujoco mujoco.json >pressed || fail "MuJoCo"
    near "MuJoCo after the dwell" "$(awk '/dwell/ { print $2 }' pressed)" "$(value mujoco.json dwell_N)" 1e-3 # the actuator gives way by a share of 1 / 2000
    expect 0 export network.json --to mujoco --depth-mm 3 --slide --out slide.mujoco --json
    mv out slide.json
    python3 "$ROOT/tests/cli/export_run.py" mujoco slide.mujoco slide.json >pressed || fail "MuJoCo between plates that slide"
    near "MuJoCo, sliding" "$(awk '/dwell/ { print $2 }' pressed)" "$(value slide.json dwell_N)" 1e-3
else
    echo "the Python package mujoco is not installed: its scene was not run"
fi

# ---- units: lengths by 10, forces by 100 ----
sed 's/"height_mm": 24.0/"height_mm": 240/; s/"radius_mm": 12.0/"radius_mm": 120/
    s/\[8.18, -0.70, 47.47, -131.36, 146.89\]/[818, -70, 4747, -13136, 14689]/; s/1.2962987/129.62987/; s/17.873062/1787.3062/' lumped.json >large.json
for to in abaqus newton; do
    expect 0 export lumped.json --to $to --depth-mm 4 --nodes 4 --out small --json
    mv out small.json
    expect 0 export large.json --to $to --depth-mm 40 --rate-mm-s 10 --nodes 4 --out big --json
    for k in shear_Pa viscosity_Pa_s share; do
        [ -z "$(value small.json $k)" ] || near "$to: $k" "$(value out $k)" "$(value small.json $k)" 1e-6
    done
    near "$to: force" "$(value out dwell_N)" "$(awk -v f="$(value small.json dwell_N)" 'BEGIN { printf "%.12g", 100 * f }')" 1e-6
done

# ---- refused ----
expect 2 export network.json --to ansys; says "--to"
expect 2 export network.json --to mujoco --law yeoh; says "mujoco has no law yeoh"
expect 2 export network.json --to newton --slide; says "newton's plates hold the tissue"
expect 2 export network.json --to febio --json; says "--json needs --out"
expect 2 export network.json --depth-mm 1 --runs run.csv; says "--runs is for a solid"
expect 2 export network.json --to febio --depth-mm 1,2; says "one depth"
expect 2 export network.json --to febio --depth-mm 24; says "not below the height"
expect 2 export network.json --to febio --poisson 0.5; says "--poisson"
expect 1 export network.json --to febio --runs no.csv --out refused; says "no.csv"
sed '1a # tip.kind: "sphere"' run.csv >sphere.csv
expect 1 export network.json --to febio --runs sphere.csv --out refused; says "no recording of a specimen under a plate"
sed 's/, "radius_mm": 12.0//' lumped.json >thin.json
expect 1 export thin.json --to febio --poisson 0.4 --out refused; says "without radius_mm"
sed 's/"mesh"/"regions": [{"name": "n", "sphere": {"centre_mm": [9, 14, 11], "radius_mm": 8}, "stiffness_factor": 6}], "mesh"/' network.json >region.json
expect 1 export region.json --to febio --out refused; says "has regions"
sed 's/"arms": \[/&{"stiffness_N": 1, "viscosity_Ns": 1}, {"stiffness_N": 1, "viscosity_Ns": 2}, {"stiffness_N": 1, "viscosity_Ns": 3}, {"stiffness_N": 1, "viscosity_Ns": 4}, {"stiffness_N": 1, "viscosity_Ns": 5}, /' network.json >arms.json
expect 1 export arms.json --to febio --out refused; says "febio takes 6"
[ ! -e refused ] || fail "a refused export left a file"
done_testing
