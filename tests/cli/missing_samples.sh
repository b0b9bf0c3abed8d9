#!/bin/sh
# missing_samples.sh: half of the samples missing at random changes intervals only, and is said; what was done is told by
# the path, whatever protocol.kind says; identical runs have their zero and contact found alike. check: once
. tests/cli/common

for seed in 1 2 3 4; do
    expect 0 simulate $DATA/lumped_n2.json --protocol ramp_hold --depth-mm 5 --ramp-s 4 --hold-s 3 --sample-Hz 500 --air-s 1 --noise-N 0.004 --seed $seed --out whole_$seed.csv
    awk -v seed=$seed 'BEGIN { srand(seed) } /^[^0-9-]/ || rand() < 0.5' whole_$seed.csv | sed 's/protocol.kind: "ramp_hold"/protocol.kind: "static"/' >half_$seed.csv
    for run in whole half; do
        expect 0 characterize ${run}_$seed.csv --arms 1 --degree 2 --json --out $run.json
        mv out ${run}_$seed.json
        grep -q '"kind": "ramp_hold"' ${run}_$seed.json || fail "${run}_$seed: another kind"
        grep -q 'free air' ${run}_$seed.json || fail "${run}_$seed: contact_rule"
        grep -q "samples missing (5[0-9]\|samples missing (4[0-9]" err
        [ $? -eq $([ $run = half ] && echo 0 || echo 1) ] || fail "${run}_$seed: what is missing is not said, or something is"
        near "${run}_$seed: gaps" "$(value ${run}_$seed.json gaps)" 0 0
        near "${run}_$seed: noise" "$(value ${run}_$seed.json noise_N)" 0.004 0.12
        near "${run}_$seed: ramp" "$(value ${run}_$seed.json ramp_s)" 4 0.02
        near "${run}_$seed: zero" "$(value ${run}_$seed.json zero_N)" 0 0 1.5e-3
        near "${run}_$seed: contact" "$(value ${run}_$seed.json contact_mm)" 0 0 0.06
    done
done

# A ramp without a dwell is called that in words and in JSON.
expect 0 simulate $DATA/lumped_n2.json --protocol static --depth-mm 5 --rate-mm-s 0.5 --sample-Hz 100 --noise-N 0.004 --seed 1 --out ramp.csv
expect 0 characterize ramp.csv --json
grep -q '"kind": "ramp"' out || fail "JSON has another kind of a ramp without a dwell"
grep -q 'ramp without a dwell' err || fail "a ramp without a dwell is not called that"
done_testing
