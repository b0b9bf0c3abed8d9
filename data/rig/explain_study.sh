#!/bin/sh
# explain_study.sh OUT: the virtual indenter with one effect after another, recorded through its firmware by
# data/protocols/explain.json, fitted with the phantom's two arms, and explained: the table of data/rig/README.md.
# An hour on two cores. Recordings that are in OUT already are not made again.
set -eu
cd "$(dirname "$0")/../.."
palpate=${PALPATE:-build/palpate}
out=${1:?a folder for recordings and results}
mkdir -p "$out"

# name, contact force N (above what the effect does in the air), rest s (until it has forgotten), effect, parameters
sed 's/ *$//' <<'END' | while read -r name contact rest effect parameters; do
lag 0.01 200 sensor_lag "time_s": 0.02
frame 0.01 200 frame_compliance "compliance_mm_N": 0.1
friction 0.05 200 coulomb_friction "force_N": 0.04
toe 0.01 200 toe_region "length_mm": 0.3
adhesion 0.01 200 adhesion "force_N": 0.1
beta 0.01 200 strain_dependent_arm "stiffness_per_strain": 3, "time_per_strain": 1
damage 0.01 200 damage_softening "softening": 0.3, "sharpness": 0.5
set 0.01 200 permanent_set "fraction": 0.1
rate 0.01 200 rate_stiffening "per_decade": 0.05
poro 0.01 600 poroelastic "stiffness_N": 2, "time_s": 60
power 0.01 600 power_law_relaxation "stiffness_N": 1, "exponent": 0.2
bias 0.01 200 sensor_bias "force_N": 0.05
drift 0.05 200 sensor_drift "force_N_s": 0.0005
hum 0.01 200 mains_hum "amplitude_N": 0.01, "frequency_Hz": 50
ripple 0.05 200 drive_ripple "amplitude_N": 0.02, "period_mm": 1.5, "phase_rad": 0.5
inertia 0.01 200 plate_inertia "mass_kg": 0.2
saturation 0.01 200 force_saturation "force_N": 2.8
ageing 0.01 200 session_ageing "per_hour": 0.1
END
    sed 's/"id": "sensor_lag", "parameters": {[^}]*}/"id": "'"$effect"'", "parameters": {'"$parameters"'}/' \
        data/rig/phantom_lag.json >"$out/$name.json"
    if ! [ -d "$out/$name" ]; then
        "$palpate" acquire --port "rig:$out/$name.json" --firmware host --contact-N "$contact" --rest-s "$rest" \
            --protocol data/protocols/explain.json --out "$out/$name" 2>"$out/$name.txt" || tail -n 2 "$out/$name.txt"
    fi
    "$palpate" characterize "$out/$name"/*.csv --arms 2 --degree 4 --out "$out/$name.plain.json" >"$out/$name.txt" 2>&1
    echo "$effect $parameters"
    "$palpate" explain --model "$out/$name.plain.json" "$out/$name"/*.csv --jobs 2 --result "$out/$name.found.json" --report "$out/$name.found.html" \
        --next "$out/$name.next.json" 2>&1 | sed 's/^/  /'
done
