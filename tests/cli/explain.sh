#!/bin/sh
# explain.sh: a bias that is hidden in simulated runs is named, added, and written; nothing hidden, nothing named.
. tests/cli/common

# model EFFECTS >FILE
model() {
    cat <<J
{"palpate": {"model": 1}, "kind": "lumped", "specimen": {"height_mm": 24},
 "stiffness": {"kind": "polynomial", "coefficients_N": [8.2, 3.1]},
 "arms": [{"stiffness_N": $1, "viscosity_Ns": 12}], $2 "formulation": "history"}
J
}

# runs NAME: three presses of a specimen, the first again at the end, with what the model NAME.json does
runs() {
    n=0
    for press in "4 1" "6 2" "7 0.5" "4 1"; do
        set -- "$1" $press
        n=$((n + 1))
        expect 0 simulate true.json --protocol ramp_hold --depth-mm $2 --ramp-s $3 --hold-s 20 --sample-Hz 20 \
            --air-s 3 --noise-N 0.004 --seed $n --out $1$n.csv
    done
}

model 2.1 "" >true.json
model 2.4 "" >guess.json
runs plain
expect 0 explain --model guess.json plain?.csv --result plain.out
grep -q '"verdict": "agrees"' plain.out || fail "nothing hidden: $(cat out)"
grep -q '"effects": \[\]' plain.out || fail "an effect where none is"

model 2.1 '"effects": [{"id": "sensor_lag", "parameters": {"time_s": 0.1}}],' >true.json
runs rough
expect 0 explain --model guess.json rough?.csv --result rough.out --out rough.json
grep -q '"id": "sensor_lag"' rough.json || fail "a lag: $(cat out)"
near "the lag" "$(value rough.out time_s)" 0.1 0.01
model 2.1 "" >true.json

# What is more than noise and below the practical limit agrees for that reason, and says so.
sed 's/"arms": \[[^]]*\]/"arms": []/' guess.json >armless.json
expect 0 explain --model armless.json plain?.csv --max-effects 0 --good-enough 50
grep -q "^agrees: .*below the practical limit" out || fail "the practical limit: $(cat out)"

# Contacts that differ are found by default; known ones have no scatter and no offset, and the rest has to take it in.
shift_contact() { awk -F, -v by="$3" '/^[-0-9]/ { printf "%s,%.9g,%s\n", $1, $2 + by, $3; next } { print }' "$1" >"$2"; }
n=0
for by in 0.05 -0.04 0.02 -0.06; do
    n=$((n + 1))
    shift_contact plain$n.csv apart$n.csv $by
    shift_contact plain$n.csv off$n.csv 0.08
done
expect 0 explain --model guess.json apart?.csv --result apart.out
grep -q '"contact": "free"' apart.out && grep -q '"contact_scatter"' apart.out || fail "contacts that differ: $(cat out)"
grep -q '"verdict": "agrees"' apart.out || fail "contacts that differ are no effect: $(cat out)"
expect 0 explain --model guess.json apart?.csv --contact known --max-effects 0 --result apart.out
grep -q '"contact": "known"' apart.out && ! grep -q '"contact_scatter"' apart.out || fail "--contact known: $(cat out)"
grep -q '"gain_scatter"' apart.out || fail "contacts that are known and differ look like gains: $(cat out)"
grep -q '"contact_scatter_mm": 0' apart.out || fail "contacts that are known scatter: $(grep scatter apart.out)"
expect 0 explain --model guess.json off?.csv --contact common --candidates contact_offset,sensor_bias --result off.out
grep -q '"verdict": "explained"' off.out || fail "--contact common: $(cat out)"
near "common contact" "$(value off.out offset_mm)" 0.08 0.05
expect 0 explain --model guess.json off?.csv --contact known --candidates contact_offset,sensor_bias --result off.out
! grep -q '"id": "contact_offset"' off.out || fail "a known contact is accused: $(cat out)"
expect 2 explain --model guess.json off?.csv --contact auto

# A file's contact.sd_mm is what its contact is expected to be off by.
for n in 1 2 3 4; do
    { echo "# palpate.experiment: 1" && echo "# contact.sd_mm: 0.2" && sed '/palpate.experiment/d' plain$n.csv; } >told$n.csv
done
expect 0 explain --model guess.json plain?.csv --max-effects 0 --result plain.out
expect 0 explain --model guess.json told?.csv --max-effects 0 --result told.out
grep -q '"verdict": "agrees"' told.out || fail "contacts of which a file says how exact they are: $(cat out)"
awk -v a="$(value told.out contact_scatter_mm)" -v b="$(value plain.out contact_scatter_mm)" 'BEGIN { exit !(a > 0.05 && a > 5 * b) }' ||
    fail "contact.sd_mm is not what is expected: $(value told.out contact_scatter_mm), $(value plain.out contact_scatter_mm) mm without"

