#!/bin/sh
# import_formats.sh: files after the layouts of vendors, and real ones of other instruments, without a hint. check: once
. tests/cli/common
FORMATS=$ROOT/tests/data/import MEASURED=$ROOT/data/measured

key() { sed -n "s/^# $2: //p" "$1"; }

# ---- one press in the dress of each vendor: 1 s at rest, 5 mm at 0.5 mm/s, F = 0.2 d + 0.05 d^2 on the way ----
expect 0 import "$FORMATS"/* --specimen-height-mm 24 --out formats
[ "$(ls formats | wc -l)" -eq 12 ] || fail "formats: $(ls formats)"
for run in formats/*.csv; do
    rows=$(case $run in *dup*) echo 200 ;; *nan*) echo 399 ;; *) echo 400 ;; esac)
    # Half of the last digit of the file, in mm and N; of its times where they are in minutes.
    digit=$(case $run in *testxpert* | *sci_comma*) echo 5e-5 ;; *ta_q800*) echo 2e-5 ;; *) echo 5e-6 ;; esac)
    grep '^[0-9]' "$run" | awk -F, -v d="$digit" -v rows="$rows" '
        function off(what, got, want, by) { if ((got - want) ^ 2 > (by + 1e-9) ^ 2) { print what " at " $1 " s: " got ", not " want; bad = 1 } }
        NR == 1 { t0 = $1 }
        { t = $1 - t0 - 1; depth = t < 0 ? 0 : t < 10 ? t / 2 : 5; off("depth", $2, depth, d + d) }
        t <= 10 { off("force", $3, 0.2 * depth + 0.05 * depth * depth, 2 * d) }
        END { if (NR != rows) { print NR " rows, not " rows; bad = 1 }; exit bad }' >why || fail "$run: $(head -n 3 why)"
done
grep -q "nan: left out 1 of 400 rows that are not numbers, the first at line 39" err || fail "nan: nothing about the row"
grep -q "dup: left out 200 of 400 rows whose time does not increase" err || fail "dup: nothing about the rows"
for strict in nan dup; do
    expect 1 import "$FORMATS/$strict.csv" --strict --specimen-height-mm 24 --out strict
done
expect 0 import "$FORMATS/bluehill.csv" --out sized   # the file has a length and a diameter
[ "$(key sized/bluehill.csv specimen.height_mm)" = 24.0 ] && [ "$(key sized/bluehill.csv specimen.radius_mm)" = 12.0 ] ||
    fail "bluehill: specimen"
expect 0 import "$FORMATS/thousands.csv" --from 2 --to 3 --specimen-height-mm 24 --specimen-name "gel 3" --out cropped
[ "$(grep -c '^[0-9]' cropped/thousands.csv)" -eq 11 ] && [ "$(key cropped/thousands.csv specimen.name)" = '"gel 3"' ] || fail "crop or name"

# ---- an AFM's approach and retract: one run, contact where the force leaves the noise (by eye at 57.50 um, to 0.05) ----
expect 0 import "$MEASURED/afm/AFM_contact_test.txt" --specimen-height-mm 0.05 --out real
A=real/AFM_contact_test.csv
[ "$(grep -c '^[0-9]' $A)" -eq 500 ] || fail "afm: $(grep -c '^[0-9]' $A) samples"
[ "$(key $A import.units)" = '"s, m, N"' ] && [ "$(key $A contact.rule)" = '"free_air"' ] || fail "afm: units or contact"
near "afm: contact" "$(key $A contact.depth_mm)" -0.0575 0 5e-5
grep '^[0-9]' $A | awk -F, '$3 > top { top = $3; depth = $2 } END { exit !(top > 2.46e-6 && top < 2.5e-6 && depth > 1.29e-3 && depth < 1.39e-3) }' ||
    fail "afm: the largest force is not 2.48e-6 N at 1.34 um"

# ---- stretch and stress of a muscle; only the units and the size are not in the file ----
expect 0 import "$MEASURED"/titin/*.csv --units depth=stretch,force=kPa --specimen-height-mm 2 --specimen-area-mm2 0.5 --out real
T=real/AvgRelaxed_1s.csv
near "titin: depth" "$(grep '^[0-9]' $T | awk -F, 'NR == 1 { a = $2 } NR == 4 { printf "%.12f", $2 - a }')" 0.071273684210526 1e-9  # 2 (0.985357 - 0.949720)
near "titin: force" "$(grep '^[0-9]' $T | awk -F, 'NR == 4 { print $3 }')" 2.02211866478717e-4 1e-12                # 0.404424 kPa on 0.5 mm2
expect 1 import $MEASURED/titin/AvgRelaxed_1s.csv --specimen-height-mm 2 --out none; says 'give it by --units depth='

expect 0 import "$MEASURED"/ecoflex/*.csv "$MEASURED"/mach1/*.csv --specimen-height-mm 30 --out real

# ---- numbers keep their precision, whatever their size ----
for scale in 1e-12 1e-9 1 1e5; do
    awk -v s=$scale 'BEGIN { print "Time (s);Position (mm);Force (N)"
        for (k = 0; k < 60; k++) printf "%.2f;%.6e;%.6e\n", k / 10, k < 10 ? 0 : (k - 9) / 50, k < 10 ? 0 : s * (k - 9) * 1.234567 }' >scale.csv
    expect 0 import scale.csv --specimen-height-mm 10 --out scale --force
    sed 1d scale.csv | tr ';' ',' >wanted
    grep '^[0-9]' scale/scale.csv | paste -d, wanted - | awk -F, '{ for (j = 1; j <= 3; j++) if ($j - $(j + 3) > 1e-14 * $j || $(j + 3) - $j > 1e-14 * $j) { print; exit 1 } }' ||
        fail "scale $scale: digits lost"
done

# ---- the folders as they are, with their licences: what is no table is left out, unless it is named or --strict ----
for set in afm mach1 ecoflex; do
    expect 0 import "$MEASURED/$set" --specimen-height-mm 30 --out "whole_$set"
    [ "$(ls "whole_$set" | wc -l)" -ge "$(ls "$MEASURED/$set" | grep -vc LICENSE)" ] || fail "$set: $(ls "whole_$set" | wc -l) runs"
    [ "$(grep -c 'LICENSE.*: left out, as it has no table' err)" -eq 1 ] || fail "$set: nothing about the licence"
done
expect 1 import "$MEASURED/afm" --strict --specimen-height-mm 30 --out strict_afm
expect 1 import "$MEASURED"/afm/LICENSE.txt --specimen-height-mm 30 --out strict_afm; says "no row of numbers"
mkdir pictures && printf '\211PNG\r\n\032\n\0\0\0\015' >pictures/photo.png && cp "$FORMATS/ms.csv" pictures
expect 0 import pictures --specimen-height-mm 24 --out pictured
[ "$(ls pictured)" = ms.csv ] || fail "a picture in the folder: $(ls pictured)"

# ---- a folder is a session, in the order of the times in its files ----
mkdir folder
for i in 1 2 3; do
    { echo "Test date: 2024-03-01"; echo "Start time: 10:$((40 - 10 * i)):00"; cat "$FORMATS/sci_comma.csv"; } >folder/run$i.csv
done
expect 0 import folder --specimen-height-mm 24 --out session
[ "$(key session/run3.csv session.start_s)" = 0.0 ] && [ "$(key session/run1.csv session.start_s)" = 1200.0 ] ||
    fail "session: $(key session/run3.csv session.start_s), $(key session/run1.csv session.start_s)"
[ "$(sed -n '2,4s/ .*//p' err | tr '\n' ' ')" = "run3 run2 run1 " ] || fail "session: order"
expect 0 import folder --specimen-height-mm 24 --session-start 2024-03-01T10:00:00 --out session --force
[ "$(key session/run1.csv session.start_s)" = 1800.0 ] || fail "--session-start: $(key session/run1.csv session.start_s)"
expect 1 import folder --specimen-height-mm 24 --session-start 10:20:00 --out session --force; says "began 600 s before"
done_testing
