#!/bin/sh
# network.sh DIR NODES [EFFECT]: recordings of a network with a hidden effect, and the network that misses it.
# A cube of 24 mm with NODES a side and two arms, of EFFECT as a model's file has it, is pressed five times (100
# samples a second, noise 2 mN): DIR/run_1.csv to run_5.csv. DIR/model.json has no effect and is 8 to 12 % off.
#     data/explain/network.sh lag 5 '{"id": "sensor_lag", "parameters": {"time_s": 0.06}}'
set -eu
palpate=${PALPATE:-$(dirname "$0")/../../build/palpate}
dir=${1:?a folder} nodes=${2:?nodes a side} effect=${3-}
mkdir -p "$dir"

# network FILE EFFECT LAW ARM_STIFFNESS ARM_VISCOSITY: the last three are factors; elements share the cross-section
network() {
    awk -v n="$nodes" -v effect="$2" -v law="$3" -v k="$4" -v b="$5" 'BEGIN {
        s = 4 / (n - 1) ^ 2
        printf "{\"palpate\": {\"model\": 1}, \"kind\": \"network\", \"specimen\": {\"height_mm\": 24},\n"
        printf " \"stiffness\": {\"kind\": \"polynomial\", \"coefficients_N\": [%g, %g, %g]},\n", .49 * law * s, .3 * law * s, 2.4 * law * s
        printf " \"arms\": [{\"stiffness_N\": %g, \"viscosity_Ns\": %g},\n", .08 * k * s, .2 * b * s
        printf "          {\"stiffness_N\": %g, \"viscosity_Ns\": %g}],\n \"effects\": [%s],\n", .06 * k * s, .9 * b * s, effect
        printf " \"mesh\": {\"kind\": \"lattice\", \"nodes\": [%d, %d, %d], \"size_mm\": [24, 24, 24]},\n", n, n, n
        printf " \"formulation\": \"history\"}\n" }' >"$1"
}
network "$dir/truth.json" "$effect" 1 1 1
network "$dir/model.json" "" 1.08 0.92 1.12

n=0
for press in "4 1" "6 2" "8 0.5" "5 3" "4 1"; do
    n=$((n + 1))
    set -- $press
    "$palpate" simulate "$dir/truth.json" --protocol ramp_hold --depth-mm "$1" --ramp-s "$2" --hold-s 15 --sample-Hz 100 \
        --air-s 1 --noise-N 0.002 --seed $n --out "$dir/run_$n.csv" >/dev/null
done
