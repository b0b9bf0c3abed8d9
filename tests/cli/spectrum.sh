#!/bin/sh
# spectrum.sh: storage and loss against frequency of a sweep on the virtual indenter, and one spectrum for its dwell and its sweep. check: once
. tests/cli/common

rig="--port rig --firmware host --specimen-height-mm 24 --specimen-radius-mm 12 --json"
expect 0 acquire $rig --sweep --depth-mm 3 --from-Hz 0.2 --to-Hz 8 --sweep-s 25 --out sweep
expect 0 acquire $rig --ramp-hold 3 --hold-s 80 --out dwell

# value KEY FILE: of the first one; all KEY FILE: each
all() { awk -v k="\"$1\":" '$1 == k { sub(",", "", $2); print $2 }' "$2"; }
estimate() { awk -v n="\"$1\"," -v k="\"$3\":" '/"correlation"/ { exit } $2 == n { on = 1 } on && $1 == k { sub(",", "", $2); print $2; exit }' "$2"; }

# Each alone tells the phantom's arms (data/sedef2008/lumped_n2.json), with nothing left but noise, and their intervals meet.
for run in sweep/sweep_3mm dwell/ramp_hold_3mm; do
    expect 0 characterize $run.csv --arms 2 --degree 3 --json --spectrum ${run%%/*}.csv && mv out ${run%%/*}.json
    near "rms over noise of $run" "$(all rms_noise ${run%%/*}.json | head -n 1)" 1 0.05
    for k in 1 2; do
        set -- 2.5847711 3.6146 && [ $k = 1 ] || set -- 0.6853036 23.964533
        near "K$k of $run" "$(estimate K_$k ${run%%/*}.json value)" $1 0.05
        share=0.08
        # A sweep of 25 s sees little of the arm of 35 s: by its noise and its contact, another in each session by some micrometres, b_2
        # varies by 2.5 % (standard deviation of ten sessions). Six of these.
        [ "$run b_$k" != "sweep/sweep_3mm b_2" ] || share=0.15
        near "b$k of $run" "$(estimate b_$k ${run%%/*}.json value)" $2 $share
    done
done
grep -q '"spectrum": \[\]' dwell.json || fail "a dwell has a spectrum"

# Together: one law and two arms, and the model's storage and loss are the sweep's. Each session of the device finds its
# contact anew, to some micrometres: where that is more than the noise lets pass, each run has a contact of its own.
expect 0 characterize sweep/sweep_3mm.csv dwell/ramp_hold_3mm.csv --arms 2 --degree 3 --json && mv out both.json
for rms in $(all rms_noise both.json | head -n 2); do near "rms over noise, together" $rms 1 0.05; done
[ "$(all storage_N_m both.json | wc -l)" -ge 8 ] || fail "a spectrum of $(all storage_N_m both.json | wc -l) points"
all frequency_Hz both.json >f
for what in storage loss; do
    all ${what}_N_m both.json >measured && all ${what}_low_N_m both.json >low && all model_${what}_N_m both.json >model
    paste f measured low model | awk -v what=$what '
        { z = ($2 - $4) / ($2 - $3); sum += z * z; if (z > 3 || z < -3) { print what " at " $1 " Hz: " $2 " for " $4; bad = 1 } }
        END { exit bad || sum > 2 * NR }' || fail "$what of the model is not the measured one"
done

# Arms at fixed times, and a fractional solid.
expect 0 characterize dwell/ramp_hold_3mm.csv --arms log:2 --degree 2 --json
sed '/"estimates"/q' out >model
all tau_s model | awk 'NR > 1 { s = 2 * log($1 / last) / log(10); d = s - int(s + 0.5); if (d > 1e-6 || d < -1e-6) exit 1 } { last = $1 }' ||
    fail "times are not two a decade: $(all tau_s model | tr '\n' ' ')"
expect 0 characterize dwell/ramp_hold_3mm.csv --arms fractional --degree 2 --json --out fractional.json
exponent=$(estimate exponent out value)
awk -v a="$exponent" 'BEGIN { exit !(a > 0.1 && a < 0.9) }' || fail "the exponent is $exponent"
expect 0 simulate fractional.json --protocol ramp_hold --depth-mm 3 --hold-s 10 --out again.csv
# The element stands in the model file beside its spectrum, and is checked when it is read.
near "exponent in the file" "$(sed -n 's/.*"exponent": \([0-9.e-]*\)}.*/\1/p' fractional.json)" "$exponent" 1e-12
sed 's/"exponent": [0-9.e-]*/"exponent": 1.5/' fractional.json >wrong.json
expect 1 simulate wrong.json --protocol ramp_hold --depth-mm 3 --hold-s 10; says "an exponent between 0 and 1"
expect 0 simulate fractional.json --protocol static --depth-mm 3 --sample-Hz 20 --out ramp.csv
expect 1 characterize ramp.csv --arms fractional; grep -q 'not ramps alone' err || fail "$(tail -n 1 err)"

# As CSV: what was measured, as the JSON has it, and the model's curve through it; of a dwell the model's curve alone.
grep '^sweep_3mm.csv,' sweep.csv | cut -d, -f2,4,7 | tr ',' ' ' >measured
all frequency_Hz sweep.json >f && all storage_N_m sweep.json >storage && all loss_N_m sweep.json >loss
paste -d' ' measured f storage loss | awk '{ for (j = 1; j <= 3; j++) { d = ($j - $(j + 3)) / $j; if (d > 1e-8 || d < -1e-8) bad = 1 } } END { exit bad || NR < 8 }' || fail "--spectrum is not the JSON's"
[ "$(grep -c '^model,' dwell.csv)" -ge 15 ] && [ "$(grep -c . dwell.csv)" -eq $(($(grep -c '^model,' dwell.csv) + 1)) ] || fail "the spectrum of a dwell: $(wc -l <dwell.csv) rows"
# Of two Maxwell arms on a spring K: K'' = sum K w t / (1 + w w t t), per depth and by the height.
awk -F, '/^model,/ { w = 6.283185307 * $2; l = 0; for (j = 0; j < 2; j++) { k = j ? 0.6853036 : 2.5847711; t = (j ? 23.964533 : 3.6146) / k; l += k * w * t / (1 + w * w * t * t) }
    d = $7 / (l / 0.024) - 1; if (d > 0.05 || d < -0.05) { print $2, $7, l / 0.024; bad = 1 } } END { exit bad }' dwell.csv >why || fail "loss of the model: $(head -n 1 why)"

expect 2 characterize dwell/ramp_hold_3mm.csv --arms log:0
expect 2 characterize dwell/ramp_hold_3mm.csv --arms fraction
expect 1 characterize dwell/ramp_hold_3mm.csv --arms log:12 --degree 2
grep -q '12 arms a decade' err || fail "too many arms: $(cat err)"
done_testing
