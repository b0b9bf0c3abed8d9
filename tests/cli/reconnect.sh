#!/bin/sh
# reconnect.sh: a cable that is pulled: found again by acquire between runs, by the panel whenever nothing moves; a run keeps what came.
. tests/cli/common

command -v python3 >/dev/null || { echo "there is no python3"; exit 77; }
"$PALPATE" rig --firmware host --until-s 0.001 >out 2>err || { tail -n 1 err; exit 77; }
export PALPATE
rig= cable=
trap 'kill $rig $cable 2>/dev/null' EXIT

plug() { # options of cable.py; a rig of its own
    rm -f port cable.log # of the one before
    "$PALPATE" rig --firmware host --port pty ${RIG-} >port 2>rig.err &
    rig=$!
    await grep -q pty: port
    python3 -B "$ROOT/tests/cli/cable.py" "$(sed 's/^pty://' port)" "$PWD/cable" cable.log "$@" 2>cable.err &
    cable=$!
    await grep -q in cable.log
}
unplug() { kill $cable $rig 2>/dev/null; wait $cable $rig 2>/dev/null; rm -f cable; }
fault() { sed -n 's/^# end.fault: \(.*[^ ]\) *$/\1/p' "$1"; }
run="--specimen-height-mm 24 --air-s 0.3 --after-s 0.2"

# ---- between runs: both are whole, contact is that of the start ----
plug rest
expect 0 acquire --port "unix:$PWD/cable" $run --ramp-hold 2,3 --hold-s 1 --rest-s 5 --out rests
grep -q "waiting .* s for a connection" err && grep -q "reconnected after" err || fail "not said: $(cat err)"
[ "$(grep -c out cable.log)" -eq 1 ] || fail "the cable was not pulled: $(cat cable.log)"
for f in ramp_hold_2mm ramp_hold_3mm; do
    [ "$(fault rests/$f.csv)" = null ] && grep -q '^# end.lost_samples: 0 ' rests/$f.csv || fail "$f: $(grep '^# end' rests/$f.csv)"
done
[ "$(grep device.contact_counts rests/ramp_hold_2mm.csv)" = "$(grep device.contact_counts rests/ramp_hold_3mm.csv)" ] || fail "another contact"
unplug

# ---- not waited for; waited for in vain ----
plug rest
expect 1 acquire --port "unix:$PWD/cable" $run --ramp-hold 2,3 --hold-s 1 --rest-s 5 --reconnect-s 0 --out given_up
[ "$(fault given_up/ramp_hold_2mm.csv)" = null ] && [ ! -e given_up/ramp_hold_3mm.csv ] || fail "given up: $(ls given_up)"
unplug

# ---- in a run: what came is there, and says why there is no more ----
plug
"$PALPATE" acquire --port "unix:$PWD/cable" $run --ramp-hold 2 --hold-s 100000 --out cut 2>cut.err &
host=$!
cut_grown() { [ "$(wc -c <cut/ramp_hold_2mm.csv)" -gt 100000 ] || ! kill -0 $host; }
await cut_grown
kill -USR1 $cable
wait $host
[ $? -eq 1 ] || fail "cut: exit code"
[ "$(fault cut/ramp_hold_2mm.csv)" = '"disconnected"' ] || fail "cut: $(fault cut/ramp_hold_2mm.csv) $(cat cut.err)"
rows=$(grep -c '^[-0-9]' cut/ramp_hold_2mm.csv)
grep -q "^# end.samples: $rows " cut/ramp_hold_2mm.csv && [ "$rows" -gt 1000 ] || fail "cut: $rows rows, $(grep end.samples cut/*.csv)"
unplug

# ---- the panel ----
if "$PALPATE" panel --port /dev/none --out x 2>err; [ "$(grep -c 'without libmicrohttpd' err)" -eq 0 ]; then
    RIG=--paced plug
    PYTHONDONTWRITEBYTECODE=1 CABLE=$cable timeout 1500 python3 "$ROOT/tests/cli/panel/test_reconnect.py" "unix:$PWD/cable" ||
        fail "test_reconnect.py: $(cat panel.err)"
    unplug
fi
done_testing
