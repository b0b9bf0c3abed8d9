#!/bin/sh
# rig_effects.sh: models with effects in the virtual indenter, acquired through the firmware: simulate says the same.
. tests/cli/common

"$PALPATE" rig --until-s 0.1 --firmware host >/dev/null 2>err || { cat err; echo "there is no host firmware"; exit 77; }

# model FILE EFFECTS: the seed's phantom with them.
model() {
    cat >"$1" <<J
{"palpate": {"model": 1}, "kind": "lumped", "specimen": {"kind": "cylinder", "height_mm": 24, "radius_mm": 12},
 "stiffness": {"kind": "polynomial", "coefficients_N": [8.18, -0.70, 47.47, -131.36, 146.89]},
 "arms": [{"stiffness_N": 2.5847711, "viscosity_Ns": 3.6146}, {"stiffness_N": 0.6853036, "viscosity_Ns": 23.964533}],
 "effects": [$2]}
J
}

# rms MODEL RUN: of what it simulates for the depths of a run from the run's force, N, and the height, um, by which contact is another,
# which is found anew in each session and taken off by the slope of force over depth: where the plate moves by more than a count and a half
# a sample: slower, the encoder does not tell the direction that friction has.
rms() {
    expect 0 simulate "$1" --like "$2" --out like.csv
    grep '^[-0-9]' "$2" >run; grep '^[-0-9]' like.csv >like
    paste -d , run like | awk -F, '{ d[NR] = $2; f[NR] = $6; z = NR - 10; v = d[NR] - d[z]
        if (NR > 10 && (v > 0.015 || v < -0.015)) { x = $3 - $6; g = (f[NR] - f[z]) / v; s += x * x; p += x * g; q += g * g; n++ } }
        END { if (n < 300) exit 1; if (q > 0) s -= p * p / q; print sqrt(s / n), (q > 0 ? 1e3 * p / q : 0) }' || fail "$1: it did not move"
}

# tells WHAT MOST EFFECT arguments of acquire...: what is left is the rig's noise of 2 mN. A sample of it is as much as 4 um of the
# phantom: contact is not 20 um off. Without the effect it is another curve.
model plain.json ""
tells() {
    what=$1 most=$2; shift 2
    model with.json "$1"; shift
    expect 0 acquire --port rig:with.json --firmware host --rest-s 2 --air-s 0.5 --after-s 0.2 --out runs --force "$@"
    for f in runs/*.csv; do
        off=$(rms with.json "$f") without=$(rms plain.json "$f")
        echo "$off $without" | awk -v most="$most" '{ exit !($1 > 0.0015 && $1 < most && $2 < 20 && $2 > -20 && $3 > 4 * $1) }' ||
            fail "$what: off by $off (N, um), without it by $without"
    done
    rm -rf runs
}
cycles="--cycles 2 --depth-mm 5 --rate-mm-s 8"
effect() { printf '{"id": "%s", "parameters": {%s}}' "$1" "$2"; }
tells "frame compliance" 0.003 "$(effect frame_compliance '"compliance_mm_N": 0.1')" $cycles
tells "relaxation arm" 0.003 "$(effect relaxation_arm '"stiffness_N": 2, "time_s": 0.3')" --ramp-hold 4 --hold-s 2
tells "damage" 0.003 "$(effect damage_softening '"softening": 0.3, "sharpness": 0.5')" $cycles
# Where the plate turns its friction does so, for some samples at another one than the encoder's.
tells "friction" 0.005 "$(effect coulomb_friction '"force_N": 0.04')" $cycles --contact-N 0.05
tells "several" 0.003 "$(effect adhesion '"force_N": 0.1'), $(effect permanent_set '"fraction": 0.2'),
    $(effect sensor_gain '"gain": 0.05')" $cycles

# ---- the frame of an option adds to the model's ----
model half.json "$(effect frame_compliance '"compliance_mm_N": 0.05')"
model whole.json "$(effect frame_compliance '"compliance_mm_N": 0.1')"
expect 0 acquire --port rig:half.json --firmware host --compliance-mm-N 0.05 $cycles --out frame
off=$(rms whole.json frame/cyclic_5mm.csv) half=$(rms half.json frame/cyclic_5mm.csv)
near "both frames, N" "${off% *}" 0.002 0 0.0008
awk -v x="${half% *}" 'BEGIN { exit !(x > 0.01) }' || fail "one frame is as good as both"

# ---- drift goes on from power-on, beside what the options make of the sensor; the tare takes off what was there ----
model idle.json "$(effect sensor_drift '"force_N_s": 0.002'), $(effect sensor_bias '"force_N": 0.2')"
expect 0 acquire --port rig:idle.json --firmware host --contact-mm 3 --static --depth-mm 2 --rate-mm-s 4 --after-s 20 \
    --noise-N 0 --bias-N 0.1 --out runs
awk -F, '/^[-0-9]/ { if (!n++) { t = $1; f = $3 } last = $1; at = $3 }
    END { x = (at - f) / (last - t); exit !(last - t > 20 && x > 0.0019 && x < 0.0021 && f > 0 && f < 0.05) }' \
    runs/static_2mm.csv || fail "the drift in air"
done_testing
