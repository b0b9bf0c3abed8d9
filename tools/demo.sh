#!/bin/sh
# demo.sh: what `make demo` runs: recordings become a lumped model with intervals, then a network, then a report.
# The recordings are made from the seed's Table 4.3 (ramp and hold) and Eq. 4.2 (static), with noise and free air.
set -eu
cd "$(dirname "$0")/.."
palpate=${PALPATE:-build/palpate}
out=build/demo
runs=$out/recordings
rm -rf "$out"
mkdir -p "$runs"

sensor="--sample-Hz 1000 --air-s 1 --noise-N 0.004"
echo "Recording a phantom (simulated: Sedef 2008, Tables 4.3 and 4.5)"
grep '^[0-9]' data/sedef2008/table_4_3.csv | while IFS=, read -r depth strain k_inf k1 b1 k2 b2; do
    printf '{"palpate": {"model": 1}, "kind": "lumped", "specimen": {"kind": "cylinder", "height_mm": 24, "radius_mm": 12},
 "stiffness": {"kind": "polynomial", "coefficients_N": [%s]}, "formulation": "history",
 "arms": [{"stiffness_N": %s, "viscosity_Ns": %s}, {"stiffness_N": %s, "viscosity_Ns": %s}]}' \
        "$k_inf" "$k1" "$b1" "$k2" "$b2" >"$runs/tissue"
    # shellcheck disable=SC2086
    "$palpate" simulate "$runs/tissue" --protocol ramp_hold --depth-mm "$depth" --ramp-s 1 --hold-s 100 $sensor \
        --seed "${depth%.*}${depth#*.}" --out "$runs/ramp_hold_${depth}mm.csv"
done
rm "$runs/tissue"
# shellcheck disable=SC2086
"$palpate" simulate data/sedef2008/lumped_n2.json --protocol static --depth-mm 9.7 --rate-mm-s 0.1 $sensor --seed 1 \
    --out "$runs/static.csv"

echo "Characterizing"
"$palpate" characterize "$runs"/*.csv --degree 3 --out "$out/lumped.json" --plot "$out" >"$out/characterize.txt" \
    2>"$out/findings.txt" || { cat "$out/findings.txt" >&2; exit 1; }
echo "Calibrating a network of 27 nodes"
"$palpate" calibrate "$out/lumped.json" --nodes 3 --law spline --strain-dependent --out "$out/network.json" --plot "$out" \
    >"$out/calibrate.txt"
for depth in 2 4 6; do
    "$palpate" simulate "$out/network.json" --protocol ramp_hold --depth-mm $depth --ramp-s 1 --hold-s 100 \
        --out "$out/simulated_${depth}mm.csv"
done
"$palpate" report "$runs" "$out" --title "Silicone phantom of Sedef (2008), simulated recordings" --out "$out/report.html"

key() { sed -n "s/^ *\"$1\": *\([-+.0-9eE]*\),\{0,1\}\$/\1/p" "$2"; }
echo
sed -n '/^Model/,$p' "$out/characterize.txt" | sed -n 's/^  arm \([0-9]*\):/  arm \1 of the phantom:/p'
awk -v a="$(key gap_before_percent "$out/characterize.json")" -v b="$(key gap_after_percent "$out/characterize.json")" \
    'BEGIN { printf "  K_inf, static against ramp and hold: %.1f %% apart as recorded, %.1f %% after the joint fit\n", a, b }'
key max_error_percent "$out/calibrate.json" | sort -g | tail -n 1 |
    awk '{ printf "  network against the lumped model: at most %.2f %% of the peak force\n", $1 }'
echo
echo "The report:  $out/report.html"
echo "The network: $out/network.json"
