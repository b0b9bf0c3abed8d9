#!/bin/sh
# explain_page.sh: the page of palpate explain for each verdict: whole, of one mind with its result, and with its sentences.
. tests/cli/common

# model EFFECTS STIFFNESS >FILE
model() {
    cat <<J
{"palpate": {"model": 1}, "kind": "lumped", "specimen": {"height_mm": 24},
 "stiffness": {"kind": "polynomial", "coefficients_N": [8.2, 3.1]},
 "arms": [{"stiffness_N": $2, "viscosity_Ns": 12}], "effects": [$1], "formulation": "history"}
J
}

# runs NAME MODEL AIR: three presses, the first again at the end
runs() {
    n=0
    for press in "4 1" "6 2" "7 0.5" "4 1"; do
        set -- "$1" "$2" "$3" $press
        n=$((n + 1))
        expect 0 simulate "$2" --protocol ramp_hold --depth-mm "$4" --ramp-s "$5" --hold-s 20 --sample-Hz 20 \
            --air-s "$3" --noise-N 0.004 --seed $n --out "$1$n.csv"
    done
}

# force NEWTONS: as the sentences have it
force() {
    awk -v f="$1" 'BEGIN { s = f < 0 ? -f : f
        if (s >= 0.9995) printf "%.3g N", f; else if (s >= 9.995e-4 || s == 0) printf "%.3g mN", 1e3 * f
        else printf "%.3g \302\265N", 1e6 * f }'
}

# part RESULT KEY: one of its members, whole
part() { sed -n "/^  \"$2\": [[{]\$/,/^  []}]/p" "$1"; }

# page PAGE RESULT VERDICT
page() {
    grep -q "^  \"verdict\": \"$3\"" "$2" || fail "not $3: $(grep '"verdict"' "$2")"
    in_page "$1" "$2"
    part "$2" sentences >said
    grep -qE 'nats|what can be closed|see the class|(^|[^a-z])(nan|inf|null)([^a-z]|$)' said && fail "$1: words that the page does not explain"
    for key in heldout_before_N heldout_after_N noise_level_N; do
        grep -qF "$(force "$(value "$2" $key)")" said || fail "$1: $key is not $(force "$(value "$2" $key)")"
    done
    [ "$(figures "$2" | grep -c explain_residuals)" -eq 4 ] || fail "$1: not a figure for each run"
    [ "$(grep -o '"style":"band"' "$2" | wc -l)" -eq "$4" ] || fail "$1: not the noise level, and a tint for each state of the model, in each run"
    for n in 1 2 3 4; do grep -q "\"title\":\"[a-z]*$n.csv, rms [^\"]* mN\"" "$2" || fail "$1: run $n is not in the figures"; done
    for id in $(part "$2" effects | sed -n 's/^      "id": "\(.*\)",/\1/p'); do
        part "$2" catalogue | sed -n "/\"$id\"/,/}/p" | grep -q '"means": "..*"' || fail "$1: no words for $id"
    done
}

model '' 2.1 >true.json
model '' 2.4 >guess.json
runs plain true.json 3

# Nothing hidden.
expect 0 explain --model guess.json plain?.csv --result plain.out --report plain.html
page plain.html plain.out agrees 8
grep -q '"effects": \[\]' plain.out || fail "an effect where none is"

# A lag of the sensor, and a spike.
model '{"id": "sensor_lag", "parameters": {"time_s": 0.15}}' 2.1 >lag.json
runs lag lag.json 3
awk -F, '/^[-0-9]/ && ++n == 250 { printf "%s,%s,%.9g\n", $1, $2, $3 + 0.5; next } { print }' lag2.csv >spiked && mv spiked lag2.csv
expect 0 explain --model guess.json lag?.csv --result lag.out --report lag.html
page lag.html lag.out explained 12
part lag.out events | grep -q 'lag2.csv' || fail "the spike is not among the events"

# A weak relaxation, which these holds do not tell from one by a power of time.
model '{"id": "relaxation_arm", "parameters": {"stiffness_N": 0.09, "time_s": 0.4}}' 2.1 >weak.json
runs weak weak.json 1
expect 0 explain --model guess.json weak?.csv --candidates power_law_relaxation,poroelastic,relaxation_arm \
    --result weak.out --report weak.html --next next.out
page weak.html weak.out ambiguous 12
grep -q 'could as well be' said || fail "the class is not told"
[ -s next.out ] && grep '"next_sentence"' weak.out | grep -qF "$(value next.out depth_mm | awk '{ printf "%.3g mm", $1 }')" || fail "the next experiment's depth"

# A zero that flips: nothing of the catalogue.
for n in 1 2 3 4; do
    awk -F, '/^[-0-9]/ { printf "%s,%s,%.9g\n", $1, $2, $3 + (int($1 / 3.7) % 2 ? 0.05 : -0.05); next } { print }' plain$n.csv >flip$n.csv
done
expect 0 explain --model guess.json flip?.csv --result flip.out --report flip.html
page flip.html flip.out unexplained 8
grep '"next_sentence"' flip.out | grep -q 'Repeat flip[1-4].csv' || fail "what to repeat is not told"
done_testing
