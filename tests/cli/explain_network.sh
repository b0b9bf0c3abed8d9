#!/bin/sh
# explain_network.sh: a network model is explained as a lumped one is, and what comes out is a network that runs.
# check: all
. tests/cli/common

# model EFFECTS STIFFNESS [NODES] >FILE
model() {
    cat <<J
{"palpate": {"model": 1}, "kind": "network", "specimen": {"height_mm": 24},
 "stiffness": {"kind": "polynomial", "coefficients_N": [$2, 0.3, 2.4]},
 "arms": [{"stiffness_N": 0.08, "viscosity_Ns": 0.2}], "effects": [$1],
 "mesh": {"kind": "lattice", "nodes": [${3-3}, ${3-3}, ${3-3}], "size_mm": [24, 24, 24]}, "formulation": "history"}
J
}

# runs NAME: presses by NAME.json, the first again at the end
runs() {
    n=0
    for press in "4 1" "6 2" "8 0.5" "4 1"; do
        set -- "$1" $press
        n=$((n + 1))
        expect 0 simulate "$1.json" --protocol ramp_hold --depth-mm "$2" --ramp-s "$3" --hold-s 5 --sample-Hz 25 \
            --air-s 1 --noise-N 0.002 --seed $n --out "$1$n.csv"
    done
}
some="--candidates sensor_lag,sensor_bias,relaxation_arm,frame_compliance,plate_slip"

model '{"id": "sensor_lag", "parameters": {"time_s": 0.08}}' 0.49 >lag.json
model '{"id": "plate_slip", "parameters": {"slip": 0.9}}' 0.49 >slip.json
model '' 0.49 >true.json
model '' 0.53 >guess.json

runs true
expect 0 explain --model guess.json true?.csv $some --result true.out
grep -q '"verdict": "agrees"' true.out || fail "nothing hidden: $(cat out)"

runs lag
expect 0 explain --model guess.json lag?.csv $some --result lag.out --out lag_explained.json
grep -q '"verdict": "explained"' lag.out || fail "a hidden lag: $(cat out)"
near "the lag" "$(sed -n 's/.*"time_s": *\([0-9.]*\).*/\1/p' lag_explained.json)" 0.08 0.03
grep -q '"kind": "network"' lag_explained.json || fail "what comes out is no network"

# The explained network runs, and does what the one with the lag does.
for model in lag lag_explained; do
    expect 0 simulate $model.json --protocol ramp_hold --depth-mm 7 --ramp-s 0.7 --hold-s 5 --sample-Hz 50 \
        --out again_$model.csv --json
    value out peak_force_N >>peaks
done
near "its peak" "$(sed -n 2p peaks)" "$(sed -n 1p peaks)" 0.003

# Plates that slip are something that only a network can tell.
runs slip
expect 0 explain --model guess.json slip?.csv $some --good-enough 0 --result slip.out --out slip_explained.json
slip=$(sed -n 's/.*"slip": *\([0-9.]*\).*/\1/p' slip_explained.json)
near "the slip" "${slip:-none}" 0.9 0.1

# Two jobs say what one says.
expect 0 explain --model guess.json lag?.csv $some --jobs 2 --result jobs.out
for result in lag jobs; do grep -v '"command"' $result.out >$result.said; done
cmp lag.said jobs.said || fail "the number of jobs changes the answer"

# 125 nodes, and an effect of the material.
model '{"id": "strain_dependent_arm", "parameters": {"stiffness_per_strain": 3, "time_per_strain": 0}}' 0.49 5 >fine.json
model '' 0.53 5 >fine_guess.json
runs fine
expect 0 explain --model fine_guess.json fine?.csv --candidates sensor_lag,strain_dependent_arm --jobs 2 \
    --result fine.out --out fine_explained.json
grep -q '"verdict": "explained"' fine.out || fail "strain-dependent arms in 125 nodes: $(cat out)"
grep -q '"nodes": \[5, 5, 5\]' fine_explained.json || fail "what comes out has not 125 nodes"
near "beta in 125 nodes" "$(sed -n 's/.*"stiffness_per_strain": *\([0-9.]*\).*/\1/p' fine_explained.json)" 3 0.1

# A network is fitted without mass: a density is refused before anything is made of it.
sed 's/"formulation"/"density_kg_m3": 1000, "formulation"/' guess.json >heavy.json
expect 1 explain --model heavy.json true?.csv
says "has density_kg_m3, but networks are fitted without mass"

# A lumped model's effects and palpate calibrate: those of the instrument stay, those of the material are told.
cat >lumped.json <<J
{"palpate": {"model": 1}, "kind": "lumped", "specimen": {"height_mm": 24},
 "stiffness": {"kind": "polynomial", "coefficients_N": [8.2, 3.1]}, "arms": [{"stiffness_N": 1, "viscosity_Ns": 2}],
 "effects": [{"id": "sensor_lag", "parameters": {"time_s": 0.08}},
             {"id": "rate_stiffening", "parameters": {"per_decade": 0.1}}], "formulation": "history"}
J
expect 0 calibrate lumped.json --nodes 3 --stage static --depth-mm 4 --out network.json
says "its effect rate_stiffening is left out"
grep -q sensor_lag network.json || fail "the instrument's lag is lost"
grep -q rate_stiffening network.json && fail "a lumped effect became an element's"
done_testing
