#!/bin/sh
# demo.sh: what `make demo` runs: the indenter's firmware presses a phantom; its recordings become a lumped model with
# intervals; what that model misses is found; the model with it becomes a network, and everything a report.
# FULL=1: all thirteen experiments of the thesis, 200 s each, instead of four.
# Motor, phantom and force sensor are simulated (palpate rig). The phantom has the material of Sedef 2008, Eq. 4.2 and
# Table 4.5; its force sensor is slow, which only data/rig/phantom_lag.json says.
set -eu
cd "$(dirname "$0")/.."
palpate=${PALPATE:-build/palpate}
phantom=data/rig/phantom_lag.json
out=build/demo
runs=$out/recordings
rm -rf "$out"
mkdir -p "$runs" "$out/first"

begin=$(date +%s)
say() { printf '%4d s  %s\n' $(($(date +%s) - begin)) "$1"; }
# into LOG COMMAND...: what it prints goes to $out/LOG, and is shown only if it fails.
into() {
    log=$out/$1; shift
    "$@" >"$log" 2>&1 || { tail -n 20 "$log" >&2; echo "demo.sh: failed: $*" >&2; exit 1; }
}

# ---- one short press, for something to look at at once
into first.txt "$palpate" acquire --port rig:$phantom --firmware host --ramp-hold 6 --hold-s 10 --out "$out/first"
into first.txt "$palpate" report "$out/first" --title "A first press: 6 mm deep within 1 s, held for 10 s" --out "$out/first.html"
say "A first press. Look at $out/first.html in a browser: force over time, while the demo goes on."

# ---- the recordings
if "$palpate" rig --firmware qemu --until-s 0.001 >/dev/null 2>"$out/rig.txt"; then firmware=qemu; else firmware=host; fi
if [ -n "${FULL-}" ]; then
    firmware=host # as the board's image this would take an hour
    protocol=--thesis-protocol
else
    protocol="--protocol data/protocols/demo.json"
