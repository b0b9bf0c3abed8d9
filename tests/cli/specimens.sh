#!/bin/sh
# specimens.sh: runs of several specimens of other heights and areas give their mean and how they differ. check: once
. tests/cli/common

# Specimen K of stress factor F and relaxation time T, of height H and radius R mm, pressed to two strains.
specimen() {
    awk -v f=$2 -v t=$3 -v h=$4 -v r=$5 'BEGIN { a = r * r / 144 * f
        printf "{\"palpate\": {\"model\": 1}, \"kind\": \"lumped\", \"specimen\": {\"height_mm\": %g, \"radius_mm\": %g},\n", h, r
        printf "\"stiffness\": {\"kind\": \"polynomial\", \"coefficients_N\": [%.9g, %.9g, %.9g]},\n", 8 * a, -6 * a, 80 * a
        printf "\"arms\": [{\"stiffness_N\": %.9g, \"viscosity_Ns\": %.9g}]}\n", 2.4 * a, 2.4 * a * t }' >model$1.json
    for strain in 0.15 0.28; do
        expect 0 simulate model$1.json --protocol ramp_hold --depth-mm $(awk "BEGIN { print $strain * $4 }") --ramp-s 1.5 --hold-s 20 \
            --sample-Hz 25 --air-s 1 --noise-N 0.01 --seed $1 --out bare.csv
        mkdir -p folder$1
        sed "1a # specimen.name: \"liver $1\"" bare.csv >folder$1/run_$strain.csv
    done
}
specimen 1 1.00 2.0 20 10
specimen 2 1.25 1.6 24 12
specimen 3 0.80 2.6 22 13
specimen 4 1.10 2.1 28 14
specimen 5 0.90 1.9 30 11

# at KEY: of K_inf at the largest strain measured
at() { awk -v k="\"$1\":" '/"stiffness": \[/ { on = 1 } on && $1 == k { sub(",", "", $2); v = $2 } on && /^    \]/ { exit } END { print v }' json; }

expect 0 characterize folder?/*.csv --arms 1 --law polynomial --degree 3 --out mean.json --result result.json --json
cp out json
grep -q '"count": 5' json || fail "not five specimens"
grep -q '"differ": true' json || fail "they do not differ"
grep -q '"specimens": {"count": 5, "between": \[' mean.json || fail "no spread in the model"
grep -q '"kind": "polynomial"' mean.json || fail "no polynomial"
# In stress: K of the mean area 145.2 mm2 pi (144 at 1). The factors' logarithms have the mean of 0.998 and the sd 0.173.
near "mean K at 0.28" "$(at stiffness_N)" "$(awk 'BEGIN { print 0.998 * 146 / 144 * (8 - 6 * 0.28 + 80 * 0.28 ^ 2) }')" 0.01
near "spread of K" "$(awk "BEGIN { print $(at between_sd_N) / $(at stiffness_N) }")" 0.173 0.03
expect 0 characterize folder?/*.csv --arms 1 --law polynomial --degree 3 --specimens folder
grep -q 'Specimens: 5' out || fail "not by folder"
expect 0 report result.json mean.json --out page.html
in_page page.html
[ "$(grep -c '"specimen_high_N"' shown)" -eq 41 ] || fail "the page has no specimens"

# The band is that of a specimen not measured: wider than that of the mean, and it holds each of those measured.
expect 0 simulate mean.json --protocol ramp_hold --depth-mm 5 --ramp-s 1 --hold-s 20 --band --out band.csv
for factor in 0.80 1.25; do
    awk -F, -v f=$factor '/^[0-9]/ && $1 > 0.5 { if ($3 * f / 1.01 < $4 || $3 * f / 1.01 > $5) bad++ } END { exit bad > 0 }' band.csv || fail "factor $factor is not in the band"
done
awk -F, '/^[0-9]/ && $1 > 0.5 { w = ($5 - $4) / 2 / $3; if (w < 0.3 || w > 0.9) bad++ } END { exit bad > 0 }' band.csv || fail "width of the band"

# A model that says how its specimens differ, but not how well their mean is known, has a band of that alone: a little narrower.
sed '/"covariance": \[/,/\]\],$/d' mean.json >spread.json
expect 0 simulate spread.json --like band.csv --band --out spread.csv; says 'the band shows how specimens differ, but not'
grep '^[0-9]' band.csv >a; grep '^[0-9]' spread.csv >b
paste -d, a b | awk -F, '$1 > 0.5 { w = ($10 - $9) / ($5 - $4); if (w < 0.8 || w > 0.99 || $3 - $8 > 1e-9 || $8 - $3 > 1e-9) bad++; n++ } END { exit !(n > 20 && !bad) }' || fail "the band of the spread alone"

# A network calibrated to the mean knows as much: its band is that of the lumped model.
expect 0 calibrate mean.json --nodes 3 --depth-mm 3,6 --hold-s 20 --steps 1000 --out network.json
grep -q '"specimens": {"count": 5' network.json || fail "the network does not know the specimens"
expect 0 simulate network.json --like band.csv --band --out network_band.csv
grep '^[0-9]' band.csv >a; grep '^[0-9]' network_band.csv >b
paste -d, a b | awk -F, '$1 > 0.5 { w = ($10 - $9) / ($5 - $4); if (w < 0.9 || w > 1.1) bad++; n++ } END { exit !(n > 20 && !bad) }' || fail "the network's band"

# The same specimen five times over is one.
for k in 1 2 3; do
    mkdir -p same$k
    expect 0 simulate model1.json --protocol ramp_hold --depth-mm 5 --ramp-s 1 --hold-s 20 --sample-Hz 25 --air-s 1 --noise-N 0.01 --seed 7$k --out same$k/run.csv
done
expect 0 characterize same?/run.csv --specimens file --arms 1 --law polynomial --degree 2 --out same.json
grep -q 'no significant difference between the' err || fail "same specimens: $(tail -n 1 err)"
grep -q specimens same.json && fail "a spread of specimens that are the same"
done_testing
