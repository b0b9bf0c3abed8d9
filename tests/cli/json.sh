#!/bin/sh
# json.sh: every JSON that the commands write, and the ones they come with, against doc/schema; doc/json.md is made of it. check: once
. tests/cli/common

S=$ROOT/doc/schema
for python in python3 /usr/bin/python3 ""; do
    [ -z "$python" ] || ! "$python" -c "import jsonschema" 2>/dev/null || break
done
[ -n "$python" ] || { echo "there is no python3-jsonschema"; exit 77; }
"$python" "$S/page.py" | cmp -s - "$ROOT/doc/json.md" || fail "doc/json.md is not what doc/schema/page.py makes of the schemas"
N=$DATA/network_27.json L=$DATA/lumped_n1.json
# Models with every key.
cat >mesh.json <<J
{"palpate": {"model": 1}, "kind": "network", "specimen": {"height_mm": 24, "radius_mm": 12, "kind": "cylinder"}, "density_kg_m3": 0,
 "stiffness": {"kind": "yeoh", "coefficients_Pa": [2000, 300, 40]}, "dashpot_Ns": 0, "quasi_linear": false, "formulation": "history",
 "arms": [{"stiffness_N": 1, "viscosity_Ns": 10, "stiffness_per_strain": 0.1, "time_per_strain": 0.1}], "effects": [],
 "mesh": {"kind": "file", "path": "$ROOT/data/meshes/box_tetra.msh", "scale_mm": 1, "hex_diagonals": false, "scaling": "volume", "area_mm2": 400}}
J
sed 's/"mesh": {.*}}/"mesh": {"kind": "lattice", "nodes": [3, 3, 3], "size_mm": [24, 24, 24], "neighbourhood": 18}, "validity": [{"radius_mm": 3, "depth_mm": 1, "error": 0.1}]}/' mesh.json >lattice.json

# ---- models, runs and results of every form ----
sed 's/"arms"/"effects": [{"id": "sensor_bias", "parameters": {"force_N": 0.03}}], "arms"/' $L >biased.json
press="--hold-s 8 --sample-Hz 25 --air-s 2 --noise-N 0.004 --hum-N 0.001 --clip-N 20"
n=0
for ramp in "4 1" "6 2" "7 0.5" "4 1"; do
    set -- $ramp; n=$((n + 1))
    expect 0 simulate biased.json --protocol ramp_hold --depth-mm $1 --ramp-s $2 $press --seed $n --spike 6,0.2 --drop 3,3.1 --out run_$n.csv
