#!/bin/sh
# explain_seed.sh: the seed's own disagreements, made from its tables: what palpate explain makes of each. check: once
. tests/cli/common
PYTHONDONTWRITEBYTECODE=1
export PALPATE PYTHONDONTWRITEBYTECODE
command -v python3 >/dev/null || { echo "no python3"; exit 77; }

make() { "$DATA/disagreements.py" "$@" >made 2>err || { fail "disagreements.py $*:"; sed 's/^/    /' err; }; }

# ratio FILE: gap of left-out experiments after over before
gap() { echo "$(value "$1" heldout_after_N) $(value "$1" heldout_before_N) $(value "$1" noise_level_N)"; }

# parameter MODEL KEY: of its first effect
parameter() { sed -n "s/.*\"$2\": *\([-0-9.e]*\).*/\1/p" "$1" | tail -n 1; }

# N = 1 against the curves of Table 4.3: a second relaxation time, that of the table's second arm; then the noise, 4 mN.
make second second-arm --depth-mm 6
expect 0 explain --model second/model.json second/run_*.csv --candidates relaxation_arm,sensor_drift,sensor_lag,rate_stiffening \
    --result second.out --out second.json
grep -q '"id": "relaxation_arm"' second.json || fail "no second relaxation time: $(cat out)"
set -- $(grep '^6,' "$DATA/table_4_3.csv" | tr , ' ')
near "its time" "$(parameter second.json time_s)" "$(awk "BEGIN { print $5 / $4 }")" 0.03
near "its stiffness" "$(sed -n 's/.*"parameters": {"stiffness_N": *\([0-9.]*\).*/\1/p' second.json)" "$4" 0.03
gap second.out | awk '{ exit !($1 < 0.0042 && $2 > 3 * $3) }' || fail "the gap of N = 1: $(gap second.out)"

# Static loading and holds by one law: the runs differ from each other as contacts or gains of their own would make them
# (doc/explain-cases.md); no effect of the instrument is named for it.
make static static
expect 0 explain --model static/model.json static/run_*.csv --every 2 --result static.out --out static.json
grep -Eq '"id": "(contact|gain)_scatter"' static.out || fail "static against holds: $(cat out)"
grep -Eq '"id": "(sensor|frame|drive|mains|coulomb|plate)_' static.json && fail "an instrument is accused: $(cat out)"
gap static.out | awk '{ exit !($1 > $3 && $1 < 0.008) }' || fail "the gap of static against holds: $(gap static.out)"

# A network with constant arms against one lumped material from 2 mm to 9 mm: its arms depend on strain.
make network network
expect 0 explain --model network/model.json network/run_*.csv --every 2 --jobs 2 \
    --candidates strain_dependent_arm,relaxation_arm,rate_stiffening,sensor_lag,contact_offset,frame_compliance \
    --result network.out --out network.json
grep -q '"id": "strain_dependent_arm"' network.json || fail "constant arms: $(cat out)"
parameter network.json time_per_strain | awk '{ exit !($1 > -0.3 && $1 < 0.3) }' || fail "its time depends on strain"
sed -n 's/.*"stiffness_per_strain": *\([-0-9.]*\).*/\1/p' network.json |
    awk '{ exit !($1 > 2.5 && $1 < 7) }' || fail "beta: $(cat network.json)"
set -- "$(value network.out before_N)" "$(value network.out after_N)" "$(value network.out noise_level_N)"
echo "$@" | awk '{ exit !($2 ^ 2 - $3 ^ 2 < 0.35 * ($1 ^ 2 - $3 ^ 2) && $2 < 1.18 * $3) }' || fail "the gap of constant arms: $*"
done_testing
