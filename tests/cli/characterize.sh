#!/bin/sh
# characterize.sh: recordings whose answer is known give it back; bad ones are told of or refused. check: asan
. tests/cli/common

# The phantom of Tables 4.5 and Eq. 4.2: K1 2.5847711, b1 3.6146, K2 0.6853036, b2 23.964533.
L=$DATA/lumped_n2.json
sensor="--sample-Hz 100 --air-s 1 --noise-N 0.004"
for depth in 2 3 4 5 6 7; do
    expect 0 simulate $L --protocol ramp_hold --depth-mm $depth --hold-s 150 $sensor --seed $depth --out hold$depth.csv
done
expect 0 simulate $L --protocol static --depth-mm 9.7 --rate-mm-s 0.1 $sensor --seed 9 --out static.csv

# estimate NAME FILE KEY: of the model's parameters, the first list of the JSON
estimate() { awk -v n="\"$1\"," -v k="\"$3\":" '/"correlation"/ { exit } $2 == n { on = 1 } on && $1 == k { sub(",", "", $2); print $2; exit }' "$2"; }

expect 0 characterize static.csv hold?.csv --out lumped.json --json
cp out joint.json
for key in palpate command law arms estimates correlation runs static law_scores per_depth shared comparison warnings \
    filter total_absolute_residual_N; do
    grep -q "^  \"$key\":" out || fail "--json lacks $key"
done
[ "$(grep -c " samples; " err)" -eq 7 ] || fail "not one line for each run on stderr"
grep -q 'static.csv: ramp without a dwell to 9.7.* mm.*contact.*+-.*(free air); zero.*+-.*noise' err || fail "findings: $(tail -n 1 err)"
near "arms of auto" "$(grep -c '"tau_s"' joint.json)" 4 0 # two of the model, two shared
near "K1" "$(estimate K_1 joint.json value)" 2.5847711 0.01
near "b1" "$(estimate b_1 joint.json value)" 3.6146 0.01
near "K2" "$(estimate K_2 joint.json value)" 0.6853036 0.01
near "b2" "$(estimate b_2 joint.json value)" 23.964533 0.02

# Eq. 4.3 within 1 % from strain 0.03 to 0.4, where the plain polynomial is off by more.
laws() { # the coefficients of the joint law, and of the plain polynomial of degree 5
    awk '/"coefficients_N"/ { on = 1; next } on && /\]/ { exit } on { gsub(/[ ,]/, ""); print }' joint.json >joint
    awk '/"degree": 5/ { five = 1 } five && /"coefficients_N"/ { on = 1; next } on && /\]/ { exit }
        on { gsub(/[ ,]/, ""); print }' joint.json >plain
}
laws
for name in joint plain; do
    awk '{ c[NR - 1] = $1 } END { if (NR != 5) exit 1
        for (e = 0.03; e <= 0.4; e += 0.01) {
            k = c[0] + e * (c[1] + e * (c[2] + e * (c[3] + e * c[4])))
            w = 8.18 + e * (-0.70 + e * (47.47 + e * (-131.36 + e * 146.89)))
            d = k / w - 1; if (d < 0) d = -d; if (d > worst) worst = d } print worst }' $name >$name.worst ||
        fail "$name: not five coefficients"
done
awk '$1 > 0.01 { exit 1 }' joint.worst || fail "the joint law is off Eq. 4.3 by $(cat joint.worst)"
awk '$1 < 0.03 { exit 1 }' plain.worst || fail "the plain polynomial is not biased: $(cat plain.worst)"
near "gap after" "$(value joint.json gap_after_percent)" 0 0 0.3
awk -v g="$(value joint.json gap_before_percent)" 'BEGIN { exit !(g > 3) }' || fail "no gap before the joint fit"

# Forces of any size are printed with the digits that they have: the same but for the power of ten.
for scale in 1 1e-11; do
    awk -F, -v s=$scale 'BEGIN { OFS = "," } /^[0-9]/ { $3 = sprintf("%.9e", s * $3) } { print }' hold5.csv >scaled.csv
    expect 0 characterize scaled.csv --arms 1 --degree 2
    awk -v s=$scale '$1 ~ /^(K_1|b_1|c0)$/ { print $1, $2 / s, $3 / s, $5 / s }' out >digits$scale
done
[ "$(grep -c . digits1)" -ge 3 ] && paste -d' ' digits1 digits1e-11 | awk '{ for (j = 2; j <= 4; j++) { d = $j / $(j + 4) - 1; if (d > 2e-3 || d < -2e-3) bad = 1 } } END { exit bad }' ||
    fail "small forces: $(paste -d' ' digits1 digits1e-11 | tr '\n' ';')"

