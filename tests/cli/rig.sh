#!/bin/sh
# rig.sh: the virtual indenter on the firmware itself: a session from a script, faults, how it ends.
. tests/cli/common

TMPDIR=$PWD/tmp
export TMPDIR
mkdir -p tmp

# session FIRMWARE LOG arguments...: 9 s of data/rig/session.script.
session() {
    firmware=$1 log=$2; shift 2
    expect 0 rig --firmware "$firmware" --script "$ROOT/data/rig/session.script" --until-s 9 --log "$log" "$@"
}
column() { awk -F, -v t="$2" -v n="$3" '$1 == t { print $n }' "$1"; }

# ---- the plate homes, finds the specimen, presses it and goes back ----
session host a.csv
grep -q '^pty:/dev/' out || fail "no port on stdout: $(cat out)"
grep -q '^running the host process$' err || fail "does not say what runs: $(cat err)"
[ "$(wc -l <a.csv)" -eq 9002 ] || fail "$(wc -l <a.csv) lines for 9001 ticks"
near "home" "$(awk -F, 'NR > 1 && (NR == 2 || $2 < least) { least = $2 } END { print least }' a.csv)" 0 0 0.06
near "rest after homing, mm" "$(column a.csv 1.400 2)" 1 0 0.003
near "depth held, mm" "$(column a.csv 7.000 4)" 5 0 0.02
near "force in the hold, N" "$(column a.csv 7.000 5)" 2.29 0.02
near "in the air at the end, mm" "$(column a.csv 9.000 4)" -1 0 0.02
[ "$(column a.csv 9.000 10)" = 1 ] || fail "the plate is not held at the end"

# ---- the same again is the same; another specimen is not; QEMU is the same ----
session host b.csv
cmp a.csv b.csv || fail "a second run differs"
session host b.csv --scale 2 --compliance-mm-N 0.1
near "twice the force" "$(column b.csv 7.000 5)" 4.15 0.02
near "the frame gives way, mm" "$(column b.csv 7.000 4)" 4.585 0 0.01
session host b.csv --model "$DATA/network_27.json"
near "force of a network, N" "$(column b.csv 7.000 5)" 1.92 0.02
# What it sends is the same to the bit, INFO aside, which names the board: on every machine, in every run.
golden=fcbcff8bbf69a8dc75c19fa7c8bd4de86281b34829254a51c1920f87c74de8b8
hash_of() { tail -c +200 "$1" | sha256sum | cut -d ' ' -f 1; }
session host b.csv --port file:stream
[ "$(hash_of stream)" = $golden ] || fail "another stream than ever: $(hash_of stream)"
if "$PALPATE" rig --firmware qemu --until-s 0.001 >out 2>err; then
    session qemu b.csv --port file:qemu_stream
    cmp -l stream qemu_stream >differ
    [ "$(awk '$1 > 200' differ | wc -l)" -eq 0 ] || fail "the image under QEMU sends something else"
    most=$(sed -n 's/.*at most \([0-9]*\) instructions a tick.*/\1/p' err)
    [ "${most:-9999}" -le 8000 ] || fail "a tick of $most instructions"
    session qemu b.csv --port file:qemu_again
    cmp qemu_stream qemu_again || fail "a second run under QEMU differs"
    grep -q '^running the STM32F405 image under QEMU [0-9]' err || fail "does not say what runs: $(cat err)"
    cmp a.csv b.csv || fail "the image under QEMU does something else than the process"
    # The dearest tick: sweeps, and commands as fast as the line brings them.
    for k in 1 2; do
        awk -v k=$k '/^#/ { next } /^every/ { if (++n == k) h = $2; next } { print }
            END { for (t = 5010; t < 9000; t++) print t, h }' "$ROOT/tests/data/worst_tick.script" >worst.script
        expect 0 rig --firmware qemu --script worst.script --until-s 9 --port file:busy
        most=$(sed -n 's/.*at most \([0-9]*\) instructions a tick.*/\1/p' err)
        echo "the dearest tick: $most instructions"
        [ "${most:-99999}" -gt 10000 ] && [ "$most" -le 15500 ] || fail "a tick of $most instructions"
    done
else
    echo "not compared with QEMU: $(tail -n 1 err)"
fi

# ---- a fault: off within a tick of being seen, and on again by nobody ----
for fault in emergency_stop sensor_silent over_force stack_guard; do
    session host b.csv --inject $fault@6.5
    awk -F, 'NR > 1 && $10 { last = $1 } END { exit !(last >= 6.5 && last <= 6.502) }' b.csv ||
        fail "$fault: the motor was last on at $(awk -F, 'NR > 1 && $10 { last = $1 } END { print last }' b.csv) s"
done
session host b.csv --inject encoder_jump@6.5,watchdog_reset@7
grep -q 'restarted 1 times' err || fail "does not tell of the restart: $(cat err)"

# ---- a weak arm overheats as the seed's did: data/rig/README.md ----
overheats() { # arguments of acquire: its last sample goes to ./last
    expect 4 acquire --port rig --firmware host --actuator "$ROOT/data/rig/phantom_premium.json" \
        --limit-winding-C 100 --specimen-height-mm 24 --out hot "$@"
    grep -q over_temperature err || fail "acquire $*: ended otherwise: $(cat err)"
    tail -n 1 hot/*.csv | tr , ' ' >last
    rm -rf hot
}
# While the host is kept waiting the rig goes on, and its motor warms: the run that waited least counts.
longest=0
for try in 1 2 3 4 5; do
    overheats --ramp-hold 7
    longest=$(awk -v m="$longest" '{ print ($1 > m ? $1 : m) }' last)
    awk -v m="$longest" 'BEGIN { exit !(m >= 145) }' && break
done
near "end of the hold, s" "$longest" 151 0 6
overheats --static --depth-mm 12
near "end of the press, mm" "$(cut -d ' ' -f 2 last)" 9.76 0 0.1

# ---- Ctrl-C ends it cleanly, and nothing is left ----
rm out
"$PALPATE" rig --firmware host --paced >out 2>err &
rig=$!
await test -s out
kill -TERM $rig
wait $rig || fail "exit code $? after a signal: $(cat err)"
grep -q 'ticks late' err || fail "does not tell how it was paced: $(cat err)"
[ -z "$(ls tmp)" ] || fail "left behind: $(ls tmp)"

# ---- wrong usage and what is not there ----
wrong() { # text that the line must hold, arguments...
    text=$1; shift
    expect 2 rig "$@"
    says "$text"
}
wrong "--port wants pty, file:PATH or tcp:PORT" --port serial
wrong "--port wants pty, file:PATH or tcp:PORT" --port tcp:70000
wrong "no such fault: \"fire\"" --inject fire@2
wrong "FAULT@SECONDS" --inject over_force@soon
wrong "does not go with a model" --specimen none --model "$DATA/lumped_n2.json"
wrong "one argument too many" "$DATA/lumped_n2.json"
expect 1 rig --firmware host --model no_model.json; says "no_model.json"
expect 1 rig --firmware host --actuator "$DATA/lumped_n2.json"; says "is no actuator"
expect 1 rig --firmware host --script "$DATA"; says "Is a directory"
echo "1 zz" >bad
expect 1 rig --firmware host --script bad; says "bad:1: "
PALPATE_FIRMWARE=$PWD
export PALPATE_FIRMWARE
expect 1 rig --firmware host; says "there is no indenter_host"
done_testing
