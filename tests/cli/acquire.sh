#!/bin/sh
# acquire.sh: sessions with the virtual indenter: what is recorded, what a fault, Ctrl-C or a dead host leaves behind.
. tests/cli/common

H="--port rig --firmware host"
fault() { sed -n 's/^# end.fault: \(.*[^ ]\) *$/\1/p' "$1"; }
rows() { grep -c '^[-0-9]' "$1"; }
header() { sed -n "s/^# $2: *\(.*[^ ]\) *\$/\1/p" "$1"; }
wrong() { # code, text, arguments...
    wanted=$1 text=$2; shift 2
    expect "$wanted" acquire "$@"
    says "$text"
}

# ---- usage ----
wrong 2 "name the device with --port" --static --depth-mm 3 --out x
wrong 2 "say what the plate does by one of" --port rig --out x
wrong 2 "say what the plate does by one of" --port rig --static --cycles 3 --depth-mm 3 --out x
wrong 2 "--static needs --depth-mm" --port rig --static --out x
wrong 2 "name the folder of the recordings" --port rig --ramp-hold 2
wrong 2 "--hold-s does not go with --static" --port rig --static --depth-mm 3 --hold-s 3 --out x
wrong 2 "say the same thing" --port rig --ramp-hold 3 --ramp-s 1 --rate-mm-s 3 --out x
wrong 2 "--noise-N needs --port rig" --port /dev/none --noise-N 0.1 --ramp-hold 3 --out x
wrong 2 "Give --specimen-height-mm" --port /dev/none --ramp-hold 3 --out x
wrong 2 "30 mm does not fit a specimen of 24 mm" $H --ramp-hold 3,30 --out x
wrong 1 "no.json" --port rig:no.json --ramp-hold 3 --out x
wrong 1 "/dev/none" --port /dev/none --specimen-height-mm 24 --ramp-hold 3 --out x
[ -z "$(ls x 2>/dev/null)" ] || fail "a session that failed at once left $(ls x)"

# ---- protocol files ----
protocol() { # line and text of the error, line 2 on of the file
    { echo '{"palpate": {"protocol": 1},'; printf '%b\n' "$2"; } >p.json
    wrong 1 "p.json:$1" $H --protocol p.json --out x
}
protocol '2: malformed JSON' ' "runs": [}'
protocol '2: hold_s must be a number from 0' ' "hold_s": -1, "runs": [{"kind": "static", "depth_mm": 1}]}'
protocol '2: speed_mm_s is not a known key' ' "speed_mm_s": 1, "runs": [{"kind": "static", "depth_mm": 1}]}'
protocol '1: needs "runs"' ' "runs": []}'
protocol '4: runs[1] needs "kind"' ' "runs": [\n{"kind": "static", "depth_mm": 1},\n{"kind": "sttic"}]}'
protocol '3: runs[0] needs depth_mm' ' "runs": [\n{"kind": "static"}]}'
protocol '5: runs[0].hold_s does not go with kind static' ' "runs": [\n{"kind": "static",\n "depth_mm": 1,\n "hold_s": 3}]}'
protocol '3: runs[0] has rate_mm_s and ramp_s' ' "runs": [\n{"kind": "ramp_hold", "depth_mm": 1, "rate_mm_s": 3, "ramp_s": 1}]}'
protocol '4: runs[0].segments[1].rate_mm_s must be a number above 0' \
    ' "runs": [{"kind": "segments", "segments": [\n{"hold_s": 3},\n{"move_to_mm": 1, "rate_mm_s": 0}]}]}'
protocol '3: runs[0].segments[0] needs cycles' ' "runs": [{"kind": "segments", "segments": [\n{"cycle_to_mm": 1, "rate_mm_s": 1}]}]}'
protocol '3: runs[0].name must be' ' "runs": [\n{"kind": "static", "depth_mm": 1, "name": "../x"}]}'
protocol '2: order must be' ' "order": "any", "runs": [{"kind": "static", "depth_mm": 1}]}'
echo '{"palpate": {"calibration": 1}, "Fz_N": [1, 2, 3]}' >c.json
wrong 1 "c.json:1: Fz_N must be a list of 6 numbers" $H --calibration c.json --ramp-hold 3 --out x