done
expect 0 simulate $L --protocol static --depth-mm 7 --rate-mm-s 0.5 --sample-Hz 5 --noise-N 0.002 --out run_static.csv
expect 0 simulate $L --protocol creep --force-N 1 --ramp-s 1 --hold-s 2 --json --out creep.csv && mv out sim_creep.json
expect 0 simulate $L --protocol cyclic --depth-mm 3 --cycles 2 --out cyclic.csv
expect 0 simulate $L --protocol static --depth-mm 3 --relaxed --out relaxed.csv
expect 0 simulate $L --protocol static --depth-mm 7 --rate-mm-s 0.5 --sample-Hz 5 --noise-N 0.002 --seed 2 --out run_static_2.csv
expect 0 simulate $L --like run_1.csv --out like.csv
expect 0 simulate $N --protocol static --depth-mm 9.5 --branch stable --json --out buckled.csv && mv out sim_network.json
expect 0 characterize run_*.csv --arms auto --degree auto --out lumped.json --result fit_characterize.json --json && mv out characterize.json
expect 0 characterize run_1.csv --arms 1 --degree 2 --json && mv out characterize_one.json
expect 0 simulate $L --protocol ramp_hold --depth-mm 3 --hold-s 60 --sample-Hz 20 --air-s 1 --noise-N 0.004 --out fractional.csv
expect 0 characterize fractional.csv --arms fractional --degree 2 --out fractional.json
expect 0 characterize run_1.csv run_2.csv --arms fractional --degree 2 --out short.json # too short to tell its time, which is no failure
expect 0 characterize run_1.csv run_2.csv --arms 1 --json && mv out characterize_law.json
sed '1a # tip.kind: "flat"\n# tip.radius_mm: 3\n# tip.half_angle_deg: 70' run_1.csv >tip.csv
expect 0 characterize tip.csv --arms 1 --json && mv out characterize_tip.json
for n in a b; do sed "1a # specimen.name: \"$n\"" tip.csv >tip_$n.csv; done
expect 0 characterize tip_a.csv tip_b.csv --specimens name --arms 1 --json && mv out characterize_tips.json
expect 0 characterize tip.csv --arms 1 --tip cone --json && mv out characterize_cone.json
{ printf '# palpate.experiment: 1\n# specimen.height_mm: 24\n# specimen.radius_mm: 12\ntime_s,depth_mm,force_N\n'
  awk 'BEGIN { for (i = 0; i < 800; i++) { t = i / 50; printf "%g,%.6f,0\n", t, (t < 2 ? 2 * (t - 1) : 2) + (t < 4 ? 0 : 0.3 * sin(6.2831853 * (t - 4))) } }'
} >sine_path.csv
expect 0 simulate $L --like sine_path.csv --noise-N 0.002 --out sine.csv
expect 0 characterize sine.csv --arms 1 --degree 2 --json && mv out characterize_sine.json
for factor in 0.8 1.3; do # two more specimens
    awk -F, -v OFS=, -v f=$factor '/^[0-9]/ { $3 *= f } { print }' run_2.csv >softer_$factor.csv
done
expect 0 characterize run_2.csv softer_*.csv --specimens file --arms 1 --degree 2 --out specimens.json --json && mv out characterize_specimens.json
expect 0 simulate lumped.json --protocol ramp_hold --depth-mm 4 --hold-s 2 --band --json && mv out sim_band.json
expect 0 simulate lumped.json --protocol static --depth-mm 12 --json --out deep.csv && mv out sim_deep.json
expect 0 explain --model lumped.json run_?.csv --candidates sensor_bias,sensor_gain,sensor_lag,toe_region --out explained.json \
    --result explain.json --next next.json --json && mv out explain_out.json
for file in explain.json fit_characterize.json; do # a figure of each
    sed -n '/^  "figures"/{n;s/,$//;p;}' $file >figure_$file
done
# A power of time, which these holds do not tell from the draining of pores beyond doubt: a next experiment is named.
plain='"palpate": {"model": 1}, "kind": "lumped", "specimen": {"height_mm": 24}, "stiffness": {"kind": "polynomial", "coefficients_N": [8.2, 3.1]}'
echo "{$plain, \"arms\": [{\"stiffness_N\": 2.4, \"viscosity_Ns\": 12}]}" >guess.json
echo "{$plain, \"arms\": [{\"stiffness_N\": 2.1, \"viscosity_Ns\": 12}],
 \"effects\": [{\"id\": \"power_law_relaxation\", \"parameters\": {\"stiffness_N\": 0.3, \"exponent\": 0.1}}]}" >power.json
n=0
for ramp in "4 1" "6 2" "7 0.5" "4 1"; do
    set -- $ramp; n=$((n + 1))
    expect 0 simulate power.json --protocol ramp_hold --depth-mm $1 --ramp-s $2 --hold-s 20 --sample-Hz 40 --air-s 1 --noise-N 0.004 --seed $n \
        --out power_$n.csv
