#!/bin/sh
# no_loss.sh: long recordings over a PTY, also by a host that stalls: every tick arrives, once and undamaged.
# check: all
. tests/cli/common

TMPDIR=$PWD/tmp
export TMPDIR
mkdir -p tmp
trap 'kill $rig 2>/dev/null' EXIT
"$PALPATE" rig --firmware host --until-s 0.001 >out 2>err || { tail -n 1 err; exit 77; }

# start_rig: the port goes to $port.
start_rig() {
    "$PALPATE" rig --firmware host --port pty >port 2>rig.err &
    rig=$!
    await grep -q pty: port
    port=$(head -n 1 port)
}

# whole DIR SECONDS: nothing lost or damaged, and the time of each row a tick after the last one's.
whole() {
    for key in lost_samples bad_samples; do
        grep -q "^# end.$key: 0 *\$" "$1"/*.csv || fail "$1: $(grep "end.$key" "$1"/*.csv)"
    done
    grep -q '^# end.fault: null' "$1"/*.csv || fail "$1: $(grep 'end.fault' "$1"/*.csv)"
    awk -F, -v s="$2" '/^[0-9]/ { if (n && ($1 - last > 0.0015 || $1 - last < 0.0005)) gaps++; last = $1; n++ }
        END { printf "%d samples, %d gaps\n", n, gaps; exit !(n > 1000 * s && gaps == 0) }' "$1"/*.csv ||
        fail "$1: not every tick is there"
}

start_rig
expect 0 acquire --port "$port" --ramp-hold 3 --hold-s 200 --specimen-height-mm 24 --out steady
whole steady 200

# Ten minutes by a host that stops for two seconds now and then.
"$PALPATE" acquire --port "$port" --ramp-hold 3 --hold-s 600 --specimen-height-mm 24 --out stalled >out 2>err &
host=$!
stalls=0
for pause in 1.3 0.4 2.1 0.9 1.7 0.6; do
    sleep $pause
    kill -STOP $host 2>/dev/null || break
    sleep 2
    kill -CONT $host
    stalls=$((stalls + 1))
done
wait $host || fail "acquire: exit code $?: $(cat err)"
echo "$stalls stalls of 2 s"
[ "$stalls" -gt 0 ] || fail "it was over before the first stall"
whole stalled 600
done_testing