# A run that goes on in another file is one run, whichever comes first.
head -n 1 hold5.csv >second.csv
grep -v '^[0-9-]' hold5.csv | tail -n +2 >>second.csv
awk '/^[0-9-]/ && ++n > 2000' hold5.csv >>second.csv
awk '!/^[0-9-]/ || ++n <= 2000' hold5.csv >first.csv
for runs in hold5.csv "first.csv second.csv" "second.csv first.csv"; do
    expect 0 characterize $runs static.csv --out halves.json
    cat halves.json >>halves
done
grep -q '^palpate characterize: second.csv: continues first.csv, and is joined to it as one run$' err || fail "the second half: $(cat err)"
[ "$(sort -u halves | wc -l)" -eq "$(wc -l <halves.json)" ] || fail "a run in two files is another: $(cat halves)"

# The written model answers as the phantom.
for model in lumped.json $L; do
    expect 0 simulate $model --protocol ramp_hold --depth-mm 4.5 --hold-s 100 --json
    value out peak_force_N >>peaks
done
near "peak at 4.5 mm" "$(sed -n 1p peaks)" "$(sed -n 2p peaks)" 0.003

# The model knows how well it is known: the phantom's force, of a press that no run has, is in the band but for what 95 % leave out.
expect 0 simulate lumped.json --protocol ramp_hold --depth-mm 5.5 --ramp-s 3 --hold-s 60 --band --out band.csv
expect 0 simulate $L --like band.csv --out known.csv
grep -q '^time_s,depth_mm,force_N,force_low_N,force_high_N$' band.csv || fail "--band: $(grep ^time_s band.csv)"
grep '^[0-9]' band.csv >a; grep '^[0-9]' known.csv >b
paste -d, a b | awk -F, '/^[0-9]/ { n++; in_it += $8 >= $4 && $8 <= $5; width = $5 - $4; if ($2 > 1 && (width <= 0 || width > 0.01 * $3)) bad++ }
    END { if (n < 50 || bad || in_it < 0.8 * n) { print in_it " of " n " in the band, " bad " of odd width"; exit 1 } }' || fail "the band"
grep -q '"force_high_N"' joint.json || fail "no band in the result"
expect 1 simulate $L --protocol ramp_hold --depth-mm 5 --band
says 'needs a "covariance"'
expect 1 simulate $DATA/network_27.json --protocol ramp_hold --depth-mm 5 --hold-s 1 --band
says 'needs a "covariance"'
expect 2 simulate lumped.json --protocol creep --force-N 1 --band
says '--band does not go with --protocol creep'

# Contacts that are off by another tenth of a millimetre in each run, and told to be known: they are found, and K(e) with them.
i=0
for f in static.csv hold?.csv; do
    i=$((i + 1))
    awk -F, -v i=$i 'BEGIN { split("0.12 -0.1 0.06 0.16 -0.18 0.04 -0.08", s, " ") }
        /^[0-9]/ { if ($2 > -0.05) printf "%s,%.6f,%s\n", $1, $2 + s[i], $3; next } { print }' $f >off_$f
done
expect 0 characterize off_*.csv --arms 2 --contact-mm 0 --out found.json --json
grep -qF "contact differs between runs by 0.1" err || fail "contacts: $(cat err)"
grep -q '"contact": "free"' out || fail "contact is not free"
near "scatter of contacts" "$(value out contact_scatter_mm)" 0.115 0.15
for model in found.json $L; do
    expect 0 simulate $model --protocol static --relaxed --depth-mm 9 --json
    value out final_force_N >>relaxed
done
near "relaxed force with contacts found" "$(sed -n 1p relaxed)" "$(sed -n 2p relaxed)" 0.001
expect 0 characterize off_*.csv --arms 2 --contact-mm 0 --contact known --json
grep -q '"contact": "known"' out || fail "--contact known"
grep -q "contact differs" err && fail "--contact known found some"

# Text; arms by number; shared only, single only; the seed's grid needs no smaller total residual.
expect 0 characterize static.csv hold?.csv --arms 2
for text in 'Table 4.1' 'Tables 4.2 and 4.3' 'Tables 4.4 and 4.5' 'Figure 4.26' '95 % interval' 'correlated above 0.95'; do
    grep -q "$text" out || fail "the text lacks \"$text\""