done
expect 0 explain --false-alarm 0.0001 --model guess.json power_?.csv --candidates power_law_relaxation,poroelastic,relaxation_arm --next next.json --json && mv out explain_power.json
[ -s next.json ] || fail "no next experiment: $(grep verdict explain_power.json)"
grep -q '"nats"' explain_power.json || fail "no odds of the next experiment"
# Without arms and effects the dwells become a free term.
sed 's/"arms": \[[^]]*\]/"arms": []/' guess.json >armless.json
expect 0 explain --model armless.json power_?.csv --max-effects 0 --sparse --out free.json --json && mv out explain_free.json
sed 's/"depends_on": "[a-z_]*"/"depends_on": "place_times_force"/; s/"force_N": \[/"plate_N": 2, &/' free.json >free_gain.json
expect 0 simulate free_gain.json --protocol static --depth-mm 5 --rate-mm-s 1
expect 0 calibrate $L --nodes 3 --stage static --depth-mm 6 --degree 2 --steps 2000 --out static.json --json && mv out cal_static.json
expect 0 calibrate $L --nodes 3 --stage static --depth-mm 6 --law spline --knots 4 --steps 2000 --out spline.json --json && mv out cal_spline.json
expect 0 calibrate $L --nodes 3 --stage all --depth-mm 4 --degree 2 --steps 500 --hold-s 20 --out all.json --json --result fit_calibrate.json && mv out cal_all.json
expect 0 reduce $N --runs run_1.csv,run_2.csv --hold-out 0.5 --modes 3 --samples 20 --out reduced.json --json && mv out reduce.json
expect 0 calibrate $L --stage relaxation --start spline.json --method three_phase --depth-mm 2 --hold-s 20 --dt-ms 20 --json
mv out cal_phases.json
expect 3 calibrate $L --nodes 3 --scaling none --stage all --method three_phase --depth-mm 2 --steps 200 --hold-s 20 --dt-ms 20 --degree 2 --json
mv out cal_thesis.json
for tip in plate "sphere --tip-radius-mm 6"; do
    expect 0 simulate spline.json --protocol static --relaxed --depth-mm 2 --sample-Hz 2 $([ "$tip" = plate ] || echo --tip $tip) --out tip_${tip%% *}.csv
done
expect 0 calibrate $L --nodes 3 --stage static --degree 2 tip_plate.csv tip_sphere.csv --json && mv out cal_tips.json
expect 0 calibrate $L --nodes 3 --stage all --depth-mm 2,4 --steps 200 --hold-s 20 --degree 2 --strain-dependent --json --out beta.json
mv out cal_beta.json
{ printf '# palpate.experiment: 1\n# tool.radius_mm: 4\n# tool.friction: 0.2\ntime_s,depth_mm,force_N,tool_x_mm,tool_y_mm,tool_z_mm\n'
    awk 'BEGIN { for (i = 0; i < 40; i++) printf "%g,0,0,12,%g,12\n", 0.01 * i, 28 - 0.05 * i }'; } >ball.csv
sed s/,12,/,13,/ ball.csv >ball_2.csv
expect 0 reduce $N ball.csv ball_2.csv --hold-out 0 --modes 3 --samples 20 --out ball.json
expect 0 calibrate $L --stage relaxation --start lattice.json --depth-mm 2 --hold-s 20 --json && mv out cal_start.json
set -- experiment=run_1.csv experiment=run_static.csv experiment=creep.csv experiment=cyclic.csv experiment=relaxed.csv experiment=like.csv \
    simulate=sim_creep.json simulate=sim_network.json simulate=sim_deep.json simulate=sim_band.json characterize=characterize_law.json characterize=characterize_specimens.json model=specimens.json model=fractional.json characterize=characterize_tip.json characterize=characterize_tips.json characterize=characterize_cone.json experiment=tip.csv model=lumped.json model=explained.json model=static.json model=spline.json model=all.json \
    model=biased.json model=power.json model=guess.json model=beta.json calibrate=cal_phases.json calibrate=cal_thesis.json calibrate=cal_beta.json characterize=characterize.json characterize=characterize_one.json characterize=characterize_sine.json characterize=fit_characterize.json \
    figure=figure_explain.json figure=figure_fit_characterize.json explain=explain.json explain=explain_out.json explain=explain_power.json calibrate=cal_static.json \
    calibrate=cal_spline.json calibrate=cal_all.json calibrate=cal_tips.json calibrate=fit_calibrate.json reduced=reduced.json reduce=reduce.json
