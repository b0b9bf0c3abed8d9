#!/bin/sh
# self_test.sh: palpate firmware self-test on virtual indenters: one that is well, and ones with a fault each.
. tests/cli/common

trap 'kill $rig 2>/dev/null' EXIT
rig=
"$PALPATE" rig --firmware host --until-s 0.001 >out 2>err || { tail -n 1 err; exit 77; }

tested() { # exit code, options of the rig; out: the verdicts
    wanted=$1; shift
    rm -f port
    "$PALPATE" rig --firmware host --port pty "$@" >port 2>rig.err &
    rig=$!
    await grep -q pty: port
    "$PALPATE" firmware self-test --port "$(head -n 1 port)" >out 2>err
    got=$?
    kill $rig && wait $rig 2>/dev/null
    [ "$got" -eq "$wanted" ] || fail "rig $*: exit code $got, not $wanted: $(cat out err)"
}
bad() { [ "$(grep -c ^BAD out)" -eq 1 ] && grep -q "^BAD  $1" out || fail "not \"$1\" alone: $(cat out)"; }

for machine in voice-coil stepper stepper-fast; do
    tested 0 --machine $machine
    [ "$(grep -c ^good out)" -eq 12 ] && [ "$(wc -l <out)" -eq 12 ] || fail "$machine: $(cat out)"
done
# A specimen below the plate is touched and told, not pressed: 3 mm into it would take 1.5 N.
echo '{"palpate": {"actuator": 1}, "start_mm": 0.5}' >high.json
for at in 1.5 2 4.5; do
    for machine in voice-coil stepper; do
        tested 1 --machine $machine --actuator high.json --contact-mm $at --log log.csv
        bad " free way below home"
        awk -F, 'NR > 1 && NF == 11 && $5 > force { force = $5 } END { print force; exit !(force > 0 && force < 0.3) }' log.csv >force ||
            fail "$machine at $at mm: pressed by $(cat force) N"
    done
done
tested 1 --noise-N 0.05
bad " noise of the force"
tested 4 --inject following_error@1
grep -q "^BAD   home" out && grep -q "the device stopped: following_error" err || fail "jammed: $(cat out err)"
tested 4 --inject sensor_silent@0.2
grep -q "^BAD   samples without a reading" out || fail "silent: $(cat out err)"
done_testing
