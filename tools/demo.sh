#!/bin/sh
# demo.sh: what `make demo` runs: the indenter's firmware presses a phantom; its recordings become a lumped model with
# intervals; what that model misses is found; the model without it becomes a network, and everything a report.
# FULL=1: all thirteen experiments of the seed, 200 s each, instead of four.
# Phantom, motor and force sensor are simulated (palpate rig): the material of Sedef 2008, Eq. 4.2 and Table 4.5, behind a
# force sensor that is slow, which nothing but data/rig/phantom_lag.json tells.
set -eu
cd "$(dirname "$0")/.."
palpate=${PALPATE:-build/palpate}
phantom=data/rig/phantom_lag.json
out=build/demo
runs=$out/recordings
rm -rf "$out"
mkdir -p "$runs"

if "$palpate" rig --firmware qemu --until-s 0.001 >/dev/null 2>"$out/rig.txt"; then firmware=qemu; else firmware=host; fi
if [ -n "${FULL-}" ]; then
    firmware=host # as the board's image this would take an hour
    protocol=--seed-protocol
else
    protocol="--protocol data/protocols/demo.json"
fi
"$palpate" rig --firmware $firmware --until-s 0.001 2>"$out/rig.txt" >/dev/null
echo "Acquiring from the indenter: its firmware as $(sed -n 's/^running //p' "$out/rig.txt")"
# shellcheck disable=SC2086
"$palpate" acquire --port rig:$phantom --firmware $firmware $protocol --out "$runs" 2>"$out/acquire.txt" ||
    { cat "$out/acquire.txt" >&2; exit 1; }
sed 's/^palpate acquire: /  /' "$out/acquire.txt"

echo "Characterizing"
"$palpate" characterize "$runs"/*.csv --degree 4 --out "$out/lumped.json" --plot "$out" >"$out/characterize.txt" \
    2>"$out/findings.txt" || { cat "$out/findings.txt" >&2; exit 1; }
echo "Explaining what the lumped model misses"
"$palpate" explain --model "$out/lumped.json" "$runs"/*.csv --every 25 --jobs 2 --out "$out/lumped_explained.json" \
    --plot "$out" --report "$out/explain.html" >"$out/explain.txt"
sed 's/^/  /' "$out/explain.txt"
echo "Calibrating a network of 27 nodes on the material"
"$palpate" calibrate "$out/lumped_explained.json" --nodes 3 --law spline --strain-dependent --out "$out/network.json" \
    --plot "$out" >"$out/calibrate.txt"
# The network has the effects too: it foretells what this indenter records.
for depth in 2 4.5 7; do
    "$palpate" simulate "$out/network.json" --like "$runs/ramp_hold_${depth}mm.csv" --out "$out/simulated_${depth}mm.csv"
done
"$palpate" report "$runs" "$out" --title "Silicone phantom of Sedef (2008), pressed by the virtual indenter" --out "$out/report.html"

key() { sed -n "s/^ *\"$1\": *\([-+.0-9eE]*\),\{0,1\}\$/\1/p" "$2"; }
list() { sed -n "s/.*\"$1\": *\[\([^]]*\)\].*/\1/p" "$2"; }
arms() { sed '/"effects"/,$d' "$1" | tr -d '\n ' | grep -o '"stiffness_N":[^}]*' | sed 's/[^:]*:\([^,]*\),[^:]*:\(.*\)/\1 \2/'; }
lag() { sed -n 's/.*"sensor_lag".*"time_s": *\([-+.0-9eE]*\).*/\1/p' "$1"; }

# against WHAT MODEL: how far a model's material is from the phantom's.
against() {
    list coefficients_N $phantom >"$out/true_law"
    list coefficients_N "$2" >"$out/law"
    awk -F, -v what="$1" 'FNR == 1 { file++ } { for (i = 1; i <= NF; i++) c[file, i - 1] = $i; n[file] = NF }
        function k(f, e,   i, y) { for (i = n[f] - 1; i >= 0; i--) y = y * e + c[f, i]; return y }
        END { for (e = 0.05; e < 0.301; e += 0.01) { d = 100 * (k(2, e) / k(1, e) - 1); d = d < 0 ? -d : d; if (d > most) most = d }
              printf "  %-17s K_inf of the phantom, strain 0.05 to 0.3: within %.2f %%\n", what, most }' "$out/true_law" "$out/law"
    arms $phantom >"$out/true_arms"
    arms "$2" | paste -d ' ' - "$out/true_arms" | awk -v what="$1" '{
        printf "  %-17s arm %d: %.4g N (%+.1f %%), %.4g N s (%+.1f %%)\n", what, NR, $1, 100 * ($1 / $3 - 1), $2, 100 * ($2 / $4 - 1) }'
    rm "$out/true_law" "$out/law" "$out/true_arms"
}
echo
against "As characterized:" "$out/lumped.json"
against "With the effect:" "$out/lumped_explained.json"
awk -v found="$(lag "$out/lumped_explained.json")" -v hidden="$(lag $phantom)" 'BEGIN {
    if (found == "") print "  hidden in the rig: a lag of the sensor of", hidden, "s: not found"
    else printf "  hidden in the rig: a lag of the sensor of %g s; explained: %.4g s (%+.1f %%)\n", hidden, found, 100 * (found / hidden - 1) }'
awk -v a="$(key gap_before_percent "$out/characterize.json")" -v b="$(key gap_after_percent "$out/characterize.json")" \
    'BEGIN { printf "  K_inf, static against ramp and hold: %.1f %% apart as recorded, %.1f %% after the joint fit\n", a, b }'
key max_error_percent "$out/calibrate.json" | sort -g | tail -n 1 |
    awk '{ printf "  network against the lumped model: at most %.2f %% of the peak force\n", $1 }'
echo
echo "The report:  $out/report.html"
echo "The network: $out/network.json"
