#!/bin/sh
# explain_measured.sh: two specimens of a rubber as others measured them: a model's own faults are not taken for what
# differs from run to run, so the refit leaves little more than the fit of palpate characterize, which weighs all
# samples alike; nothing is named. check: once
. tests/cli/common

expect 0 import "$ROOT"/data/measured/ecoflex/*.csv --out ecoflex
for material in EF10_0T EF30_0T EF30_50T; do
    set -- ecoflex/${material}_A2.csv ecoflex/${material}_B2.csv
    expect 0 characterize "$@" --arms 0 --law mooney_rivlin5 --out model.json
    for run; do
        expect 0 simulate model.json --like "$run" --out like.csv
        grep '^[-0-9]' like.csv | cut -d , -f 3 >force
        grep '^[-0-9]' "$run" | cut -d , -f 3 | paste -d , - force
    done | awk -F , '{ sum += ($1 - $2) ^ 2 } END { print sqrt(sum / NR) }' >characterized
    expect 0 explain --model model.json "$@" --every 4 --result result.json
    awk -v a="$(value result.json before_N)" -v b="$(cat characterized)" 'BEGIN { exit !(a > 0 && a < 1.3 * b) }' ||
        fail "$material: the refit leaves $(value result.json before_N) N, characterize $(cat characterized) N"
    grep -q '"effects": \[\]' result.json || fail "$material: one monotone ramp told $(cat out)"
done
done_testing