# The bias by hand: every force 0.06 N up.
for n in 1 2 3 4; do
    awk -F, '/^[-0-9]/ { printf "%s,%s,%.9g\n", $1, $2, $3 + 0.06; next } { print }' plain$n.csv >bias$n.csv
done
expect 0 explain --model guess.json bias?.csv --out explained.json --result bias.out --report page.html
expect 0 explain --model guess.json bias?.csv --json
sed '/^  "figures"/,$d' bias.out | sed 's/^  "command": .*//; $s/,$//' >wanted && echo '}' >>wanted
sed 's/^  "command": .*//' out | cmp -s - wanted || fail "--json prints another result than --result writes"
for key in palpate verdict effects gap phase_shares events not_identifiable next_experiment rejected steps residual_diagnostics; do
    grep -q "^  \"$key\":" bias.out || fail "the result lacks $key"
done
grep -q '"id": "sensor_bias"' bias.out || fail "the bias: $(cat out)"
force=$(awk '/"parameters"/ { on = 1 } on && /"force_N"/ { gsub(/[ ,]/, ""); sub(/.*:/, ""); print; exit }' bias.out)
near "the bias" "$force" 0.06 0.1
grep -q sensor_bias explained.json || fail "the model lacks the bias"
in_page page.html bias.out out
[ "$(figures bias.out | grep -c explain_residuals)" -eq 4 ] || fail "not a figure for each run: $(figures bias.out)"

cp bias.out once
expect 0 explain --model guess.json bias?.csv --jobs 3 --result bias.out
grep -v '"command"' once >a
grep -v '"command"' bias.out >b
cmp a b || fail "the number of jobs changes the answer"

# With a BLAS without locks (Debian's serial one, where it is installed) it is one job, and said so.
serial=$(echo /usr/lib/*/openblas-serial)
if [ -d "$serial" ] && LD_LIBRARY_PATH=$serial ldd "$PALPATE" | grep -q "$serial"; then
    LD_LIBRARY_PATH=$serial
    export LD_LIBRARY_PATH
    expect 0 explain --model guess.json bias?.csv --candidates sensor_bias,toe_region --jobs 2 --result two.out
    grep -q "OpenBLAS is not thread-safe" err || fail "two threads call a BLAS without locks: $(cat err)"
    expect 0 explain --model guess.json bias?.csv --candidates sensor_bias,toe_region --result one.out
    grep -q "thread-safe" err && fail "a word about locks for one job"
    unset LD_LIBRARY_PATH
    grep -v '"command"' one.out >a
    grep -v '"command"' two.out >b
    cmp a b || fail "the number of jobs changes the answer of the serial BLAS"
fi

# One sample in three by the option is one in three by hand.
mkdir thin
for n in 1 2 3 4; do
    awk '/^[-0-9]/ && i++ % 3 { next } { print }' bias$n.csv >thin/bias$n.csv
done
expect 0 explain --model guess.json bias?.csv --every 3 --result every.out
cd thin || exit 1
expect 0 explain --model ../guess.json bias?.csv --result ../thin.out
cd ..
grep -v '"command"' every.out >a
grep -v '"command"' thin.out >b
cmp a b || fail "--every 3 is not one sample in three"

# For palpate report.
mkdir work && cp bias.out work/explain.json
expect 0 report work --out page.html
in_page page.html
for text in '"kind": "result"' '"verdict": "explained"' 'bias of the sensor' '"name": "explain_residuals"' 'bias2.csv'; do
    grep -qF "$text" shown || fail "the report lacks $text"
done

expect 2 explain --model guess.json
says "needs runs and either --model MODEL.json"
expect 2 explain --model guess.json bias1.csv --candidates gremlins
says 'no effect is called "gremlins"'
expect 2 explain --model guess.json bias1.csv --hold-out other.csv
says "other.csv is not among the runs"
# A law that falls in shallow runs is written for as deep as they go.
cat >falls.json <<'J'
{"palpate": {"model": 1}, "kind": "lumped", "specimen": {"kind": "cylinder", "height_mm": 24, "radius_mm": 12},
 "stiffness": {"kind": "spline", "strain": [0, 0.04, 0.08, 0.4], "stiffness_N": [8, 6.4, 4.8, 4.5]}, "arms": [{"stiffness_N": 2, "viscosity_Ns": 2}]}
J
sed 's/"kind": "spline".*\]}, "arms"/"kind": "polynomial", "coefficients_N": [8, -10]}, "arms"/' falls.json >straight.json
expect 0 simulate falls.json --protocol ramp_hold --depth-mm 1.8 --ramp-s 1 --hold-s 5 --sample-Hz 50 --out shallow.csv
expect 0 explain --model straight.json --max-effects 0 --out fallen.json shallow.csv
grep -q '"strain_max": 0.0[78]' fallen.json || fail "no range in the law: $(grep stiffness fallen.json)"
done_testing