# ---- a session ----
"$PALPATE" rig --until-s 0.1 --firmware host >/dev/null 2>err || { cat err; echo "there is no host firmware"; exit 77; }
short="--air-s 0.5 --after-s 0.2 --rest-s 5"
expect 0 acquire $H $short --ramp-hold 2,4 --hold-s 5 --repeat-first --out runs --json
for f in ramp_hold_2mm ramp_hold_4mm ramp_hold_2mm_repeat; do
    [ "$(fault runs/$f.csv)" = null ] || fail "$f: end.fault $(fault runs/$f.csv)"
    [ "$(header runs/$f.csv end.lost_samples)" = 0 ] || fail "$f: lost samples"
    [ "$(rows runs/$f.csv)" -eq "$(header runs/$f.csv end.samples)" ] || fail "$f: rows"
    near "$f: tracking" "$(header runs/$f.csv end.error_rms_mm)" 0 0 0.01
done
near "contact" "$(value out below_home_mm)" 12 0 0.01
near "stiffness" "$(value out stiffness_N_m)" 470 0.05
[ "$(values out samples | wc -l)" -eq 3 ] || fail "not three runs in the summary"
grep -q '"fault": null$' out || fail "the summary tells of a fault"
[ "$(header runs/ramp_hold_2mm_repeat.csv protocol.order)" = 3 ] || fail "protocol.order"
[ "$(header runs/ramp_hold_2mm_repeat.csv protocol.repeat)" = 1 ] || fail "protocol.repeat"
# of the session: run 2 began when run 1 (7.8 s), the way out and the 5 s of rest were over
near "session.start_s" "$(header runs/ramp_hold_2mm.csv session.start_s)" 0 0
# (while the host is kept waiting the rig goes on, a hundred times as fast as the clock where nothing moves)
at_least() { awk -v a="$2" -v b="$3" 'BEGIN { exit !(a >= b && a < b + 3600) }' || fail "$1: $2, not $3 or, by a slow host, later"; }
second=$(header runs/ramp_hold_4mm.csv session.start_s)
at_least "session.start_s" "$second" 12.8
at_least "session.start_s" "$(header runs/ramp_hold_2mm_repeat.csv session.start_s)" "$(awk -v s="$second" 'BEGIN { print s + 12.5 }')"
# a ramp of 1 s from contact to 4 mm, held: depths at 0.5 s of air + 0.25 + half the ramp, and in the hold
awk -F, '$1 == "1.250" { ramp = $2 } $1 == "5.000" { hold = $2; force = $3 } END { print ramp, hold, force }' \
    runs/ramp_hold_4mm.csv >at