done
expect 0 characterize hold?.csv --arms 2 --shared-arms --json
grep -q '"per_depth": \[\]' out || fail "--shared-arms fitted single depths"
awk '/"shared": {/ { on = 1 } on && /total_absolute/ { sub(",", "", $2); print $2; exit }' out >ours
expect 0 characterize hold?.csv --arms 2 --method grid --json
awk '/"shared": {/ { on = 1 } on && /total_absolute/ { sub(",", "", $2); print $2; exit }' out >grid
awk -v a="$(cat ours)" -v b="$(cat grid)" 'BEGIN { exit !(a > 0 && a <= 1.01 * b) }' || fail "nlopt $(cat ours), grid $(cat grid)"
expect 0 characterize hold?.csv --arms 2 --per-depth --json
grep -q '"shared": null' out || fail "--per-depth fitted shared arms"
expect 0 characterize hold5.csv --arms 1 --law polynomial --json
near "one depth: a constant" "$(sed -n '/"law"/,/}/p' out | grep -c '^ *[-0-9.]*$')" 1 0
grep -qF "cannot be told apart" err && fail "a warning of the law by evidence with --law polynomial"

# The law by evidence: the form that made the runs; a single ramp has a law too, and is told what it leaves open.
expect 0 characterize static.csv hold?.csv --arms 2 --json
near "the law taken" "$(awk '/"law_scores"/ { on = 1 } on && /"taken": true/ { print n; exit } on && $1 == "\"parameters\":" { n = $2 + 0 }' out)" 5 0
grep -A1 '"law": {' out | grep -q '"kind": "polynomial"' || fail "the law by evidence is no polynomial"
expect 0 characterize hold5.csv --arms 2 --json
grep -qF "one ramp to one depth at one speed cannot separate K(e) from arms faster than the ramp" err || fail "one ramp: $(cat err)"
awk '/"law"/ { on = 1 } on && /"coefficients_N"/ { list = 1; next } list && /\]/ { exit } list { gsub(/[ ,]/, ""); c[n++] = $1 }
    END { e = 5 / 24; for (i = n; i-- > 0;) k = k * e + c[i]; exit !(n > 1 && k > 0.99 * 9.184 && k < 1.01 * 9.184) }' out || fail "one ramp: K at its depth"
expect 0 characterize static.csv --arms 0 --degree 4 --json
near "a static run alone, --arms 0: no arms" "$(grep -c '"tau_s"' out)" 0 0 0
grep -qF "cannot separate K(e)" err && fail "there are no arms to separate: $(cat err)"
expect 0 characterize static.csv --arms 1 --json
grep -qF "at one speed without a dwell cannot separate K(e) from arms" err || fail "one static run, --arms 1: $(cat err)"
for law in spline neo_hookean mooney_rivlin2 mooney_rivlin5 yeoh; do
    expect 0 characterize static.csv hold?.csv --arms 2 --law $law --shared-arms --out law.json --json
    grep -q "\"kind\": \"$law\"" out || fail "--law $law is another"
done

# What goes wrong while recording: told, and the answer stays. A mean of 4 mN noise and its interval aside.
run="$L --protocol ramp_hold --depth-mm 5 --hold-s 150"
told() { # text, options of simulate...
    text=$1; shift
    expect 0 simulate $run $sensor --seed 5 "$@" --out odd.csv
    expect 0 characterize static.csv hold?.csv odd.csv --arms 2 --shared-arms --json
    grep "odd.csv" err | grep -q "$text" || fail "no \"$text\": $(grep odd.csv err)"
    near "$text: K1" "$(estimate K_1 out value)" 2.5847711 0.03
    near "$text: b2" "$(estimate b_2 out value)" 23.964533 0.05
}
told "1 spike(s) masked" --spike 20,2
told "1 gap(s)" --drop 30,31
told "clipped samples masked" --clip-N 2.2
told "hum of" --hum-N 0.01 --sample-Hz 500
sed '/^specimen/d' hold5.csv | awk -F, '/^[0-9]/ { n++; if (n % 7 == 3) next } { print }' >odd.csv
expect 0 characterize odd.csv --arms 2
grep -q "uneven sampling\|gap" err || fail "uneven sampling is not told: $(cat err)"
{ head -n 3000 hold5.csv; echo '# end.fault: "over_temperature"'; } >odd.csv
expect 0 characterize odd.csv --arms 1 --json
grep -q "cut short by a fault" err || fail "a fault is not told: $(cat err)"

