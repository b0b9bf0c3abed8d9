#!/bin/sh
# simulate_effects.sh: models with effects, lumped and network, against closed forms of an elastic specimen. check: asan
. tests/cli/common

# model FILE EFFECTS: a lumped model of 12 N per unit strain, 24 mm high; network: four such elements.
model() {
    cat >"$1" <<J
{"palpate": {"model": 1}, "kind": "${KIND-lumped}", "specimen": {"height_mm": 24},
 "stiffness": {"kind": "polynomial", "coefficients_N": [12]},
 "effects": [$2]${MESH-}}
J
}
NET=', "mesh": {"kind": "lattice", "nodes": [2, 2, 2], "size_mm": [24, 24, 24], "neighbourhood": 6}'
effect() { printf '{"id": "%s", "parameters": {%s}}' "$1" "$2"; }

# check FILE FORMULA WHAT: force against a formula of t and d (mm), pressed force K d / 24.
check() {
    awk -F, "function press(d) { return d > 0 ? K * d / 24 : 0 }
        function sin2(x) { return sin(6.283185307179586 * x) }
        BEGIN { K = ${STIFF-12} }
        /^[-0-9]/ { t = \$1; d = \$2; want = $2; x = \$3 - want; if (x < 0) x = -x; if (x > worst) worst = x; n++ }
        END { if (n < 20 || worst > 1e-9) { print n \" rows, off by \" worst; exit 1 } }" "$1" || fail "$3"
}

model plain.json ""
model bias.json "$(effect sensor_bias '"force_N": -0.25'), $(effect sensor_gain '"gain": 0.1')"
expect 0 simulate bias.json --protocol ramp_hold --depth-mm 6 --hold-s 5 --out bias.csv
check bias.csv '1.1 * press(d) - 0.25' "bias and gain"
model frame.json "$(effect frame_compliance '"compliance_mm_N": 2')"
expect 0 simulate frame.json --protocol cyclic --depth-mm 6 --cycles 2 --out frame.csv
check frame.csv 'press(d) / 2' "frame compliance" # 12 N / 24 mm in series with 0.5 N/mm
model drift.json "$(effect sensor_drift '"force_N_s": 0.01'), $(effect drive_ripple '"amplitude_N": 0.03, "period_mm": 1.7, "phase_rad": 0')"
expect 0 simulate drift.json --protocol static --depth-mm 6 --sample-Hz 50 --air-s 2 --out drift.csv
check drift.csv 'press(d) + 0.01 * t + 0.03 * sin2(d / 1.7)' "drift and ripple, in air too"
awk -F, '/^[-0-9]/ { if ($2 < -0.199) air++; if ($1 + 0 != $1) exit 1 } END { exit !(air > 0) }' drift.csv || fail "no air"
model toe.json "$(effect toe_region '"length_mm": 0.5'), $(effect contact_offset '"offset_mm": 1')"
expect 0 simulate toe.json --protocol ramp_hold --depth-mm 6 --hold-s 1 --out toe.csv
check toe.csv 'd > 1 ? press(d - 1 - 0.5 * (1 - exp(-(d - 1) / 0.5))) : 0' "toe and offset"

# A recording is followed at its samples, through the air; session.start_s of its header ages the specimen.
cat >path.csv <<'J'
# palpate.experiment: 1
# session.start_s: 7200
time_s,depth_mm,force_N
J
awk 'BEGIN { for (i = 0; i <= 80; i++) printf "%g,%g,0\n", 3 + i * 0.1, (i <= 40 ? i : 80 - i) * 0.2 - 2 }' >>path.csv
model stick.json "$(effect adhesion '"force_N": 0.4'), $(effect session_ageing '"per_hour": 0.05')"
expect 0 simulate stick.json --like path.csv --out stick.csv
STIFF=13.2 check stick.csv 't > 7 && d < 0 ? (d > -0.7 ? K * d / 24 : 0) : press(d)' "adhesion and ageing"
[ "$(grep -c '^[0-9]' stick.csv)" -eq 81 ] || fail "--like: another number of rows"

# The recording of a model with effects, followed by it, is the recording.
model many.json "$(effect sensor_lag '"time_s": 0.3'), $(effect coulomb_friction '"force_N": 0.1'), $(effect plate_inertia '"mass_kg": 0.5')"
expect 0 simulate many.json --protocol cyclic --depth-mm 4 --sample-Hz 40 --air-s 1 --out many.csv
expect 0 simulate many.json --like many.csv --out again.csv
grep '^[0-9]' many.csv >a; grep '^[0-9]' again.csv >b
paste -d, a b | awk -F, '{ x = $3 - $6; if (x * x > 1e-22) { print; exit 1 } }' || fail "followed, it is another"

# A network of four elements side by side is four times the lumped model.
KIND=network MESH=$NET model net.json "$(effect frame_compliance '"compliance_mm_N": 0.5'), $(effect sensor_bias '"force_N": 0.2')"
expect 0 simulate net.json --protocol ramp_hold --depth-mm 6 --hold-s 1 --out net.csv
STIFF=48 check net.csv 'press(d) / 2 + 0.2' "network on a frame"
KIND=network MESH=', "mesh": {"kind": "lattice", "nodes": [2, 2, 2], "size_mm": [24, 24, 24]}' \
    model slip.json "$(effect plate_slip '"slip": 0.5')"
expect 0 simulate slip.json --nodes 3 --protocol static --depth-mm 2 --dt-ms 1000 --json --out slip.csv
grep -q '"kind": "network"' out || fail "--json of a network"

# Effects at zero strength, and none, are the same to the bit where the plate never leaves.
model off.json "$(effect relaxation_arm '"stiffness_N": 0, "time_s": 10'), $(effect frame_compliance '"compliance_mm_N": 0')"
expect 0 simulate off.json --protocol ramp_hold --depth-mm 6 --hold-s 5 --dt-ms 100 --out off.csv
expect 0 simulate plain.json --protocol ramp_hold --depth-mm 6 --hold-s 5 --dt-ms 100 --out plain.csv
grep -v '^#' off.csv >a; grep -v '^#' plain.csv >b
cmp -s a b || fail "off is not plain"

# What does not go.
expect 2 simulate bias.json --protocol creep --force-N 1; says "--protocol creep does not go with the effects of bias.json"
expect 2 simulate bias.json --protocol static --depth-mm 3 --relaxed; says "--relaxed does not go with the effects"
expect 2 simulate slip.json --protocol static --depth-mm 3 --vtu frames; says "--vtu does not go with the effects"
model slip.json "$(effect plate_slip '"slip": 0.5')"
expect 1 simulate slip.json --protocol static --depth-mm 2; says 'slip.json:3: effects[0].id "plate_slip" is not an effect of a lumped model'
model wrong.json "$(effect sensor_lag '"time_s": -1')"
expect 1 simulate wrong.json --protocol static --depth-mm 2; says "wrong.json:3: effects[0].parameters.time_s must be between 0 and 1e+09, not -1"
done_testing
