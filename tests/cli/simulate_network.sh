#!/bin/sh
# simulate_network.sh: networks against figures of other solvers, branches, frames. check: asan
. tests/cli/common

# Fully relaxed, strain 0.1, 0.2, 0.3, 0.4: two independent solvers agree on these to 4e-9.
forces() { # file, nodes
    for pair in $3; do
        depth=$(echo "${pair%:*}" | awk '{ printf "%.10g", 24 * $1 }')
        got=$(awk -F, -v d="$depth" '/^[0-9]/ { x = $2 - d; if (x < 1e-9 && x > -1e-9) print $3 }' "$1")
        near "$2 nodes at strain ${pair%:*}" "$got" "${pair#*:}" 1e-6
    done
}
expect 0 simulate $DATA/network_27.json --protocol static --depth-mm 9.6 --relaxed --out 27.csv
says "warning: the network buckles between"
says "--branch stable follows a stable one"
forces 27.csv 27 "0.1:0.851966 0.2:1.831668 0.3:2.961096 0.4:4.306510"
sed 's/\[3, 3, 3\]/[5, 5, 5]/' $DATA/network_27.json >5.json # the same law
expect 0 simulate 5.json --protocol static --depth-mm 9.6 --relaxed --out 125.csv
forces 125.csv 125 "0.1:2.551424 0.2:5.479929 0.3:9.052187 0.4:13.264005"
expect 0 simulate $DATA/network_27.json --nodes 5 --protocol static --depth-mm 9.6 --relaxed --out nodes.csv
grep '^[0-9]' 125.csv >a; grep '^[0-9]' nodes.csv >b; cmp -s a b || fail "--nodes 5 differs from a 5 x 5 x 5 model"
for solver in band simplicial; do
    expect 0 simulate 5.json --protocol static --depth-mm 9.6 --relaxed --solver $solver --json
    near "$solver" "$(value out final_force_N)" 13.264005 1e-6
done
near "buckling, 125 nodes: from strain" "$(value out stable_strain)" 0.3275 0 0.006
near "buckling, 125 nodes: to strain" "$(value out unstable_strain)" 0.3275 0 0.006
expect 0 simulate 5.json --protocol static --depth-mm 9.6 --relaxed --branch stable --json
near "stable branch" "$(value out final_force_N)" 12.975 1e-3
expect 0 simulate 5.json --protocol static --depth-mm 6 --relaxed --json
[ -s err ] && fail "a warning below the loss of stability: $(cat err)"
grep -q '"buckling": null' out || fail "buckling is not null below the loss of stability"

# With an arm: fixed and error-controlled steps agree, as do a run and the run that follows it.
sed 's/"arms": \[\]/"arms": [{"stiffness_N": 0.14, "viscosity_Ns": 1.9}]/' $DATA/network_27.json >arm.json
expect 0 simulate arm.json --protocol ramp_hold --depth-mm 6 --hold-s 20 --dt-ms 5 --json --out fixed.csv
fine=$(value out peak_force_N)
expect 0 simulate arm.json --protocol ramp_hold --depth-mm 6 --hold-s 20 --json --out graded.csv --vtu frames --vtu-every 20
near "peak, graded against fixed steps" "$(value out peak_force_N)" "$fine" 2e-4
steps=$(($(grep -c '^[0-9]' graded.csv) - 1)) # rows after the start
[ "$steps" -lt 1000 ] || fail "graded steps: $steps"
[ -s frames/network.pvd ] || fail "--vtu: no network.pvd"
[ "$(ls frames/*.vtu | wc -l)" -eq $(((steps + 19) / 20)) ] || fail "--vtu-every 20 of $steps steps: $(ls frames | wc -l) files"
awk -F, '/^[0-9]/ && ++n % 40 == 0 || /^[a-z#]/' fixed.csv >some.csv
expect 0 simulate arm.json --like some.csv --out like.csv
grep '^[0-9]' some.csv >a; grep '^[0-9]' like.csv >b
paste -d, a b | awk -F, '{ d = $3 - $6; t = $1 - $4; if (d < 0) d = -d; if (t < 0) t = -t
    if (t > 1e-9 || (NR > 3 && d > 3e-3)) { print; bad = 1 } } END { exit bad || NR < 50 }' || fail "--like"
expect 0 simulate arm.json --protocol creep --force-N 1.5 --hold-s 20 --json
near "creep: final force" "$(value out final_force_N)" 1.5 1e-8
expect 0 simulate arm.json --protocol cyclic --depth-mm 3 --cycles 2 --json
near "cyclic: final depth" "$(value out final_depth_mm)" 0 0 1e-9

# Tetrahedra that a deep press turns inside out are told, and counted.
cat >box.json <<J
{"palpate": {"model": 1}, "kind": "network", "stiffness": {"kind": "polynomial", "coefficients_N": [5]},
 "mesh": {"kind": "file", "path": "$ROOT/data/meshes/box_tetra.msh"}}
J
expect 0 simulate box.json --protocol static --depth-mm 3 --json
[ "$(value out inverted)" = 0 ] && ! grep -q 'are inverted' err || fail "inverted at 3 mm: $(value out inverted), $(cat err)"
expect 0 simulate box.json --protocol static --depth-mm 12 --branch stable --json
inverted=$(value out inverted)
[ "${inverted:-0}" -gt 0 ] || fail "not inverted at 12 mm: $inverted"
grep -q "warning: up to $inverted of 384 tetrahedra of the mesh are inverted at once" err || fail "no warning: $(cat err)"
done_testing
