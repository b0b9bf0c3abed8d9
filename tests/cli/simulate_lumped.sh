#!/bin/sh
# simulate_lumped.sh: lumped runs against the closed forms of one arm (Eq. 4.7, 5.24, 3.22). check: asan
. tests/cli/common

L=$DATA/lumped_n1.json # K(e) of Eq. 4.3, one arm
closed_form='
function K(e) { return 8.18 + e * (-0.70 + e * (47.47 + e * (-131.36 + e * 146.89))) }
function arm(t, c, rate,   b, tau) { # of a ramp of c seconds
    b = 17.873062; tau = b / 1.2962987
    return t <= c ? rate * b * (1 - exp(-t / tau)) : rate * b * (exp(-(t - c) / tau) - exp(-t / tau))
}
BEGIN { FS = "," }
/^[0-9]/ {
    e = $2 / 24; wanted = K(e) * e + (relaxed ? 0 : arm($1, ramp, depth / 24 / ramp))
    miss = $3 - wanted; if (miss < 0) miss = -miss
    if (miss > worst) worst = miss
    rows++; last = $1
}
END { if (rows < 100 || worst > 1e-10 || last < until - 1e-9) { print rows " rows to " last " s, off by " worst " N"; exit 1 } }'

expect 0 simulate $L --protocol ramp_hold --depth-mm 6 --ramp-s 1 --hold-s 50 --out ramp.csv
[ -s out ] && fail "wrote to stdout in spite of --out"
[ -s err ] && fail "wrote to stderr: $(cat err)"
awk -v ramp=1 -v depth=6 -v until=51 "$closed_form" ramp.csv || fail "ramp and hold"
expect 0 simulate $L --protocol ramp_hold --depth-mm 6 --ramp-s 1 --hold-s 50
cmp -s out ramp.csv || fail "standard output differs from --out"
expect 0 simulate $L --protocol ramp_hold --depth-mm 6 --rate-mm-s 3 --hold-s 0 --dt-ms 10 --out ramp2.csv
awk -v ramp=2 -v depth=6 -v until=2 "$closed_form" ramp2.csv || fail "ramp by its rate"
[ "$(grep -c '^[0-9]' ramp2.csv)" -eq 201 ] || fail "--dt-ms 10 over 2 s: not 201 rows"
expect 0 simulate $L --protocol static --depth-mm 9.7 --relaxed --out static.csv
awk -v ramp=1 -v relaxed=1 -v until=97 "$closed_form" static.csv || fail "relaxed"
expect 0 simulate $L --protocol static --depth-mm 9.7 --rate-mm-s 0.1 --out rate.csv
awk -v ramp=97 -v depth=9.7 -v until=97 "$closed_form" rate.csv || fail "static at a rate"

grep -q '^# palpate.experiment: 1$' ramp.csv || fail "header: palpate.experiment"
for line in 'protocol.kind: "ramp_hold"' 'protocol.depth_mm: 6' 'protocol.ramp_s: 1' 'protocol.hold_s: 50' \
    'specimen.kind: "cylinder"' 'specimen.height_mm: 24' 'specimen.radius_mm: 12' 'model.file: ' 'palpate.version: "'; do
    grep -q "^# $line" ramp.csv || fail "the header lacks $line"
done

# The run's own depth gives the run again, at its samples.
expect 0 simulate $L --like ramp.csv --out like.csv
grep '^[0-9]' ramp.csv >a; grep '^[0-9]' like.csv >b
[ "$(wc -l <a)" -eq "$(wc -l <b)" ] || fail "--like: another number of rows"
paste -d, a b | awk -F, '{ d = $3 - $6; if (d < 0) d = -d; t = $1 - $4; if (t < 0) t = -t
    if (d > 1e-9 || t > 1e-9) { print; exit 1 } }' || fail "--like differs from the run it follows"

# Noise of the recorded depth is no motion of the plate: the replay leaves the residual that the fit left.
expect 0 simulate $L --protocol ramp_hold --depth-mm 5 --ramp-s 5 --hold-s 20 --dt-ms 20 --out exact.csv
awk -F, 'BEGIN { srand(3) } function normal() { return sqrt(-2 * log(1 - rand())) * cos(6.2831853 * rand()) }
    /^[0-9]/ { printf "%s,%.6f,%.7f\n", $1, $2 + 0.012 * normal(), $3 + 0.002 * normal(); next } { print }' exact.csv >tracked.csv
expect 0 characterize tracked.csv --contact-mm 0 --out fitted.json --json
left=$(value out rms_N)
expect 0 simulate fitted.json --like tracked.csv --out replay.csv
grep '^[0-9]' tracked.csv >a; grep '^[0-9]' replay.csv >b
near "residual of the replay" "$(paste -d, a b | awk -F, '{ s += ($3 - $6) ^ 2 } END { print sqrt(s / NR) }')" "$left" 0.05

# Creep of a linear solid under a step (a very short ramp): e(t) = F/K (1 - K1/(K+K1) exp(-t/T)), T = b (K+K1)/(K K1).
cat >linear.json <<'J'
{"palpate": {"model": 1}, "kind": "lumped", "specimen": {"height_mm": 20},
 "stiffness": {"kind": "polynomial", "coefficients_N": [8]},
 "arms": [{"stiffness_N": 4, "viscosity_Ns": 12}], "formulation": "history"}
J
expect 0 simulate linear.json --protocol creep --force-N 1 --ramp-s 1e-6 --hold-s 30 --tolerance 1e-5 --out creep.csv
awk -F, '/^[0-9]/ && $1 > 1e-3 { wanted = 20 / 8 * (1 - 4 / 12 * exp(-$1 / 4.5)); d = $2 / wanted - 1
    if (d < 0) d = -d; if (d > worst) worst = d; n++ }
    END { if (n < 50 || worst > 2e-5) { print n " rows, off by " worst; exit 1 } }' creep.csv || fail "creep"
expect 3 simulate linear.json --protocol creep --force-N 100; says "lower --force-N"

expect 0 simulate $L --protocol cyclic --depth-mm 3 --cycles 2 --json
[ -s err ] && fail "wrote to stderr: $(cat err)"
[ "$(value out duration_s)" = 12.0 ] || fail "cyclic: duration $(value out duration_s)"
near "cyclic: final depth" "$(value out final_depth_mm)" 0 0 1e-9
grep -q '"kind": "lumped"' out || fail "--json lacks kind"
grep -q '"buckling": null' out || fail "--json lacks buckling"
done_testing