wrong() { # exit code, text, arguments...: the last line says why
    code=$1 text=$2; shift 2
    expect $code characterize "$@"
    tail -n 1 err | grep -qF -e "palpate characterize: " && tail -n 1 err | grep -qF -e "$text" ||
        fail "characterize $*: stderr lacks \"$text\": $(tail -n 1 err)"
    [ -s out ] && fail "characterize $*: wrote to stdout"
}
awk -F, '/^[0-9]/ { print $1 "," -$2 "," $3; next } { print }' hold5.csv >sign.csv
awk -F, '/^[0-9]/ { print $1 ",0," $3; next } { print }' hold5.csv >still.csv
awk -F, '/^[0-9]/ { print $1 "," $2 ",0"; next } { print }' hold5.csv >forceless.csv
grep -v height_mm hold5.csv >heightless.csv
grep -v radius_mm static.csv >radiusless.csv
sed 's/height_mm: 24/height_mm: 30/' hold5.csv >taller.csv
wrong 1 "none.csv" none.csv
wrong 1 "sign.csv" sign.csv
wrong 1 "still.csv" still.csv
wrong 1 "forceless.csv" forceless.csv
wrong 1 "--specimen-height-mm" heightless.csv
wrong 1 "specimen.radius_mm" radiusless.csv --law yeoh
wrong 1 "has 24 mm; assign runs" hold4.csv taller.csv --specimens one
grep -v radius_mm taller.csv >taller_bare.csv
wrong 1 "needs their radii" hold4.csv taller_bare.csv
wrong 1 "needs ramp-and-hold runs" static.csv --method grid --arms 1
wrong 2 "name a RUN.csv"
wrong 2 "--arms must be auto or a whole number from 0 to 16, not \"2.5\"" hold5.csv --arms 2.5
wrong 2 "--degree must be auto or a whole number from 2 to 7, not \"9\"" hold5.csv --degree 9
wrong 2 "goes with --law polynomial" hold5.csv --law yeoh --degree 3
wrong 2 "goes with --law spline" hold5.csv --law polynomial --knots 4
wrong 2 "--shared-arms or --per-depth, not both" hold5.csv --shared-arms --per-depth
wrong 2 "needs --arms 1 or --arms 2" hold5.csv --method grid
wrong 2 "must be one of auto|polynomial" hold5.csv --law cubic
expect 0 characterize heightless.csv --specimen-height-mm 24 --arms 2
# A recording with a hole says so; one that acquire has found to lack samples did not end early.
awk -F, '!/^[0-9]/ || $1 < 100 || $1 > 150' hold5.csv | sed '2i # end.fault: "samples_lost"' >hole.csv
expect 0 characterize hole.csv --arms 2
grep -Eq 'hole.csv: .* samples missing \([0-9]+ %\)' err || fail "no word of the hole: $(cat err)"
grep -q "cut short" err && fail "it did not end early: $(cat err)"
ls | grep -q tmp && fail "a temporary file was left behind"

expect 0 characterize static.csv hold?.csv --result result.json --report page.html --json
for name in recordings_linear recordings_log recordings_first recordings_static fit_linear fit_log fit_first fit_depth fit_static residuals; do
    figures result.json | grep -qx $name || fail "no figure $name: $(figures result.json | tr '\n' ' ')"
done
[ "$(sed '/^  "figures"/,$d' result.json | sed '$s/,$//'; echo '}')" = "$(cat out)" ] || fail "--result is not what --json prints, with figures"
in_page page.html result.json out
[ "$(wc -c <page.html)" -lt 1500000 ] || fail "a page of $(wc -c <page.html) bytes: curves are not thinned"
# Runs that their depths do not tell apart have their names in the key, others their depths.
grep -q '"name":"fit_log".*"title":"5 mm"' result.json || fail "the key does not name the depths"
sed '/^[0-9]/s/$/ /' hold5.csv >again5.csv
expect 0 characterize hold5.csv again5.csv --arms 1 --degree 2 --result named.json
grep -q '"name":"fit_log".*"title":"hold5"' named.json && grep -q '"name":"fit_log".*"title":"again5"' named.json || fail "the key does not name runs of one depth"

# The model may have a polynomial of six coefficients; the plain one beside it is fitted too.
cat >six.json <<'J'
{"palpate": {"model": 1}, "kind": "lumped", "specimen": {"height_mm": 20}, "arms": [{"stiffness_N": 17, "viscosity_Ns": 3.2}],
 "stiffness": {"kind": "polynomial", "coefficients_N": [4.139, 0.606, 916.6, -6639, 32939, -34412]}}
J
expect 0 simulate six.json --protocol static --depth-mm 4 --rate-mm-s 1 --sample-Hz 50 --air-s 1 --noise-N 1e-5 --seed 3 --out six_static.csv
expect 0 simulate six.json --protocol ramp_hold --depth-mm 3.9 --hold-s 3 --sample-Hz 50 --air-s 1 --noise-N 1e-5 --seed 4 --out six_hold.csv
expect 0 characterize six_static.csv six_hold.csv --out six_found.json
grep -q '"polynomial", "coefficients_N": \[\([^],]*,\)\{5\}[^],]*\]' six_found.json || fail "no polynomial of six coefficients: $(cat six_found.json)"
grep -q '^    0.05 ' out || fail "no plain polynomial: $(tail -n 5 out)"
done_testing
