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
        expect 0 simulate "$1.json" --protocol ramp_hold --depth-mm "$2" --ramp-s "$3" --hold-s 10 --sample-Hz 25 \
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

expect 0 explain --model guess.json true?.csv $some --result true.out
grep -q '"verdict": "agrees"' true.out || fail "nothing hidden, by the likelihood: $(cat out)"
expect 0 explain --model guess.json lag?.csv $some --result lag.out --out lag_likely.json
grep -q '"verdict": "explained"' lag.out || fail "a hidden lag, by the likelihood: $(cat out)"
near "the lag by the likelihood" "$(sed -n 's/.*"time_s": *\([0-9.]*\).*/\1/p' lag_likely.json)" 0.08 0.03

# The explained network runs, and does what the one with the lag does.
for model in lag lag_explained lag_likely; do
    expect 0 simulate $model.json --protocol ramp_hold --depth-mm 7 --ramp-s 0.7 --hold-s 5 --sample-Hz 50 \
        --out again_$model.csv --json
    value out peak_force_N >>peaks
done
near "its peak" "$(sed -n 2p peaks)" "$(sed -n 1p peaks)" 0.003
near "its peak by the likelihood" "$(sed -n 3p peaks)" "$(sed -n 1p peaks)" 0.003

# Plates that slip are something that only a network can tell.
runs slip
expect 0 explain --model guess.json slip?.csv $some --good-enough 0 --result slip.out --out slip_explained.json
slip=$(sed -n 's/.*"slip": *\([0-9.]*\).*/\1/p' slip_explained.json)
near "the slip" "${slip:-none}" 0.9 0.1

# 125 nodes: an effect of the instrument and one of the material, each beside the other; two jobs say what one says.
for hidden in '{"id": "sensor_lag", "parameters": {"time_s": 0.08}}' \
    '{"id": "strain_dependent_arm", "parameters": {"stiffness_per_strain": 3, "time_per_strain": 0}}'; do
    model "$hidden" 0.49 5 >fine.json
    model '' 0.53 5 >fine_guess.json
    runs fine
    expect 0 explain --model fine_guess.json fine?.csv --candidates sensor_lag,strain_dependent_arm --jobs 2 \
        --result fine.out --out fine_explained.json
    grep -q '"verdict": "explained"' fine.out || fail "$hidden in 125 nodes: $(cat out)"
    grep -q '"nodes": \[5, 5, 5\]' fine_explained.json || fail "what comes out has not 125 nodes"
    case $hidden in
    *lag*)
        expect 0 explain --model fine_guess.json fine?.csv --candidates sensor_lag,strain_dependent_arm --result once.out
        grep -v '"command"' fine.out >a
        grep -v '"command"' once.out >b
        cmp a b || fail "the number of jobs changes the answer for 125 nodes"
        near "the lag in 125 nodes" "$(sed -n 's/.*"time_s": *\([0-9.]*\).*/\1/p' fine_explained.json)" 0.08 0.03
        ;;
    *) near "beta in 125 nodes" "$(sed -n 's/.*"stiffness_per_strain": *\([0-9.]*\).*/\1/p' fine_explained.json)" 3 0.1 ;;
    esac
done

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