read -r ramp hold force <at
near "depth on the ramp" "$ramp" 2 0 0.03
near "depth in the hold" "$hold" 4 0 0.01
near "force in the hold" "$force" 1.6 0.05
expect 0 characterize runs/*.csv --arms 1 --degree 2 --json
[ "$(grep -c 'ramp and hold to' err)" -eq 3 ] || fail "characterize: $(cat err)"
grep -q "cut short" err && fail "characterize: a fault where there is none"
wrong 1 "is there already: name another --out, or give --force" $H --ramp-hold 4 --out runs
expect 0 acquire $H $short --static --depth-mm 2 --rate-mm-s 2 --raw --out runs --force
head -n 1 runs/static_2mm.csv | grep -q '^# palpate.experiment: 1$' || fail "first line"
grep -q '^time_s,depth_mm,force_N,error_mm,position_counts,adc_0,.*adc_5,duty,flags$' runs/static_2mm.csv || fail "--raw"
expect 0 acquire $H $short --cycles 2 --depth-mm 2 --rate-mm-s 4 --out runs --live
[ "$(grep -c '\*' err)" -ge 10 ] || fail "--live: no curve"
awk -F, '/^[-0-9]/ { if (up && $2 < 0.1) { n++; up = 0 } if ($2 > 1.9) up = 1 } END { exit n != 2 }' runs/cyclic_2mm.csv ||
    fail "not two cycles"
expect 0 acquire $H $short --sweep --depth-mm 3 --hold-s 1 --sweep-s 3 --from-Hz 1 --to-Hz 4 --out runs
near "sweep" "$(header runs/sweep_3mm.csv end.peak_N)" 1.3 0.1

# ---- the seed's protocol: 13 presses in another order, the first again, air before and after ----
expect 0 acquire $H --thesis-protocol --hold-s 0.5 --rest-s 1 --air-s 0.2 --after-s 0.1 --rate-mm-s 5 --out seed
[ "$(ls seed | wc -l)" -eq 16 ] || fail "seed: $(ls seed | wc -l) files"
[ "$(header seed/air_before.csv protocol.order)" = 1 ] && [ "$(header seed/air_after.csv protocol.order)" = 16 ] ||
    fail "seed: air"
[ "$(header seed/air_after.csv specimen.kind)" = '"none"' ] || fail "seed: specimen.kind of air"
first=$(grep -l '^# protocol.order: 2$' seed/*.csv)
[ "$(header "${first%.csv}_repeat.csv" protocol.order)" = 15 ] || fail "seed: the first is not repeated last"
[ "$(header seed/static_9.7mm.csv protocol.kind)" = '"static"' ] || fail "seed: static"
grep -l "end.fault: null" seed/*.csv | wc -l | grep -qx 16 || fail "seed: a fault"

# ---- what is no specimen's is recorded, and left out of its model ----
expect 0 acquire --port rig --specimen rigid --firmware host $short --static --depth-mm 0.05 --rate-mm-s 0.1 --specimen-height-mm 24 --out block
[ "$(header block/static_0.05mm.csv specimen.kind)" = '"rigid"' ] || fail "specimen.kind of a block"
expect 0 characterize runs/ramp_hold_4mm.csv --arms 1 --degree 2 --out alone.json
expect 0 characterize runs/ramp_hold_4mm.csv block/static_0.05mm.csv seed/air_before.csv --arms 1 --degree 2 --out beside.json
cmp alone.json beside.json || fail "characterize: what is no specimen's counts"
grep -qF 'block/static_0.05mm.csv: left out, as it has no specimen (specimen.kind is "rigid")' err || fail "characterize, a block: $(cat err)"
grep -qF 'seed/air_before.csv: left out, as it has no specimen (specimen.kind is "none")' err || fail "characterize, air: $(cat err)"
expect 1 characterize block/static_0.05mm.csv seed/air_before.csv
grep -q "no recording of a specimen among the 2 given" err || fail "characterize of nothing: $(cat err)"
expect 0 report runs/ramp_hold_4mm.csv seed/air_before.csv --out page.html
in_page page.html
python3 - <<'END' || fail "report of air: it is listed, and no recording of a specimen"
import json
run, = (r for r in json.load(open("shown"))["recordings"] if r["file"] == "seed/air_before.csv")
assert run == {"file": "seed/air_before.csv", "note": ""}, run
END

# ---- faults: exit code 4, one line of why and where, and the file up to there ----
for f in over_force over_travel over_temperature following_error sensor_silent sensor_saturated encoder_jump \
    host_timeout stream_overflow command_out_of_range watchdog_reset stack_guard emergency_stop; do
    until=
    [ $f != stream_overflow ] || until=-62 # or else it could not say so
    expect 4 acquire $H $short --ramp-hold 2 --hold-s 80 --host-timeout-s 5 --inject $f@60$until --out $f
    [ "$(grep -c "the device stopped: $f " err)" -eq 1 ] && [ "$(wc -l <err)" -eq 2 ] || { fail "$f:"; cat err; }
    grep -q "$f/ramp_hold_2mm.csv has the samples before it" err || fail "$f: the file is not named"
    [ "$(fault $f/ramp_hold_2mm.csv)" = "\"$f\"" ] || fail "$f: end.fault $(fault $f/ramp_hold_2mm.csv)"
    [ "$(rows $f/ramp_hold_2mm.csv)" -gt 1000 ] || fail "$f: $(rows $f/ramp_hold_2mm.csv) rows"
done
expect 0 characterize over_temperature/ramp_hold_2mm.csv --arms 0
grep -q "cut short by a fault" err || fail "characterize does not see the fault"
expect 1 acquire $H --specimen none --specimen-height-mm 24 --ramp-hold 2 --out air
grep -q "no contact within 30 mm" err || fail "air: $(cat err)"

# ---- killed, stopped, unplugged ----
grown() { [ -e "$1" ] && [ "$(wc -c <"$1")" -ge "$2" ]; } # file, bytes
"$PALPATE" acquire $H --monitor >monitor.csv 2>err &
await grown monitor.csv 500
kill -TERM $! && wait $! || fail "--monitor: exit code $?, $(cat err)"
head -n 1 monitor.csv | grep -q '^time_s,place_mm,depth_mm,force_N,' || fail "--monitor: $(head -n 1 monitor.csv)"
awk -F, 'NR > 1 && (NF != 9 || $8 != "idle" || $9 != "none" || (NR > 2 && $1 - last < 0.0999)) { exit 1 } { last = $1 }' monitor.csv ||
    fail "--monitor: $(cat monitor.csv)"
long="--specimen-height-mm 24 --ramp-hold 2 --hold-s 100000"
"$PALPATE" acquire $H $long --out killed 2>err &
await grown killed/ramp_hold_2mm.csv 100000
kill -9 $! && wait $! 2>/dev/null
[ "$(fault killed/ramp_hold_2mm.csv)" = '"interrupted"' ] || fail "killed: $(fault killed/ramp_hold_2mm.csv)"
expect 0 characterize killed/ramp_hold_2mm.csv --arms 0
grep -q "cut short by a fault" err || fail "killed: characterize does not see it"

# (a command in the background of a script does not hear SIGINT)
"$PALPATE" acquire $H $long --out stopped 2>err &
await grown stopped/ramp_hold_2mm.csv 100000
kill -TERM $!
wait $!
[ $? -eq 1 ] || fail "stopped: exit code"
grep -q "stopped, run 1 of 1" err || fail "stopped: $(cat err)"
[ "$(fault stopped/ramp_hold_2mm.csv)" = '"stopped"' ] || fail "stopped: $(fault stopped/ramp_hold_2mm.csv)"

(ulimit -f 100; exec "$PALPATE" acquire $H $long --out full 2>err)
[ $? -eq 1 ] || fail "full: exit code"
grep -q "full/ramp_hold_2mm.csv: File too large" err || fail "full: $(cat err)"
[ "$(fault full/ramp_hold_2mm.csv)" = '"failed"' ] || fail "full: $(fault full/ramp_hold_2mm.csv)"
[ "$(rows full/ramp_hold_2mm.csv)" -gt 1000 ] && tail -c 1 full/ramp_hold_2mm.csv | od -c | grep -q '\\n' || fail "full: not whole lines"

"$PALPATE" rig --firmware host --port pty >port 2>rig.err &
rig=$!
await test -s port
"$PALPATE" acquire --port "$(cat port)" $long --out unplugged 2>err &
await grown unplugged/ramp_hold_2mm.csv 100000
kill $rig
wait $!
[ $? -eq 1 ] || fail "unplugged: exit code"
grep -q "has closed.*, run 1 of 1; the samples so far are in unplugged/ramp_hold_2mm.csv" err || fail "unplugged: $(cat err)"
[ "$(fault unplugged/ramp_hold_2mm.csv)" = '"disconnected"' ] || fail "unplugged: $(fault unplugged/ramp_hold_2mm.csv)"

# ---- a creep run: to a force, held while the depth grows ----
echo '{"palpate": {"protocol": 1}, "runs": [{"kind": "segments", "name": "creep", "segments": [
 {"force_N": 1, "ramp_s": 1, "duration_s": 10}, {"move_to_mm": -1, "rate_mm_s": 5}]}]}' >creep.json
expect 0 acquire --port rig --firmware host --protocol creep.json --rest-s 0 --out creep
awk -F, '/^[0-9]/ && $1 > 4.5 && $1 < 12.5 { s += $3; n++; if (n < 500) a += $2 / 499; z = $2 }
    END { exit !(n > 7000 && s / n > 0.998 && s / n < 1.002 && z > a + 0.05) }' creep/creep.csv || fail "the force is not held"

# ---- what ends a run to a force: its deepest place, the lowest of the plate, a specimen that goes or is shaken ----
forced() { # newtons, more of the segment
    echo '{"palpate": {"protocol": 1}, "runs": [{"kind": "segments", "name": "forced", "segments": [
 {"force_N": '$1', "ramp_s": 1, "duration_s": 20'"${2:-}"'}]}]}' >forced.json
}
ends() { # fault, least and most depth in mm, options...
    why=$1 least=$2 most=$3; shift 3
    rm -rf forced
    expect 4 acquire $H --contact-mm 2 --protocol forced.json --out forced "$@"
    [ "$(fault forced/forced.csv)" = "\"$why\"" ] || fail "forced $*: $(fault forced/forced.csv)"
    awk -F, -v least="$least" -v most="$most" '/^[-0-9]/ && $2 > d { d = $2 } END { print d; exit !(d > least && d < most) }' \
        forced/forced.csv >out || fail "forced $*: the plate went $(cat out) mm deep"
}
forced 1 ', "deepest_mm": 0.5'; ends command_out_of_range 0.48 0.55
forced 1; ends command_out_of_range 0.98 1.05 --limit-travel-mm 3
ends command_out_of_range 0.68 0.75 --specimen-height-mm 0.7
ends contact_lost 2 3.5 --inject contact_lost@20
ends force_oscillates 2 4 --inject force_oscillates@20
expect 1 acquire $H --contact-mm 2 --limit-travel-mm 4 --ramp-hold 3 --hold-s 1 --out forced --force
grep -q 'ramp_hold_3mm goes to a depth of 3 mm, but' err || fail "a depth below the lowest place: $(cat err)"
forced 1 ', "deepest_mm": 0'
wrong 1 "runs[0].segments[0].deepest_mm must be a number above 0" $H --protocol forced.json --out x
forced 5
for c in 0.004 0.001; do # as stiff as it may be, and stiffer
    "$PALPATE" acquire $H --specimen rigid --specimen-height-mm 5 --compliance-mm-N $c --contact-mm 2 --protocol forced.json --out stiff$c 2>err
    [ $? -eq "$([ $c = 0.001 ] && echo 1 || echo 0)" ] || fail "a force on $c mm/N: $(cat err)"
done
grep -q 'refuses forced: force control is not stable at the measured stiffness of .* N/m' err || fail "a specimen too stiff for a force: $(cat err)"
awk -F, '/^[0-9]/ && $1 > 6 && $1 < 20 { n++; if ($3 < 4.9 || $3 > 5.1) exit 1 } END { exit !(n > 10000) }' stiff0.004/forced.csv || fail "5 N are not held on what is stiff"

# ---- soft: found, or the reason why not ----
expect 0 acquire $H --scale 0.06 --contact-mm 2 --static --depth-mm 1 --rate-mm-s 1 --out soft
expect 1 acquire $H --scale 0.01 --noise-N 0.005 --contact-mm 2 --static --depth-mm 1 --out softer
grep -q "reached 0.01 N, but its rise with depth is hidden by noise" err || fail "a line that is lost in noise: $(cat err)"

# ---- columns of the whole sensor and of temperature; a camera that starts the run, and gets a pulse every 100 samples ----
wrong 2 "--channels must be forces" $H --ramp-hold 2 --channels force --out x
expect 0 acquire $H $short --ramp-hold 2 --hold-s 1 --channels forces,temperature --trigger-in start --trigger-out 100 \
    --trigger-every-s 1.5 --out camera
grep -q '^time_s,depth_mm,force_N,Fx_N,Fy_N,Fz_N,Tx_Nm,Ty_Nm,Tz_Nm,temperature_C,trigger_in,trigger_out$' camera/ramp_hold_2mm.csv ||
    fail "columns: $(grep '^time_s' camera/ramp_hold_2mm.csv)"
[ -n "$(header camera/ramp_hold_2mm.csv device.row_Ty_Nm)" ] || fail "the matrix is not in the header"
awk -F, 'function off(x, y) { x -= y; return x < -1e-4 || x > 1e-4 }
    /^[0-9]/ { if (off($6, $3)) bad = "Fz_N"
        if ($4 < -0.05 || $4 > 0.05 || $9 < -1e-3 || $9 > 1e-3) bad = "a side force"
        if ($10 < 20 || $10 > 30) bad = "temperature"
        if ($12 != (n % 100 == 0)) bad = "trigger_out"
        if ($11 != (n % 1500 == 0)) bad = "trigger_in"
        if (bad != "") { print bad " in row " n ": " $0; exit 1 }
        n++ } END { exit !(n > 2000) }' camera/ramp_hold_2mm.csv >out || fail "columns: $(cat out)"

# ---- the image of the chip ----
if "$PALPATE" rig --until-s 0.1 --firmware qemu >/dev/null 2>&1; then
    expect 0 acquire --port rig --firmware qemu $short --ramp-hold 3 --hold-s 2 --out qemu --json
    [ "$(value out lost_samples)" = 0 ] || fail "QEMU: lost samples"
    near "QEMU: tracking" "$(value out error_rms_mm)" 0 0 0.01
fi
expect 1 acquire $H --specimen rigid --specimen-height-mm 5 --static --depth-mm 0.02 --rate-mm-s 20 --out fast
grep -q 'refuses static_0.02mm: it may move faster than 9.12 mm/s into a stiffness of 1e+06 N/m' err || fail "a run that is too fast: $(cat err)"
done_testing