fi
"$palpate" rig --firmware $firmware --until-s 0.001 >/dev/null 2>"$out/rig.txt"
say "Recording four presses; the indenter's firmware runs as $(sed -n 's/^running //p' "$out/rig.txt")."
# Firmware and motor exchange messages each millisecond. On one core neither waits until another core wakes up.
one_core=
first=$(taskset -cp $$ 2>/dev/null | sed 's/.*: *//; s/[-,].*//')
[ -z "$first" ] || one_core="taskset -c $first"
# shellcheck disable=SC2086
{ $one_core "$palpate" acquire --port rig:$phantom --firmware $firmware $protocol --out "$runs" 2>&1 && echo done; } |
    tee "$out/acquire.txt" |
    while IFS= read -r line; do
        case $line in
        */air_*.csv:*) say "  the air above the phantom, for the sensor's zero" ;;
        *.csv:*) line=${line##*/} && say "  ${line%%,*}, $(echo "$line" | sed 's/[^,]*, \(.*\) mm, \(.*\) N, .*/\1 mm deep, \2 N at most/')" ;;
        esac
    done
[ "$(tail -n 1 "$out/acquire.txt")" = done ] || { cat "$out/acquire.txt" >&2; exit 1; }

# ---- the models
say "Fitting a lumped model: a spring beside arms (springs with dashpots) whose force fades with time."
into characterize.txt "$palpate" characterize "$runs"/*.csv --degree 4 --out "$out/lumped.json" --result "$out/characterize.json"
say "Looking for what that model misses."
into explain.txt "$palpate" explain --model "$out/lumped.json" "$runs"/*.csv --every 25 --jobs 2 \
    --out "$out/lumped_explained.json" --result "$out/explain.json" --report "$out/explain.html"
say "Finding the material of a network of 27 particles that behaves as that model."
into calibrate.txt "$palpate" calibrate "$out/lumped_explained.json" --nodes 3 --law spline --strain-dependent \
    --out "$out/network.json" --result "$out/calibrate.json"
say "Pressing the network as the phantom was pressed, and writing the report."
presses=
for depth in 2 4.5 7; do # at once; the network has the effects too: it predicts what this indenter records
    into simulate_$depth.txt "$palpate" simulate "$out/network.json" --like "$runs/ramp_hold_${depth}mm.csv" --out "$out/simulated_${depth}mm.csv" &
    presses="$presses $!"
done
for press in $presses; do wait "$press"; done
into report.txt "$palpate" report "$runs" "$out" --title "Silicone phantom of Sedef (2008), pressed by the virtual indenter" \
    --out "$out/report.html"

# ---- what came out
key() { sed -n "s/^ *\"$1\": *\([-+.0-9eE]*\),\{0,1\}\$/\1/p" "$2"; }
arms() { sed '/"effects"/,$d' "$1" | tr -d '\n ' | grep -o '{"stiffness_N":[^}]*' | sed 's/[^:]*:\([^,]*\),[^:]*:\(.*\)/\1 \2/'; }
lag() { sed -n 's/.*"sensor_lag".*"time_s": *\([-+.0-9eE]*\).*/\1/p' "$1"; }
# law MODEL: the largest difference of its spring from the phantom's, in %, for strains of 0.05 to 0.3; a spline's is
# straight between two of its knots, to one part in 1000
law() {
    for model in $phantom "$1"; do
        { tr -d '\n ' <"$model" && echo; } | sed 's/"arms".*//' | sed -n 's/.*"coefficients_N":\[\([^]]*\)\].*/\1/p; s/.*"strain":\[\([^]]*\)\],"stiffness_N":\[\([^]]*\)\].*/\1;\2/p'
    done | awk '
        { two = split($0, half, ";") == 2; n[NR] = split(half[1], c, ","); split(half[2], v, ",")
          for (i = 1; i <= n[NR]; i++) { at[NR, i] = c[i]; is[NR, i] = v[i] } spline[NR] = two }
        function k(m, e,   i, sum) {
            if (spline[m]) {
                for (i = 2; i < n[m] && at[m, i] < e; i++) { }
                return is[m, i - 1] + (is[m, i] - is[m, i - 1]) * (e - at[m, i - 1]) / (at[m, i] - at[m, i - 1])
            }
            for (i = n[m]; i > 0; i--) sum = sum * e + at[m, i]
            return sum
        }
        END { for (e = 0.05; e < 0.301; e += 0.01) { d = 100 * (k(2, e) / k(1, e) - 1); d = d < 0 ? -d : d; if (d > most) most = d }
              printf "%.1f\n", most }'
}
found=$(lag "$out/lumped_explained.json")
say "Done."
echo
echo "The simulated force sensor answers $(lag $phantom) s late. palpate was not told. What it made of the recordings:"
echo
printf '  %-24s %12s   %-22s %s\n' "" "the truth" "fitted as recorded" "after palpate explain"
printf '  %-24s %12s   %-22s %s\n' "delay of the sensor" "$(lag $phantom) s" "not known of" \
    "$(awk -v t="$found" 'BEGIN { if (t == "") print "not found"; else printf "%.4g s", t }')"
{ arms $phantom; arms "$out/lumped.json"; arms "$out/lumped_explained.json"; } | awk '
    { k[NR] = $1; b[NR] = $2 }
    function of(x, truth, unit) { return sprintf("%.4g %s (%+.1f %%)", x, unit, 100 * (x / truth - 1)) }
    END {
        n = NR / 3; split("fast slow", name, " ")
        for (i = 1; i <= n; i++) {
            printf "  %-24s %12s   %-22s %s\n", name[i] " arm, spring", sprintf("%.4g N", k[i]), of(k[n + i], k[i], "N"), of(k[2 * n + i], k[i], "N")
            printf "  %-24s %12s   %-22s %s\n", name[i] " arm, dashpot", sprintf("%.4g N s", b[i]), of(b[n + i], b[i], "N s"), of(b[2 * n + i], b[i], "N s")
        }
    }'
printf '  %-24s %12s   %-22s %s\n' "lasting spring, K(e)" "" "within $(law "$out/lumped.json") %" "within $(law "$out/lumped_explained.json") %"
echo
key max_error_percent "$out/calibrate.json" | sort -g | tail -n 1 |
    awk '{ printf "The network gives the force of the explained model within %.2f %% of its peak, at all depths and times.\n", $1 }'
echo
echo "Look at"
echo "  $out/report.html    recordings, fits, what was missing, network: everything on one page"
echo "  $out/explain.html   only what was missing, and how it was found"
echo "  $out/network.json   the network: press it with  $palpate simulate --help"
