#!/bin/sh
# range.sh: a model holds to the strain it was measured to; beyond it the force goes on rising, and the commands say so. check: asan
. tests/cli/common

cat >lumped.json <<'J'
{"palpate": {"model": 1}, "kind": "lumped", "specimen": {"height_mm": 24, "radius_mm": 12},
 "stiffness": {"kind": "polynomial", "coefficients_N": [8.18, 0, 0, -100], "strain_max": 0.2},
 "arms": [{"stiffness_N": 2, "viscosity_Ns": 3}], "formulation": "history"}
J
# Its K(e) is 0 at 0.434: 18 of 24 mm gave a force below zero. F(0.2) + F'(0.2) (0.75 - 0.2) by hand.
expect 0 simulate lumped.json --protocol static --relaxed --depth-mm 18 --json
says 'beyond the measured strain of 0.2 from t = '
near "force at 18 mm, relaxed" "$(value out final_force_N)" 4.215 1e-9
near "told from" "$(value out from_s)" 48 0.05
expect 0 simulate lumped.json --protocol ramp_hold --depth-mm 18 --hold-s 20 --out deep.csv
says 'beyond the measured strain of 0.2 from t = 0.2'
awk -F, '/^[0-9]/ { if ($3 < 0) bad = 1; n++ } END { exit bad || n < 50 }' deep.csv || fail "a force below zero"
expect 0 simulate lumped.json --protocol ramp_hold --depth-mm 4.8 --hold-s 20 --json
[ -s err ] && fail "a warning within the measured strain: $(cat err)"
grep -q '"beyond": null' out || fail "beyond is not null within the measured strain"
sed 's/, "strain_max": 0.2/, "strain_max": 0.3/' lumped.json >falls.json
expect 1 simulate falls.json --protocol static --depth-mm 3
says 'falls.json:2: stiffness.strain_max is 0.3, where the force no longer rises'

# Curves of the lumped model are taken as far as it was measured; the network's model says its own strain.
expect 0 calibrate lumped.json --nodes 3 --out network.json --json
[ -s err ] && fail "calibrate within the measured strain: $(cat err)"
near "depth of the static stage" "$(awk '/"static"/ { on = 1 } on && $1 == "\"depth_mm\":" { sub(",", "", $2); print $2; exit }' out)" 4.8 1e-9
near "strain of the network" "$(sed -n 's/.*"strain_max": \([0-9.]*\).*/\1/p' network.json)" 0.2 0.2
near "the same in the result" "$(value out strain_max)" "$(sed -n 's/.*"strain_max": \([0-9.]*\).*/\1/p' network.json)" 1e-12
expect 0 simulate network.json --protocol ramp_hold --depth-mm 10 --hold-s 5 --json
says 'beyond the measured strain of 0.2'
expect 0 simulate network.json --protocol ramp_hold --depth-mm 4 --hold-s 5 --json
[ -s err ] && fail "network within its strain: $(cat err)"
expect 0 calibrate lumped.json --nodes 3 --stage static --depth-mm 8 --json
says 'palpate calibrate: warning: beyond the measured strain of 0.2, to 0.3333'
expect 0 calibrate lumped.json --nodes 3 --stage relaxation --start network.json --depth-mm 7 --json
grep -qF 'beyond the measured strain of 0.2, to 0.2917' err || fail "deeper relaxation: $(cat err)"

# Shallow recordings whose fitted K(e) falls to zero soon after: a model all the same.
sed "s/-100/-130/" lumped.json >softens.json
for depth in 2.4 3.6 4.8; do
    expect 0 simulate softens.json --protocol ramp_hold --depth-mm $depth --hold-s 30 --sample-Hz 50 --air-s 1 --noise-N 0.002 --seed 3 --out h$depth.csv
done
expect 0 simulate softens.json --protocol static --depth-mm 4.8 --rate-mm-s 0.1 --sample-Hz 50 --air-s 1 --noise-N 0.002 --seed 4 --out s.csv
expect 0 characterize s.csv h2.4.csv h3.6.csv h4.8.csv --arms 1 --degree 5 --out fitted.json --json
near "measured strain" "$(sed -n 's/.*"strain_max": \([0-9.]*\).*/\1/p' fitted.json)" 0.2 0.02
expect 0 simulate fitted.json --protocol static --relaxed --depth-mm 20 --json
says 'beyond the measured strain of'
awk -v f="$(value out final_force_N)" 'BEGIN { exit !(f > 1) }' || fail "the continued force is $(value out final_force_N)"
done_testing