set -- "$@" explain=explain_free.json model=free.json model=free_gain.json protocol=next.json calibrate=cal_start.json reduced=ball.json experiment=ball.csv

# ---- files with every key, which the commands read ----
for model in mesh lattice; do
    expect 0 export $model.json --strain 0.02
    set -- "$@" model=$model.json
done
expect 0 calibrate $L --nodes 3 --stage static --steps 50 --poisson 0.45 --out solid.json
sed 's/"poisson_ratio": 0.45/"volume_modulus_Pa": 2000/' solid.json >volume.json
set -- "$@" model=solid.json model=volume.json
arm='"arms": [{"stiffness_N": 1, "viscosity_Ns": 1, "stiffness_per_strain": 0, "time_per_strain": 0}], "dashpot_Ns": 0.1, "quasi_linear": false'
cat >regions.json <<J
{"palpate": {"model": 2}, "kind": "network", "specimen": {"height_mm": 24, "radius_mm": 12}, "stiffness": {"kind": "polynomial", "coefficients_N": [6]}, "arms": [],
 "mesh": {"kind": "lattice", "nodes": [4, 4, 4], "size_mm": [24, 24, 24], "scaling": "continuum"}, "poisson_ratio": 0.4, "regions": [
 {"name": "nodule", "sphere": {"centre_mm": [12, 14, 12], "radius_mm": 6}, "stiffness_factor": 4, "poisson_ratio": 0.45, "fibre": {"direction": [1, 0, 2], "stiffness_Pa": 5000}},
 {"name": "a", "box": {"low_mm": [0, 0, 0], "high_mm": [4, 4, 4]}, "material": {"stiffness": {"kind": "polynomial", "coefficients_N": [9], "strain_max": 0.4}, $arm}},
 {"name": "b", "box": {"low_mm": [4, 0, 0], "high_mm": [8, 4, 4]}, "material": {"stiffness": {"kind": "neo_hookean", "coefficients_Pa": [3000]}}},
 {"name": "c", "box": {"low_mm": [8, 0, 0], "high_mm": [12, 4, 4]}, "material": {"stiffness": {"kind": "spline", "strain": [0, 0.4], "stiffness_N": [5, 6]}}},
 {"name": "d", "membrane": {"set": "top"}, "material": {"stiffness": {"kind": "polynomial", "coefficients_N": [100]}}}]}
J
sed '/"name": "[abcd]"/d; s/"poisson_ratio": 0.45, "fibre.*/"poisson_ratio": 0.45}]}/' regions.json >nodule.json
expect 0 simulate regions.json --protocol static --depth-mm 1
expect 0 simulate nodule.json --protocol static --relaxed --depth-mm 2 --sample-Hz 2 --tip sphere --tip-radius-mm 6 --tip-x-mm 12 --tip-z-mm 11 --out tip_at.csv
expect 0 simulate nodule.json --protocol static --relaxed --depth-mm 2 --sample-Hz 2 --out tip_no.csv
expect 0 calibrate $L tip_at.csv tip_no.csv --start nodule.json --stage static --degree 0 --poisson 0.4 --fit-region nodule --json && mv out cal_region.json
set -- "$@" model=regions.json experiment=tip_at.csv calibrate=cal_region.json
for x in 6 12 18; do # a map of presses over the nodule, and the network without it
    for z in 6 12 18; do
        expect 0 simulate nodule.json --protocol static --relaxed --depth-mm 1.5 --sample-Hz 5 --tip sphere --tip-radius-mm 6 --tip-x-mm $x --tip-z-mm $z \
            --out map_${x}_$z.csv
    done
