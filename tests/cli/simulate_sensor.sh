#!/bin/sh
# simulate_sensor.sh: recordings as a tester makes them, against the closed form of two arms (Eq. 4.7). check: asan
. tests/cli/common

# What is left of a recording after the closed form of table 4.3's 6 mm row; e = depth / 24 mm.
cat >model.json <<'J'
{"palpate": {"model": 1}, "kind": "lumped", "specimen": {"height_mm": 24},
 "stiffness": {"kind": "polynomial", "coefficients_N": [9.1376]},
 "arms": [{"stiffness_N": 2.5257, "viscosity_Ns": 3.6713}, {"stiffness_N": 0.7127, "viscosity_Ns": 26.714}],
 "formulation": "history"}
J
left='
function arm(t, K, b,   tau) {
    tau = b / K
    return t <= 0 ? 0 : t <= 1 ? 0.25 * b * (1 - exp(-t / tau)) : 0.25 * b * (exp(-(t - 1) / tau) - exp(-t / tau))
}
BEGIN { FS = ","; pi = atan2(0, -1) }
/^[0-9]/ {
    t = $1 - 0.5; e = t <= 0 ? 0 : t <= 1 ? 0.25 * t : 0.25
    depth = t <= 1 ? 6 * t : 6
    if (($2 - depth) ^ 2 > 1e-20) { print "depth " $2 " at " $1 " s"; bad = 1; exit 1 }
    x = $3 - 9.1376 * e - arm(t, 2.5257, 3.6713) - arm(t, 0.7127, 26.714)
    at[n] = $1; left[n++] = x
}
'
press() { expect 0 simulate model.json --protocol ramp_hold --depth-mm 6 --hold-s 20 --air-s 0.5 "$@"; }

# No noise: exact at every sample, with samples that miss the corners of the ramp too (at 0.5 and 1.5 s).
for hz in 100 7; do
    press --sample-Hz $hz --out exact.csv
    awk -v hz=$hz "$left"'END { if (bad) exit 1
        for (i = 0; i < n; i++) { if (left[i] ^ 2 > 1e-22 || (at[i] - i / hz) ^ 2 > 1e-24) { print at[i], left[i]; exit 1 } }
        if (n != int(21.5 * hz + 1e-9) + 1) { print n " samples"; exit 1 } }' exact.csv || fail "at $hz Hz"
done

# Noise: 21501 samples. Mean within 4 sd / sqrt(n), sd within 4 / sqrt(2 n) of itself, neighbours uncorrelated within
# 4 / sqrt(n), kurtosis 3 within 4 sqrt(24 / n).
press --sample-Hz 1000 --noise-N 0.004 --seed 7 --out noise.csv
awk "$left"'END { if (bad) exit 1
    for (i = 0; i < n; i++) { m += left[i] / n; v += left[i] ^ 2 / n; q += left[i] ^ 4 / n; if (i) c += left[i] * left[i - 1] / n }
    sd = sqrt(v)
    if (m ^ 2 > 16 * 1.6e-5 / n || (sd / 0.004 - 1) ^ 2 > 8 / n || (c / v) ^ 2 > 16 / n || (q / v / v - 3) ^ 2 > 384 / n) {
        print n, m, sd, c / v, q / v / v; exit 1 } }' noise.csv || fail "noise"
press --sample-Hz 1000 --noise-N 0.004 --seed 7 --out again.csv
cmp -s noise.csv again.csv || fail "the same seed gives another run"
press --sample-Hz 1000 --noise-N 0.004 --out other.csv
cmp -s noise.csv other.csv && fail "another seed gives the same run"
for line in 'protocol.air_s: 0.5' 'sensor.sample_Hz: 1000' 'sensor.noise_N: 0.004' 'sensor.seed: 7'; do
    grep -q "^# $line" noise.csv || fail "the header lacks $line"
done

