#!/bin/sh
# import.sh: other testers' files: signs, units, contact, what is kept, what is refused. check: asan
. tests/cli/common
MEASURED=$ROOT/data/measured

# key FILE KEY: its value in the header.
key() { sed -n "s/^# $2: //p" "$1"; }
# column FILE N: numbers of a column.
column() { grep '^[-0-9]' "$1" | cut -d, -f"$2"; }

# ---- Mach-1 recordings: contact from the approach, a force that presses negatively ----
expect 0 import "$MEASURED"/mach1/*.csv --specimen-height-mm 2 --license MIT --out runs
[ "$(ls runs | wc -l)" -eq 10 ] && [ "$(wc -l <err)" -eq 11 ] || fail "mach1: not ten experiments, a line each in a table"
for i in 02:01 05:04 08:07; do
    run=runs/hayes_${i%:*}_StressRelaxation.csv approach=runs/hayes_${i#*:}_FindContact.csv
    [ "$(key $run contact.from)" = "\"hayes_${i#*:}_FindContact\"" ] || fail "$run: contact.from $(key $run contact.from)"
    [ "$(key $run contact.depth_mm)" = "$(key $approach contact.depth_mm)" ] || fail "$run: another contact than its approach"
    [ "$(key $run protocol.kind)" = '"ramp_hold"' ] && [ "$(key $run import.license)" = '"MIT"' ] || fail "$run: header"
    # Found by eye in the raw files, where the running mean lifts off: -2.804, -3.107, -2.583, to 0.004 mm.
    eye=$(case $i in 02*) echo -2.804 ;; 05*) echo -3.107 ;; *) echo -2.583 ;; esac)
    near "$run: contact" "$(key $run contact.depth_mm)" $eye 0 0.004
    # The travel asked for, from the depth at which the hold's preload left it.
    near "$run: travel" "$(column $run 2 | awk 'NR == 1 { a = $1 } END { print $1 - a }')" "$(key $run protocol.depth_mm)" 0 2e-4
    # The approach stops at 0.01 gf = 9.8e-5 N, drift included.
    near "$run: preload" "$(column $run 3 | head -n 1)" 9e-5 0 3e-5
done
for i in 00 03 06; do
    [ "$(key runs/hayes_${i}_FindContact.csv contact.rule)" = '"not_reached"' ] || fail "hayes_$i: contact.rule"
done
S=runs/static_00_StressRelaxation.csv
[ "$(key $S import.force_sign)" = -1.0 ] && [ "$(key $S contact.rule)" = '"ramp_start"' ] || fail "static_00: sign or rule"
[ "$(key $S protocol.kind)" = '"other"' ] && [ "$(key $S protocol.ramps)" = 3.0 ] || fail "static_00: protocol"
near "static_00: depth at the end" "$(column $S 2 | tail -n 1)" 0.1179 0 1e-4   # three times 0.0393
near "static_00: force at the end" "$(column $S 3 | tail -n 1)" 0.2655 0 1e-3   # 0.5154 less the 0.2500 at the start
expect 1 import "$MEASURED"/mach1/hayes_02_StressRelaxation.csv --out none; says "give --specimen-height-mm"
[ -e none ] && fail "made a folder for nothing"
expect 0 import "$MEASURED"/mach1/hayes_02_StressRelaxation.csv --specimen-height-mm 2 --out alone
[ "$(key alone/hayes_02_StressRelaxation.csv contact.rule)" = '"ramp_start"' ] || fail "without its approach: contact.rule"

# ---- Instron ----
expect 0 import "$MEASURED"/ecoflex/*.csv --out runs
E=runs/EF10_0T_A2.csv
[ "$(key $E specimen.height_mm)" = 30.0 ] && [ "$(key $E specimen.radius_mm)" = 25.0 ] || fail "instron: specimen"
near "instron: rate" "$(key $E protocol.rate_mm_s)" 0.16666666666666666 1e-15
[ "$(key $E contact.rule)" = '"as_recorded"' ] && [ "$(key $E tester.Machine)" = '"INSTRON 5900"' ] || fail "instron: header"
sed 1,8d "$MEASURED"/ecoflex/EF10_0T_A2.csv | cut -d, -f1-3 >wanted
grep '^[0-9]' $E | paste -d, wanted - | awk -F, '{ for (j = 1; j <= 3; j++) if (($j - $(j + 3)) ^ 2 > 1e-24) exit 1; n++ } END { exit n != 1201 && n != 1202 }' ||
    fail "instron: other numbers than in the file"
grep -q '^time_s,depth_mm,force_N,Engineering Strain \[-\],' $E || fail "instron: the other columns are not kept"
if command -v python3 >/dev/null; then
    crc=$(python3 -c 'import sys, zlib; print("%08x" % zlib.crc32(open(sys.argv[1], "rb").read()))' "$MEASURED"/ecoflex/EF10_0T_A2.csv)
    [ "$(key $E import.crc32)" = "\"$crc\"" ] || fail "crc32 $(key $E import.crc32), not $crc"
fi

# ---- the Mach-1's own file ----
mach1() { # a function's block: name, settings, rows (time, position, force by awk's f and z of the sample k)
    printf '<INFO>\nTime:\t10:11:12\n<END INFO>\n<%s>\nStage Axis:\tPosition (z)\nLoad Cell Axis:\tFz\n%b<DATA>\n' "$1" "$2"
    printf 'Time, s\tPosition (z), mm\tPosition (x), mm\tFx, gf\tFz, gf\n'
    awk "BEGIN { for (k = 0; k < $3; k++) { t = k / 100; $4; printf \"%.2f\\t%.4f\\t1.5\\t0.1\\t%.5f\\n\", t, z, f; $5 } }"
    echo '<END DATA>'
}
{
    echo '<Mach-1 File>'
    mach1 "Zero Load" "" 50 "z = 1; f = 0" ""
    # 1 mm of air at 0.5 mm/s, the load cell alternating by 0.001 gf and drifting by 0.002 gf/s; contact at 2.000 mm, 1 gf/mm,
    # resting at 2.045 mm
    mach1 "Find Contact" "Contact Criteria, gf:\t0.0200\n" 230 \
        "z = 1 + 0.5 * t; if (z > 2.045) z = 2.045; f = 0.002 * t + 0.001 * (k % 2) + (z > 2 ? z - 2 : 0)" ""
    mach1 "Stress Relaxation" "Amplitude, mm:\t0.5\nVelocity, mm/s:\t0.5\nNumber of Ramp:\t1\nFixed Relaxation Time, s:\t8\n" 1000 \
        "s = t < 1 ? 0 : t < 2 ? t - 1 : 1; z = 2.045 + 0.5 * s; f = 0.5 * s" \
        'if (k == 499) print "<divider>"'
} | sed 's/$/\r/' >own.txt
expect 0 import own.txt --specimen-height-mm 5 --out own
[ "$(ls own | tr '\n' ' ')" = "own_01_FindContact.csv own_02_StressRelaxation.csv " ] || fail "own: $(ls own)"
grep -q "block Zero Load left out: the stage does not move" err || fail "own: nothing about the block left out"
near "own: contact" "$(key own/own_02_StressRelaxation.csv contact.depth_mm)" 2 0 0.025 # half the window of 11 samples
O=own/own_02_StressRelaxation.csv
[ "$(column $O 1 | wc -l)" -eq 1000 ] || fail "own: $(column $O 1 | wc -l) samples"
near "own: depth at the end" "$(column $O 2 | tail -n 1)" 0.545 0 0.025
near "own: force at the end" "$(column $O 3 | tail -n 1)" 0.005344624 0 1e-4  # (0.5 + 0.045) gf
[ "$(key $O protocol.hold_s)" = 8.0 ] && [ "$(key $O import.units)" = '"s, mm, gf"' ] || fail "own: header"
grep -q '^time_s,depth_mm,force_N,Position (x) mm,Fx gf$' $O || fail "own: other columns"

# ---- any CSV: the same press in five dresses gives the same numbers ----
# 0.5 s at rest, 4 mm in 1 s, 3 s hold; F = 0.5 N/mm, relaxing to half.
press='for (k = 0; k <= 450; k++) { t = k / 100; d = t < 0.5 ? 0 : t < 1.5 ? 4 * (t - 0.5) : 4
    f = 0.5 * d; if (t > 1.5) f = 1 + exp(-(t - 1.5))'
awk "BEGIN { print \"Time (s),Depth (mm),Force (N)\"; $press; printf \"%.2f,%.3f,%.6f\\n\", t, d, f } }" >plain.csv
awk "BEGIN { print \"made in a lab\\n\\nZeit;Weg;Kraft\\n(ms);(um);(gf)\"; $press; s = sprintf(\"%.1f;%.1f;%.9f\", 1000 * t, -1000 * d + 7000, -f / 9.80665e-3)
    gsub(/\\./, \",\", s); print s } }" >german.csv
awk "BEGIN { $press; printf \"%.2f\\t%.9f\\tok\\t%.9f\\n\", t, -d / 25.4, f / 4.4482216152605 } }" >bare.txt
awk "BEGIN { print \"Time,Extension,Load\\n(min),(m),(mN)\"; $press; printf \"\\\"%.9f\\\",\\\"%.6f\\\",\\\"%.3f\\\"\\n\", t / 60, d / 1000, 1000 * f } }" >quoted.csv
expect 0 import plain.csv quoted.csv --specimen-height-mm 24 --specimen-radius-mm 12 --out csv
[ "$(key csv/plain.csv protocol.kind)" = '"ramp_hold"' ] || fail "plain: $(key csv/plain.csv protocol.kind)"
[ "$(key csv/plain.csv specimen.kind)" = '"cylinder"' ] || fail "plain: kind"
expect 0 import german.csv --map time=Zeit\ \(ms\),depth=2,force=3 --specimen-height-mm 24 --out csv
grep -q "^german .*2 Weg, um, reversed .*3 Kraft, gf, reversed" err || fail "german: $(cat err)"
expect 0 import bare.txt --map time=1,depth=2,force=4 --units time=s,depth=in,force=lbf --specimen-height-mm 24 --protocol other --out csv
[ "$(key csv/bare.csv protocol.kind)" = '"other"' ] && [ "$(key csv/bare.csv import.depth_sign)" = -1.0 ] || fail "bare: header"
grep '^[0-9]' csv/plain.csv >a
[ "$(wc -l <a)" -eq 451 ] || fail "plain: $(wc -l <a) rows"
for other in quoted german bare; do
    grep '^[0-9]' csv/$other.csv | paste -d, a - | awk -F, '{ for (j = 1; j <= 3; j++) { d = $j - $(j + 3); if (d * d > 1e-12) { print; exit 1 } } }' ||
        fail "$other differs from plain"
done
near "plain: last force" "$(tail -n 1 a | cut -d, -f3)" 1.049787 1e-6  # 1 + exp(-3)
expect 0 import plain.csv --negate depth --specimen-height-mm 24 --out negated
grep -q "warning: plain.csv: with --negate depth the force falls" err || fail "--negate depth: no warning"
[ "$(tail -n 1 negated/plain.csv | cut -d, -f2)" = -4 ] || fail "--negate depth"
expect 0 import plain.csv --negate none --contact recorded --specimen-height-mm 24 --out kept
[ "$(key kept/plain.csv import.sign_rule)" = '"as asked for"' ] || fail "--negate none"

# ---- free air: a simulated press at another zero, in another place ----
expect 0 simulate $DATA/lumped_n2.json --protocol ramp_hold --depth-mm 5 --hold-s 5 --sample-Hz 1000 --air-s 1 --noise-N 0.004 --out sim.csv
awk -F, '/^[0-9]/ { printf "%s,%.6f,%.6f\n", $1, 30 - $2, -$3 - 0.25 } /^t/ { print "t (s),position_mm,load_N" }' sim.csv |
    sed 's/^t (s)/time_s/' >air.csv
expect 0 import air.csv --specimen-height-mm 24 --out air
[ "$(key air/air.csv contact.rule)" = '"free_air"' ] || fail "air: $(key air/air.csv contact.rule)"
near "air: contact" "$(key air/air.csv contact.depth_mm)" -30 0 0.1
near "air: zero" "$(key air/air.csv contact.zero_N)" 0.25 0 6e-4  # 4 sd of the mean of 1000
expect 0 import air.csv --specimen-kind none --contact start --out air --force

# ---- refused, with the line ----
refused() { # text, arguments...
    text=$1; shift
    rm -rf refused
    expect 1 import "$@" --specimen-height-mm 24 --out refused; says "$text"
    [ -e refused ] && fail "import $*: left $(ls refused)"
}
: >empty.csv; refused "empty.csv: the file is empty" empty.csv
refused "No such file" missing.csv
sed '5s/,[^,]*$/,x/' plain.csv >bad.csv; refused "bad.csv:5: the force (column 3) is not a number" bad.csv --strict
refused "bad.csv:5:" plain.csv bad.csv --strict
sed '9s/,.*//' plain.csv >bad.csv; refused "bad.csv:9: the depth (column 2) is not a number" bad.csv --strict
sed '7s/^[^,]*/nan/' plain.csv >bad.csv; refused "bad.csv:7: the time" bad.csv --strict
sed '20p' plain.csv >bad.csv; refused "bad.csv:21: time does not increase" bad.csv --strict
sed '2s/,[^,]*$/,/' plain.csv >bad.csv; refused "bad.csv:2: the force" bad.csv --strict
sed '1s/ (mm)//' plain.csv >bad.csv; refused 'column "Depth" has no unit; give it by --units depth=mm' bad.csv
sed '1s/Depth/Position/; 1s/Time (s)/Travel (Hz)/' plain.csv >bad.csv; refused "no column looks like a time by its name" bad.csv
sed '1s/Force (N)/Displacement (mm)/' plain.csv >bad.csv; refused 'of 1 "Time (s)", 2 "Depth (mm)", 3 "Displacement (mm)"' bad.csv
awk -F, 'NR == 1 { print $1 ",Position (mm),Displacement (mm)," $3; next } { print $1 "," $2 "," $2 * $2 "," $3 }' plain.csv >bad.csv
refused 'columns 2 "Position (mm)" and 3 "Displacement (mm)" could both be the depth' bad.csv
refused 'no column "4" for --map depth; give a name (without commas) or number of 1 "Time (s)", 2' plain.csv --map depth=4
refused "no row of numbers" plain.csv --separator ';'
refused "not a Mach-1 file" plain.csv --format mach1
refused "is already an experiment of palpate" csv/plain.csv
awk -F, 'NR == 1 { print; next } { print $1 ",5," $3 }' plain.csv >bad.csv; refused "nothing was pressed" bad.csv
sed '1s/mm/m/' plain.csv >bad.csv; refused "exceeds the specimen's height of 24 mm" bad.csv
head -n 3 plain.csv >bad.csv; refused "fewer than three rows" bad.csv
sed '$d' own.txt >cut.txt; expect 0 import cut.txt --specimen-height-mm 24 --out cut
grep -q 'cut.txt:[0-9]*: the file ends before <END DATA>' err || fail "a block that is cut: $(cat err)"
expect 0 import own.txt --specimen-height-mm 24 --out whole
for run in cut/*.csv; do
    sed '/^#/d' "whole/own${run#cut/cut}" >whole.rows && sed '/^#/d' "$run" | cmp -s - whole.rows || fail "$run: other rows than the whole file has"
done
head -c 3000 "$PALPATE" >bad.csv; refused "not a text file" bad.csv

# ---- wrong usage ----
wrong() { # text, arguments...
    text=$1; shift
    expect 2 import "$@"; says "$text"
}
wrong "name a FILE" --out x
wrong "name the folder of the experiments by --out" plain.csv
wrong "--negate must be" plain.csv --out x --negate up
wrong "--map must be" plain.csv --out x --map zeit=1
wrong "--units must be" plain.csv --out x --units depth
wrong "not a unit of this quantity" plain.csv --out x --units depth=furlong
mkdir -p sub; cp plain.csv sub
wrong "would both become plain.csv" plain.csv sub/plain.csv --specimen-height-mm 24 --out x
expect 1 import plain.csv --specimen-height-mm 24 --out .; says "plain.csv: is an input"
[ -e x ] && fail "wrong usage made a folder"
done_testing