done
expect 0 inclusion solid.json map_*.csv --subdivisions 0 --json && mv out inclusion.json
set -- "$@" inclusion=inclusion.json
motion='"depth_mm": 2, "hold_s": 0.1, "air_mm": 1, "air_s": 0.1, "after_s": 0.1, "rest_s": 0.1, "acceleration_mm_s2": 400'
waves='"amplitude_mm": 0.2, "frequency_Hz": 2, "rate_mm_s": 3'
segments='[{"move_to_mm": 1, "rate_mm_s": 5, "acceleration_mm_s2": 100}, {"hold_s": 0.1}, {"cycle_to_mm": 2, "rate_mm_s": 5, "cycles": 1},
 {"sine_mm": 0.1, "frequency_Hz": 2, "cycles": 1}, {"sweep_mm": 0.1, "frequency_Hz": 1, "frequency_end_Hz": 3, "duration_s": 1}, {"force_N": 0.005, "ramp_s": 1, "duration_s": 1, "deepest_mm": 2}]'
cat >protocol.json <<J
{"palpate": {"protocol": 1}, "about": "all", "order": "random", "order_seed": 1, "repeat_first": true, $motion, $waves, "cycles": 1,
 "frequency_end_Hz": 4, "duration_s": 1, "deepest_mm": 3, "runs": [{"kind": "sine", "name": "a", "about": "b", $motion, $waves, "cycles": 1},
 {"kind": "sweep", $motion, $waves, "frequency_end_Hz": 4, "duration_s": 1}, {"kind": "ramp_hold", "ramp_s": 1, $motion},
 {"kind": "segments", "name": "pieces", "deepest_mm": 3, "segments": $segments}]}
J
sed 's/ "rate_mm_s": 3, "cycles"/ "ramp_s": 1, "cycles"/' protocol.json >ramps.json
six='[0, 0, 1e-5, 0, 0, 0]'
echo '{"palpate": {"calibration": 1}, "about": "a test"' >calibration.json
for axis in Fx_N Fy_N Fz_N Tx_Nm Ty_Nm Tz_Nm; do echo ", \"$axis\": $six" >>calibration.json; done
echo '}' >>calibration.json
cat >actuator.json <<J
{"palpate": {"actuator": 1}, "about": "all", "force_constant_N_A": 12, "resistance_ohm": 4, "supply_V": 24, "current_A": 3.5, "moving_kg": 0.4,
 "viscous_Ns_m": 4, "coulomb_N": 0.15, "lift_N": 0.1, "backlash_mm": 0, "travel_mm": 30, "count_mm": 0.001, "start_mm": 5, "compliance_mm_N": 0,
 "winding_K_W": 2.5, "winding_J_K": 40, "case_K_W": 3, "case_J_K": 400, "ambient_C": 23}
J
set -- "$@" protocol=protocol.json protocol=ramps.json calibration=calibration.json actuator=actuator.json

