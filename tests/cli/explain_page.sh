#!/bin/sh
# explain_page.sh: the page of palpate explain for each verdict: well formed, whole, and of one mind with its result.
. tests/cli/common
command -v gnuplot >/dev/null || { echo "gnuplot is not installed"; exit 77; }

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
        expect 0 simulate "$2" --protocol ramp_hold --depth-mm "$4" --ramp-s "$5" --hold-s 20 --sample-Hz 40 \
            --air-s "$3" --noise-N 0.004 --seed $n --out "$1$n.csv"
    done
}

# well_formed PAGE: every tag that opens closes, in its order
well_formed() {
    awk -v RS='<' 'NR > 1 && !/^!DOCTYPE/ {
        if (!match($0, /^\/?[a-z][a-z0-9]*/) || $0 !~ />/) { print "no tag: <" $0; bad = 1; exit }
        name = substr($0, 1, RLENGTH); tag = substr($0, 1, index($0, ">"))
        if (name == "meta" || tag ~ /\/>$/) next
        if (name !~ /^\//) { open[++depth] = name; next }
        if ("/" open[depth] != name) { print name " closes " open[depth]; bad = 1; exit }
        depth--
    } END { if (!bad && depth != 0) { print "left open: " open[depth]; bad = 1 } exit bad }' "$1" || fail "$1 is not well formed"
}

count() { grep -o -e "$1" "$2" | wc -l; }

# force NEWTONS: as the page has it
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
    well_formed "$1"
    grep -o '\(src\|href\)="[^"#][^"]*"' "$1" | grep -q . && fail "$1 refers to another file"
    grep -q '<script\|@import\|<link\|<img' "$1" && fail "$1 is not self-contained"
    grep -Eiq '(^|[^a-z])(nan|inf|null)([^a-z]|$)' "$1" && fail "$1: a number is none"
    grep -q "<div class=\"verdict $3\">" "$1" || fail "$1 does not say $3"
    grep -qE 'nats|what can be closed|see the class' "$1" && fail "$1: words that the page does not explain"
    for text in 'The gap before and after' 'Where they disagree' 'The candidates and their scores' 'Residual diagnostics' \
        'What to measure next' 'What the noise level is made of' 'Share of the first gap' 'The same by speed' 'Waves over time' \
        'Waves over depth' 'The most that an effect' 'Recorded minus model:'; do
        [ "$(count "<\(h3\|caption\|figcaption\)>$text" "$1")" -eq 1 ] || fail "$1: not one \"$text\""
    done
    for key in heldout_before_N noise_level_N unexplained_N; do
        grep -qF "$(force "$(value "$2" $key)")" "$1" || fail "$1: $key is not $(force "$(value "$2" $key)")"
    done
    # a bar for every candidate of every step, a row for every place and event
    sed '/class="candidates"/,/<h3>Residual diagnostics/!d' "$1" >candidates
    [ "$(count '<td class="bar">' candidates)" -eq "$(part "$2" steps | grep -c '"score"')" ] || fail "$1: candidates are missing"
    [ "$(count '</h4>' "$1")" -eq "$(($(part "$2" steps | grep -c '"taken"') + $(part "$2" effects | grep -c '"evidence"')))" ] ||
        fail "$1: steps or effects are missing"
    part "$2" steps | sed -n 's/.*"reason": "\(.*\)",*/\1/p' | sort -u | while read -r reason; do
        grep -qF "$reason" "$1" || echo "$reason"
    done | grep . && fail "$1: reasons are missing"
    sed '/runs test, place by place/,$!d' "$1" | sed '/<\/table>/q' >places
    [ "$(count '<tr><td>' places)" -eq "$(part "$2" phase_shares | grep -c '"phase"')" ] || fail "$1: places are missing"
    share=$(part "$2" phase_shares | sed -n 's/.*"share": *\([^,]*\).*/\1/p' | head -n 1)
    said="Nowhere is the gap above the noise level"
    [ -z "$share" ] || said=$(awk -v s="$share" 'BEGIN { printf ": %.0f %%.</p>", 100 * s }')
    grep -qF "$said" "$1" || fail "$1: the largest place is not $said"
    # every experiment and bin of the profile
    for n in 1 2 3 4; do
        grep -q "<text[^>]*>[a-z]*$n.csv *rms [^<]* mN</text>" "$1" || fail "$1: run $n is not in the picture"
    done
    part "$2" profile | sed -n 's/.*"before_N": *\([^,]*\).*/\1/p' | while read -r n; do
        grep -qF ">$(force "$n")" "$1" || echo "$n"
    done | grep . && fail "$1: the profile differs"
    [ "$(count 'depth of the plate over time' "$1")" -eq "$(part "$2" next_experiment | grep -c '"kind"')" ] ||
        fail "$1: the next experiment is not as in the result"
}

