#!/bin/sh
# cycles.sh: a plate that goes back faster than the specimen recovers leaves it: simulate, a network, and cycles on the virtual indenter. check: once
. tests/cli/common

cat >solid.json <<'J'
{"palpate": {"model": 1}, "kind": "lumped", "specimen": {"height_mm": 24, "radius_mm": 12},
 "stiffness": {"kind": "polynomial", "coefficients_N": [8]},
 "arms": [{"stiffness_N": 6, "viscosity_Ns": 9}], "formulation": "history"}
J
# closed FILE MOST: the force of two cycles of 2 s down and 2 s back to 3 mm is that of the closed form: the arm's relaxation on the
# ramps, and a surface without force that recovers by a rate of K / ((K + K1) tau) from where the plate left it.
closed() {
    awk -F, -v most="$2" '
        function ramp(q, r, t) { return q * exp(-t / tau) + K1 * r * tau * (1 - exp(-t / tau)) }
        function back(t) { return K * r * (T - t) + ramp(top, -r, t) }
        function lag(t) { return e0 * exp(-K / (K + K1) / tau * (T + t - left)) - r * t }
        BEGIN { K = 8; K1 = 6; tau = 1.5; T = 2; r = 3 / 24 / T; top = ramp(0, r, T)
            a = 0; b = T
            while (b - a > 1e-12) { m = (a + b) / 2; if (back(m) > 0) a = m; else b = m }
            left = a; e0 = r * (T - left)
            a = 0; b = T
            while (b - a > 1e-12) { m = (a + b) / 2; if (lag(m) > 0) a = m; else b = m }
            met = a }
        /^[0-9]/ && $1 < 3 * T { t = $1
            f = t < T ? K * r * t + ramp(0, r, t) : t < T + left ? back(t - T) : t < 2 * T + met ? 0 : \
                K * r * (t - 2 * T) + ramp(-K * r * met, r, t - 2 * T - met)
            d = $3 - f; d = d < 0 ? -d : d; worst = d > worst ? d : worst; n++ }
        /^[0-9]/ && $3 < 0 { pulls++ }
        END { print n " rows, off by " worst " N, " pulls + 0 " below 0"; exit !(n > 100 && worst < most && !pulls) }' "$1"
}
expect 0 simulate solid.json --protocol cyclic --depth-mm 3 --rate-mm-s 1.5 --cycles 2 --out lumped.csv
closed lumped.csv 1e-4 || fail "simulate is not the closed form"
expect 0 simulate solid.json --protocol cyclic --depth-mm 3 --rate-mm-s 1.5 --cycles 2 --sample-Hz 100 --air-s 1 --out samples.csv
awk -F, 'BEGIN { OFS = "," } /^[0-9]/ { $1 -= 1 } { print }' samples.csv >later.csv
grep -v '^-' later.csv >pressed.csv
closed pressed.csv 1e-4 || fail "samples of the run are not the closed form"

# A network of one row of elements along the load pulls no more than that, and frames are of a network that stays on the plate.
expect 0 calibrate solid.json --nodes 3 --depth-mm 3 --hold-s 20 --steps 200 --out network.json
expect 0 simulate network.json --protocol cyclic --depth-mm 3 --rate-mm-s 1.5 --cycles 2 --out network.csv
awk -F, '/^[0-9]/ && $3 < -1e-6 { exit 1 }' network.csv || fail "the plate pulls at a network"
closed network.csv 0.05 || fail "the network is far from the solid it was calibrated to"
expect 0 simulate network.json --protocol cyclic --depth-mm 3 --rate-mm-s 1.5 --cycles 1 --vtu frames --out glued.csv
says 'with --vtu the plate stays bonded to the specimen'

# Cycles of the virtual indenter on the seed's phantom: nothing is left but noise, and the arms are the phantom's.
"$PALPATE" rig --until-s 0.1 --firmware host >/dev/null 2>err || { echo "there is no host firmware"; exit 77; }
expect 0 acquire --port rig --firmware host --cycles 6 --depth-mm 4 --rate-mm-s 2 --rest-s 0 --out runs
expect 0 characterize runs/cyclic_4mm.csv --arms 2 --degree 5 --json --out found.json
near "rms over noise" "$(value out rms_noise)" 1 0.05
estimate() { awk -v n="\"$1\"," '$2 == n { on = 1 } on && $1 == "\"value\":" { sub(",", "", $2); print $2; exit }' out; }
near K_1 "$(estimate K_1)" 2.5847711 0.02
near b_1 "$(estimate b_1)" 3.6146 0.03
expect 0 simulate found.json --like runs/cyclic_4mm.csv --out again.csv
grep '^[-0-9]' runs/cyclic_4mm.csv >run; grep '^[-0-9]' again.csv >like
paste -d , run like | awk -F, '$2 > 0 { d = $3 - $NF; s += d * d; n++ } END { exit !(n > 1000 && sqrt(s / n) < 0.003) }' ||
    fail "simulate of the model is not the run it was fitted to"
done_testing
