#!/bin/sh
# explain_study.sh OUT: the virtual indenter with one effect after another, recorded through its firmware by
# data/protocols/explain.json, fitted with the phantom's two arms, and explained: the table of data/rig/README.md.
# An hour on two cores. The same line again goes on where it was killed.
set -u
here=$(cd "$(dirname "$0")" && pwd)
palpate=$(realpath "${PALPATE:-$here/../../build/palpate}")
mkdir -p "${1:?a folder for recordings and results}"
cd "$1" || exit 1
cp "$here/../protocols/explain.json" protocol.json
cat >hidden <<'END'
lag sensor_lag "time_s": 0.02
frame frame_compliance "compliance_mm_N": 0.1
toe toe_region "length_mm": 0.3
adhesion adhesion "force_N": 0.1
beta strain_dependent_arm "stiffness_per_strain": 3, "time_per_strain": 1
damage damage_softening "softening": 0.3, "sharpness": 0.5
set permanent_set "fraction": 0.1
rate rate_stiffening "per_decade": 0.05
bias sensor_bias "force_N": 0.05
hum mains_hum "amplitude_N": 0.01, "frequency_Hz": 50
inertia plate_inertia "mass_kg": 0.2
saturation force_saturation "force_N": 2.8
ageing session_ageing "per_hour": 0.1
friction coulomb_friction "force_N": 0.04
drift sensor_drift "force_N_s": 0.0005
ripple drive_ripple "amplitude_N": 0.02, "period_mm": 1.5, "phase_rad": 0.5
poro poroelastic "stiffness_N": 2, "time_s": 60
power power_law_relaxation "stiffness_N": 1, "exponent": 0.2
END
while read -r name effect parameters; do
    sed 's/"id": "sensor_lag", "parameters": {[^}]*}/"id": "'"$effect"'", "parameters": {'"$parameters"'}/' "$here/phantom_lag.json" >"$name.json"
done <hidden
# A contact force above what the effect does in the air, and a rest until it has forgotten.
record='acquire --port rig:{input}.json --firmware host --protocol protocol.json --out {input} --force'
"$palpate" batch --out recorded --template "$record --contact-N 0.01 --rest-s 200" \
    lag frame toe adhesion beta damage set rate bias hum inertia saturation ageing
"$palpate" batch --out recorded --template "$record --contact-N 0.05 --rest-s 200" friction drift ripple
"$palpate" batch --out recorded --template "$record --contact-N 0.01 --rest-s 600" poro power
# shellcheck disable=SC2046
set -- $(cut -d' ' -f1 hidden)
"$palpate" batch --template 'characterize {input}/*.csv --arms 2 --degree 4 --out {input}.plain.json' "$@" --out characterized
"$palpate" batch --template "explain --model {input}.plain.json {input}/*.csv --result {input}.found.json \
    --report {input}.found.html --next {input}.next.json" "$@" --out explained
for name; do
    sed -n "s/^$name //p" hidden
    sed 's/^/  /' "explained/$name.out"
done
