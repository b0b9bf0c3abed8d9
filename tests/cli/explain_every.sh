#!/bin/sh
# explain_every.sh: of recordings of 1 kHz one sample in 70 is taken, and the path between them is known: a sensor lag is right.
# check: once
. tests/cli/common

model() {
    cat <<J
{"palpate": {"model": 1}, "kind": "lumped", "specimen": {"height_mm": 24},
 "stiffness": {"kind": "polynomial", "coefficients_N": [8.2, 3.1]},
 "arms": [{"stiffness_N": 2.1, "viscosity_Ns": 12}], $1 "formulation": "history"}
J
}

model '"effects": [{"id": "sensor_lag", "parameters": {"time_s": 0.05}}],' >true.json
model "" >given.json
n=0
for press in "2 0.7" "4.5 1.1" "7 0.9"; do
    n=$((n + 1))
    set -- $press
    expect 0 simulate true.json --protocol ramp_hold --depth-mm $1 --ramp-s $2 --hold-s 20 --sample-Hz 1000 \
        --air-s 1 --noise-N 0.002 --seed $n --out run$n.csv
done
expect 0 explain --model given.json run?.csv --every 70 --candidates sensor_lag,relaxation_arm --result every.out
grep -q '"verdict": "explained"' every.out || fail "one sample in 70: $(cat out)"
near "lag with one sample in 70" "$(value every.out time_s)" 0.05 0.01

# A file without samples is refused.
head -n 1 run1.csv | grep '^#' >empty.csv
echo time_s,depth_mm,force_N >>empty.csv
expect 1 explain --model given.json empty.csv --every 70
grep -q 'empty.csv: fewer than 16 samples' err || fail "an empty file: $(cat err)"