# Disturbances, each against what it says.
press --sample-Hz 1000 --hum-N 0.01 --out hum.csv
awk "$left"'END { for (i = 0; i < n; i++) if ((left[i] - 0.01 * sin(100 * pi * at[i])) ^ 2 > 1e-20) exit 1 }' hum.csv ||
    fail "hum"
press --sample-Hz 100 --spike 3,0.5,7.004,-0.2 --out spike.csv
awk "$left"'END { for (i = 0; i < n; i++) { want = i == 300 ? 0.5 : i == 700 ? -0.2 : 0; if ((left[i] - want) ^ 2 > 1e-20) exit 1 } }' \
    spike.csv || fail "spike"
press --sample-Hz 100 --clip-N 2.5 --out clip.csv
awk -F, '/^[0-9]/ { if ($3 > m) m = $3; n += $3 == 2.5 } END { exit !(m == 2.5 && n > 10) }' clip.csv || fail "clip"
press --sample-Hz 100 --drop 4,5,9.995,10.025 --out drop.csv
awk "$left"'END { if (n != 2151 - 100 - 3) exit 1
    for (i = 0; i < n; i++) if (left[i] ^ 2 > 1e-22 || (at[i] >= 4 && at[i] < 5)) exit 1 }' drop.csv || fail "drop"

# A network sampled evenly is the network at those times; a static run's air comes at its rate.
expect 0 simulate $DATA/network_27.json --protocol static --depth-mm 2 --rate-mm-s 1 --tolerance 1e-6 --sample-Hz 8 --air-s 0.25 \
    --out network.csv
expect 0 simulate $DATA/network_27.json --protocol static --depth-mm 2 --rate-mm-s 1 --relaxed --json
near "network: last force" "$(awk -F, 'END { print $3 }' network.csv)" "$(value out final_force_N)" 1e-6
awk -F, '/^[0-9]/ { d = $2 - ($1 - 0.25); if (d * d > 1e-20 || ($1 <= 0.25 && $3 != 0) || ($1 > 0.25 && $3 <= 0)) exit 1; n++ }
    END { exit n != 19 }' network.csv || fail "network: samples"
expect 0 simulate model.json --protocol creep --force-N 1 --hold-s 5 --sample-Hz 10 --out creep.csv
[ "$(grep -c '^[0-9]' creep.csv)" -eq 61 ] || fail "creep: not 61 samples"

wrong() { # text that the line must hold, arguments...
    text=$1; shift
    expect 2 simulate model.json "$@"
    says "$text"
}
wrong "--air-s needs --sample-Hz" --protocol static --depth-mm 3 --air-s 1
wrong "--air-s does not go with --protocol creep" --protocol creep --force-N 1 --air-s 1 --sample-Hz 10
wrong "--sample-Hz does not go with --like" --like noise.csv --sample-Hz 10
wrong "--sample-Hz does not go with --dt-ms" --protocol static --depth-mm 3 --dt-ms 1 --sample-Hz 10
wrong "--seed needs --noise-N" --protocol static --depth-mm 3 --seed 3
wrong "--drop must be pairs" --protocol static --depth-mm 3 --drop 3
wrong "--drop must be pairs" --protocol static --depth-mm 3 --drop 3,2
wrong "--spike must be pairs" --protocol static --depth-mm 3 --spike 3,2,1
wrong "lower --sample-Hz" --protocol static --depth-mm 3 --sample-Hz 1e9
wrong "leaves no sample" --protocol static --depth-mm 3 --sample-Hz 10 --drop 0,1e9

# The 12 recordings and the static one of the thesis, shortened.
if command -v python3 >/dev/null; then
    PALPATE=$PALPATE python3 "$DATA/recordings.py" made --all --sample-Hz 10 --hold-s 2 >out || fail "recordings.py"
    [ "$(wc -l <out)" -eq 13 ] && [ "$(ls made | wc -l)" -eq 13 ] || fail "recordings.py: not 13 recordings"
    near "static: last depth" "$(awk -F, 'END { print $2 }' made/static_9.7mm.csv)" 9.7 1e-9
fi
done_testing
