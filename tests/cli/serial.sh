#!/bin/sh
# serial.sh: palpate acquire through libserialport itself, on a PTY that a shim of ours passes off as a serial port.
. tests/cli/common

shim=$(dirname "$PALPATE")/tests/tools/serial_shim.so
[ -e "$shim" ] || { echo "there is no $shim"; exit 77; }
TMPDIR=$PWD/tmp
export TMPDIR
mkdir -p tmp
trap 'kill $rig 2>/dev/null' EXIT
"$PALPATE" rig --firmware host --until-s 0.001 >out 2>err || { tail -n 1 err; exit 77; }

start_rig() { # options: the PTY goes to $port
    : >port
    "$PALPATE" rig --firmware host --port pty "$@" >port 2>rig.err &
    rig=$!
    await grep -q pty: port
    port=$(sed -n '1s/^pty://p' port)
}
acquire() { LD_PRELOAD=$shim "$PALPATE" acquire --port "$port" --specimen-height-mm 24 "$@" >out 2>err; }

start_rig
expect 1 acquire --port "$port" --specimen-height-mm 24 --ramp-hold 3 --out bare # not without the shim
acquire --ramp-hold 3 --hold-s 20 --rest-s 5 --raw --out runs || fail "acquire: exit code $?: $(cat err)"
grep -q '^# end.fault: null' runs/ramp_hold_3mm.csv || fail "the run ended by $(grep end.fault runs/*.csv)"
grep -q '^# end.lost_samples: 0 ' runs/ramp_hold_3mm.csv || fail "$(grep end.lost runs/*.csv)"

# Unplugged in the middle: what came is there, and says so.
LD_PRELOAD=$shim "$PALPATE" acquire --port "$port" --specimen-height-mm 24 --ramp-hold 4 --hold-s 3000 --keep-contact --out torn \
    >torn.out 2>torn.err &
host=$!
rows() { [ "$(grep -c '^[-0-9]' torn/ramp_hold_4mm.csv)" -ge 2000 ]; }
await rows
# Nobody else gets the port meanwhile: no other palpate, and no other program (root alone is not held by that).
acquire --ramp-hold 4 --out second && fail "two programs use one indenter"
grep -q "$port is in use by another program; close it" err || fail "a second acquire: $(cat err)"
if command -v python3 >/dev/null; then
    python3 -c 'import fcntl, os, struct, sys
got = fcntl.ioctl(os.open(sys.argv[1], os.O_RDWR | os.O_NOCTTY), 0x80045440, bytes(4))  # TIOCGEXCL
sys.exit(struct.unpack("i", got)[0] != 1)' "$port" || fail "the port is open to other programs"
fi
kill -9 $rig
wait $host
code=$?
[ $code -eq 1 ] || fail "unplugged: exit code $code: $(cat torn.err)"
[ "$(wc -l <torn.err)" -le 2 ] || fail "unplugged: $(cat torn.err)"
grep -q '^# end.fault: "disconnected"' torn/ramp_hold_4mm.csv || fail "torn: $(grep end.fault torn/*.csv)"
"$PALPATE" characterize torn/ramp_hold_4mm.csv --arms 1 --out torn.json >/dev/null 2>err || fail "torn: $(cat err)"
done_testing