# ---- the instrument, where its firmware is ----
if "$PALPATE" rig --firmware host --until-s 0.01 >/dev/null 2>&1; then
    rig="--port rig --firmware host --out runs --json"
    expect 0 acquire $rig --air-s 0.2 --after-s 0.2 --static --depth-mm 2 --rate-mm-s 1 --specimen-name a && mv out acquire.json
    expect 0 acquire $rig --protocol protocol.json --calibration calibration.json --actuator actuator.json
    mv out acquire_all.json
    "$PALPATE" acquire --port rig:guess.json --firmware host --out until --ramp-hold 3 --hold-s 2 --air-s 0.2 --after-s 0.2 --json \
        --until-explained guess.json --every 20 >until.json 2>err # whatever it finds
    set -- "$@" acquire=acquire.json acquire=acquire_all.json acquire=until.json
    for run in runs/*.csv; do set -- "$@" experiment=$run; done
    expect 0 calibrate-device set calibration_day=20000 compliance_m_N=1e-6 noise_N=0.002 sensitivity_sd=1e-3 --port rig --firmware host \
        --store flash.bin --yes --json && mv out machine.json
    expect 0 acquire --port rig --firmware host --store flash.bin --out kept --air-s 0.2 --after-s 0.2 --static --depth-mm 1 --rate-mm-s 1
    expect 0 calibrate-device air --port rig --firmware host --specimen none --yes --json && mv out air.json
    set -- "$@" calibrate_device=air.json machine=machine.json experiment=kept/static_1mm.csv
    "$PALPATE" rig --firmware host >port 2>rig.err &
    rig=$!
    await test -s port
    for action in info status gains home tare clear-fault; do
        expect 0 firmware $action --port "$(cat port)" --json && mv out firmware_$action.json
        set -- "$@" firmware=firmware_$action.json
    done
    kill $rig
fi

# ---- manifests of both forms ----
echo '{"palpate": {"batch": 1}, "about": "a test", "jobs": [{"name": "a", "arguments": ["--version"]}]}' >jobs.json
echo '{"palpate": {"batch": 1}, "command": ["characterize", "{input}"], "inputs": "run_*.csv", "name": "{index}"}' >each.json
echo '{"palpate": {"batch": 1}, "command": ["help", "{input}"], "inputs": ["simulate", "report"]}' >texts.json
expect 0 batch jobs.json --out batch
expect 0 batch texts.json --out batch
set -- "$@" batch=jobs.json batch=each.json batch=texts.json

# ---- export ----
for to in abaqus mujoco newton; do
    expect 0 export "$DATA/lumped_n1.json" --to $to --depth-mm 3 --nodes 3 --out scene --json && mv out export_$to.json
    set -- "$@" export=export_$to.json
done
# ---- other programs' forces, and what they miss ----
mkdir -p simulated measured
awk -v out=simulated/r -f "$ROOT/data/simulated/runs.awk" "$ROOT/data/simulated/calculix.csv"
awk -v out=measured/r -v noise=0.004 -v seed=1 -f "$ROOT/data/simulated/runs.awk" "$ROOT/data/simulated/calculix.csv"
expect 0 explain --simulated simulated/r2.csv simulated/r4.csv measured/r2.csv measured/r4.csv --max-effects 0 --json && mv out simulated.json
mkdir -p set/predictions/other/all
cp measured/r2.csv measured/r4.csv set && cp set/r2.csv set/predictions/other/all
cat >set/benchmark.json <<'J'
{"palpate": {"benchmark": 1}, "about": "all", "palpate_with": [{"name": "palpate", "arguments": ["--arms", "0"]}], "programs": ["other", "none"],
 "splits": [{"name": "all", "about": "a", "leaves_out": "speeds", "fit": ["r4.csv"], "predict": ["r2.csv"], "deeper_than_mm": 1, "later_than_s": 1}]}
J
expect 0 benchmark set --json && mv out benchmark.json
set -- "$@" explain=simulated.json benchmark=set/benchmark.json benchmark="$ROOT/data/benchmark/benchmark.json" benchmark_result=benchmark.json

# ---- what comes with palpate, and what import makes ----
for f in "$ROOT"/data/protocols/*.json; do set -- "$@" protocol=$f; done
for f in "$ROOT"/data/sedef2008/*.json "$ROOT"/data/models/*.json "$ROOT"/data/rig/phantom_lag.json; do set -- "$@" model=$f; done
expect 0 import "$ROOT"/data/measured/ecoflex/EF10_0T_A2.csv --out imported --license MIT
expect 0 import "$ROOT"/data/measured/mach1/hayes_0[0-2]*.csv --specimen-height-mm 2 --out imported
for f in imported/*.csv; do set -- "$@" experiment=$f; done

"$python" -W ignore "$ROOT/tests/cli/json_check.py" "$S" "$@" >checked 2>wrong
code=$?
[ $code -eq 0 ] || fail "$(grep BAD checked | head -n 40) $(cat wrong)"
grep -vE '^calibrate (static|relaxation)[.]|^calibrate (static|relaxation|iterations)|^characterize law[.]|^explain next_experiment[.]runs..[.](hold_s|cycles)$|^experiment import.block$|^explain (scatter|law)' checked >unseen
[ -s unseen ] && fail "keys of the schemas that no file has: $(cat unseen)"
done_testing