model '' 2.1 >true.json
model '' 2.4 >guess.json
runs plain true.json 3

# Nothing hidden.
expect 0 explain --model guess.json plain?.csv --result plain.out --report plain.html
page plain.html plain.out agrees
grep -q 'class="effect"' plain.html && fail "an effect where none is"

# A lag of the sensor, and a spike.
model '{"id": "sensor_lag", "parameters": {"time_s": 0.15}}' 2.1 >lag.json
runs lag lag.json 3
awk -F, '/^[-0-9]/ && ++n == 500 { printf "%s,%s,%.9g\n", $1, $2, $3 + 0.5; next } { print }' lag2.csv >spiked && mv spiked lag2.csv
expect 0 explain --model guess.json lag?.csv --result lag.out --report lag.html --plot work
page lag.html lag.out explained
low=$(part lag.out effects | sed -n '/"intervals"/,/]/p' | sed -n '/time_s/,/]/p' | sed -n 's/^ *\([0-9.]*\),$/\1/p')
sed -n 's/.*<tr><td>time<\/td><td>[0-9.]*<\/td><td>\([0-9.]*\) to .*<td class="t">s<\/td>.*/\1/p' lag.html >shown
near "the interval's lower end" "$(cat shown)" "$low" 0.01
grep -qF "$(force "$(value lag.out heldout_after_N)")" lag.html || fail "the gap after is not on the page"
grep -q 'class="taken"' lag.html || fail "no candidate is marked as taken"
grep -q '<td>lag2.csv</td><td class="t">spike</td>' lag.html || fail "the spike is not among the events"
[ "$(count ' id="[^"]*gnuplot_plot_[^"]*"' lag.html)" -eq 24 ] ||
    fail "not the floor and two curves with their tints in each of four panels, and two curves in two spectra"
grep -o ' id="[^"]*"' lag.html | sort | uniq -d | grep -q . && fail "lag.html: an id is there twice"

# The report has the same.
expect 0 report work --out report.html
well_formed report.html
for text in 'The candidates and their scores' 'What to measure next' 'The force sensor is late' 'Recorded minus model:'; do
    grep -qF "$text" report.html || fail "the report lacks \"$text\""
done

# Relaxation as a power of time, which holds of 20 s do not tell from the draining of pores.
model '{"id": "power_law_relaxation", "parameters": {"stiffness_N": 0.3, "exponent": 0.1}}' 2.1 >power.json
runs power power.json 1
expect 0 explain --model guess.json power?.csv --result power.out --report power.html --next next.out
page power.html power.out ambiguous
grep -q 'could as well be' power.html || fail "the class is not told"
[ -s next.out ] && grep -qF "$(value next.out depth_mm | awk '{ printf "%.3g mm", $1 }')" power.html || fail "the next experiment's depth"

# A zero that flips: nothing of the catalogue.
for n in 1 2 3 4; do
    awk -F, '/^[-0-9]/ { printf "%s,%s,%.9g\n", $1, $2, $3 + (int($1 / 3.7) % 2 ? 0.05 : -0.05); next } { print }' plain$n.csv >flip$n.csv
done
expect 0 explain --model guess.json flip?.csv --result flip.out --report flip.html
page flip.html flip.out unexplained
grep -q 'Repeat flip[1-4].csv' flip.html || fail "what to repeat is not told"
done_testing
