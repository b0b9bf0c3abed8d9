#!/bin/sh
# poke.sh: examples/poke under a virtual screen: presses, grasps and cuts by a script; its picture; what it refuses.
. tests/cli/common

POKE=$(dirname "$PALPATE")/examples/poke/poke
pkg-config --exists glfw3 gl stb 2>/dev/null || { echo "GLFW, OpenGL or stb is not installed"; exit 77; }
command -v Xvfb >/dev/null || { echo "Xvfb is not installed"; exit 77; }
[ -x "$POKE" ] || { echo "no $POKE; run make poke"; exit 1; }
MODEL=$DATA/network_27.json

# poke CODE arguments...
poke() {
    wanted=$1; shift
    timeout 900 "$POKE" "$@" >out 2>err
    got=$?
    [ "$got" -eq "$wanted" ] || { fail "poke $*: exit code $got, not $wanted"; sed 's/^/    /' err; }
}

refuses() { # TEXT arguments...
    text=$1; shift
    poke "$code" "$@"
    says "$text"
}

# ---- without a screen: every mistake is told before a window opens
code=2
refuses "--frames: no such option, or its value is missing" --frames
refuses "--frames: no such option, or its value is missing or wrong" --frames 0
refuses "--size: no such option" --size 640
refuses "--colour: no such option" --colour red
refuses "--screenshot wants --frames" "$MODEL" --screenshot a.png
code=1
printf 'press 1 2 3 10\nprod 1\n' >bad.poke
refuses "bad.poke:2: unknown command 'prod'" "$MODEL" --script bad.poke
printf 'press 1 2 x 10\n' >bad.poke
refuses "bad.poke:1: 'press' wants 4 numbers" "$MODEL" --script bad.poke
printf '# a comment\n\nwait 0.5\n' >bad.poke
refuses "bad.poke:3: 'wait' wants 1 numbers, the last one frames" "$MODEL" --script bad.poke
printf 'lift 1\n' >bad.poke
refuses "'lift' has too many values" "$MODEL" --script bad.poke
refuses "nowhere.poke: cannot be read" "$MODEL" --script nowhere.poke
refuses "nowhere.json" nowhere.json --frames 1
refuses "a lumped model has no mesh" "$DATA/lumped_n1.json" --frames 1
poke 0 --help
grep -q '^Usage: poke' out || fail "no usage"

# ---- with one
Xvfb -displayfd 3 -screen 0 800x600x24 -nolisten tcp >xvfb.log 2>&1 3>display &
server=$!
trap 'kill $server 2>/dev/null' EXIT
await test -s display
DISPLAY=:$(cat display) LIBGL_ALWAYS_SOFTWARE=1
export DISPLAY LIBGL_ALWAYS_SOFTWARE

poke 0 "$MODEL" --frames 3 # by the mouse, which does nothing
grep -q ' 0 cut, 0 torn, 0 loose, 0 ticks failed' out || fail "left alone: $(cat out)"

code=1
refuses "nowhere/a.json" "$MODEL" --frames 1 --json nowhere/a.json

cat >press.poke <<'END'
press 12 32 12 1
press 12 25 12 20   # a sphere of 3.36 mm: 2.36 mm deep
wait 10
END
poke 0 "$MODEL" --script press.poke --frames 31 --size 640x480 --screenshot press.bmp
[ "$(od -An -tx1 -N 26 press.bmp | tr -d ' \n' | cut -c 1-4,37-52)" = 424d80020000e0010000 ] ||
    fail "press.bmp is no picture of 640 x 480"
[ "$(wc -c <press.bmp)" -eq $((54 + 640 * 480 * 3)) ] || fail "press.bmp has the wrong size"
# An image of one colour, or black, is no picture of a phantom.
[ "$(tail -c +55 press.bmp | od -An -v -tx1 -w3 | sort -u | wc -l)" -gt 500 ] || fail "press.bmp shows nothing"
force=$(sed -n 's/.* force \([-.0-9]*\) \([-.0-9]*\) \([-.0-9]*\) N.*/\2/p' out)
cp out press.out
awk -v f="$force" 'BEGIN { exit !(f > 0.05 && f < 5) }' || fail "the press is felt with $force N"
grep -q ' 0 cut, 0 torn, 0 loose, 0 ticks failed' out || fail "after a press: $(cat out)"
poke 0 "$MODEL" --script press.poke --frames 31 --size 640x480 --screenshot press.png --json press.json
python3 - "$force" <<'END' || fail "the figures of the press: $(cat press.json)"
import json, sys
shown = json.load(open("press.json"))
assert shown["nodes"] == 27 and shown["force_N"] >= float(sys.argv[1]) - 0.001 and shown["tick_ms"] > 0, shown
END
cmp -s out press.out || fail "the same script gave another result: $(cat out)"
[ "$(head -c 4 press.png | od -An -tx1 | tr -d ' ')" = 89504e47 ] || fail "press.png is no PNG"
tail -c 8 press.png | od -An -tx1 | tr -d ' \n' | grep -q 49454e44ae426082 || fail "press.png is cut short"

cat >cut.poke <<'END'
blade -1 6.1 -1  -1 6.1 25
slice 26 0 0 10
sheathe
grasp 12 24 12 5
drag 0 6 0 20
wait 5
END
poke 0 "$MODEL" --script cut.poke --frames 36 --size 640x480 --screenshot cut.bmp
grep -q ' 49 cut, 0 torn' out || fail "a sweep between two layers of 3 x 3 nodes cuts 49: $(cat out)"
force=$(sed -n 's/.* force \([-.0-9]*\) \([-.0-9]*\) \([-.0-9]*\) N.*/\2/p' out)
near "the force on what was cut off and lifted" "$force" 0 0 0.01
cmp -s press.bmp cut.bmp && fail "the pictures of a press and a cut are the same"
ls | grep -q part && fail "a temporary file was left behind"
done_testing
