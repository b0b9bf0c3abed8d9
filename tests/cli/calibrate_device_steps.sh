#!/bin/sh
# calibrate_device_steps.sh: an indenter that is another one than its figures say: each step finds what it is, and a recording made
# afterwards has the right force. check: once
. tests/cli/common

D="calibrate-device"
"$PALPATE" rig --firmware host --until-s 0.01 >/dev/null 2>&1 || { echo "there is no firmware: make firmware-host"; exit 77; }
echo '{"palpate": {"actuator": 1}, "moving_kg": 0.55, "coulomb_N": 0.35, "viscous_Ns_m": 9, "lift_N": 0.25,
 "compliance_mm_N": 0.004, "force_constant_N_A": 11}' >other.json
H="--port rig --firmware host --store flash.bin --actuator other.json --gain 1.07 --bias-N 0.03"

# contains NAME TRUTH SHARE: the truth is within three times its 95 % interval or a thousandth, and the interval not wider than this share
# of it on each side
contains() {
    awk -v name="\"$1\":" -v truth="$2" -v share="$3" '
        $1 == name { there = 1 }
        there && $1 == "\"low\":" { low = $2 + 0 }
        there && $1 == "\"high\":" { high = $2 + 0; exit }
        END { half = (high - low) / 2; slack = 2 * half + 0.001 * truth
            exit !(there && low - slack <= truth && truth <= high + slack && half <= share * truth) }' out ||
        fail "$1 is not $2 to $3: $(grep -A 3 "\"$1\"" out | tr -d '\n')"
}

# ---- weights: whoever puts them there follows the prompts ----
weigh() { # options...
    rm -f answers prompts && mkfifo answers prompts
    echo 0 >weight
    "$PALPATE" $D weights $H --weight weight --yes --json "$@" <answers >out 2>prompts &
    exec 3>answers
    : >err
    while read -r line; do
        echo "$line" >>err
        case $line in
        *"press Enter."*)
            echo "$line" | sed -n 's/^[PH]u*[a-z]* \([0-9]*\) g .*/\1/p' |
                awk -v sign="${sign:-1}" '{ g = $1 } END { printf "%.9g\n", sign * g * 9.80665e-3 }' >weight.part
            mv weight.part weight
            echo >&3 ;;
        esac
    done <prompts
    exec 3>&-
    wait $!
}
weigh --weights-g 50,100,200,500 || fail "weights: exit code $?"
contains reads_N_N 1.07 0.001
contains zero 0.03 0.05
near "noise" "$(sed -n '/noise_N/,/}/s/.*"value": \(.*\),/\1/p' out)" 0.002 0.1
grep -q '"kept": true' out || fail "the sensitivity is not kept"
weigh --weights-g 50,100,200,500 || fail "weights again: exit code $?"
contains reads_N_N 1 0.001
sign=-1 weigh --weights-g 50,100,200 --hanging || fail "hanging weights: exit code $?"
contains reads_N_N 1 0.001

# Masses that are not what was named, however straight their line, are not kept; and what is kept stays as it was.
cp flash.bin before.bin
for factor in 0.001 0.5 2 -1; do
    sign=$factor weigh --weights-g 50,100,200 && fail "masses $factor times what was named are kept"
    grep -q 'more than 20 % off' err || fail "$factor times the masses: $(cat err)"
    grep -q -- '--large-change accepts the new sensitivity' err || fail "$factor times the masses: what would keep it is not told: $(cat err)"
    grep -q '"kept": false' out || fail "$factor times the masses: the result says that they are kept"
done
cmp -s flash.bin before.bin || fail "what is refused changes the flash"
sign=1.15 weigh --weights-g 50,100,200 || fail "a change of 15 %: exit code $?"
weigh --weights-g 50,100,200 || fail "and back: exit code $?"
sign=-1 weigh --weights-g 50,100,200 --large-change || fail "weights the other way round: exit code $?"
grep -q 'has the wrong sign' err || fail "a sensor the wrong way round is not told: $(cat err)"
weigh --weights-g 50,100,200 --large-change || fail "back: exit code $?" # what was turned is turned back
sign=0 weigh --weights-g 50,100,200 && fail "no weights at all are taken for some"
grep -q 'does not change with the masses' err || fail "no weights: $(cat err)"
expect 1 $D weights $H --weights-g 50,100 --yes </dev/null
grep -q 'cancelled: nothing is changed' err || fail "the end of the input: $(cat err)"
expect 2 $D weights $H; says "give two masses or more"

# ---- block, air, gains ----
expect 0 $D block $H --specimen rigid --yes --json --out-folder steps
contains frame_mm_N 0.005 0.03 # with the block's own
contains motor_N 66 0.01
expect 0 $D air $H --specimen none --yes --json
contains friction_N 0.35 0.01
contains motor_drag_Ns_m 39.25 0.01
contains lift_N 0.25 0.01
expect 0 $D gains $H --yes --json --out-folder steps
contains moving_kg 0.55 0.01
contains motor_drag_Ns_m 39.25 0.02
contains friction_N 0.35 0.02
awk '/"error_um"/ { getline; before = $2 + 0 } /"error_after_um"/ { getline; after = $2 + 0 }
    END { exit !(after > 0 && after < 0.5 * before) }' out || fail "the new gains do not follow better: $(cat out)"
expect 1 $D block $H --yes --force --out-folder steps; grep -q 'is not that of a rigid block' err || fail "a specimen for a block: $(cat err)"

# ---- a recording afterwards: what it says, and its force that of an indenter without error ----
press="--static --depth-mm 3 --rate-mm-s 2 --air-s 0.2 --after-s 0.2 --noise-N 0 --compliance-mm-N 0"
expect 0 acquire $H $press --out after
expect 0 acquire --port rig --firmware host $press --out truth
expect 0 acquire $H --store none.bin $press --out before
peak() { sed -n 's/^# end.peak_N: //p' "$1"/*.csv; }
near "force after the calibration" "$(peak after)" "$(peak truth)" 0.005
near "force before it" "$(peak before)" "$(awk -v x="$(peak truth)" 'BEGIN { print 1.07 * x }')" 0.01
for key in id source date frame_mm_N noise_N sensitivity_sd; do
    grep -q "^# calibration.$key: " after/*.csv || fail "the recording does not say calibration.$key"
done
expect 0 $D show $H --json
id=$(sed -n 's/.*"id": "\(.*\)",/\1/p' out | head -n 1)
grep -q "^# calibration.id: \"$id\"\$" after/*.csv || fail "calibration.id is not $id"

# ---- what goes wrong leaves all as it was ----
cp flash.bin before.bin
expect 4 $D air $H --specimen none --yes --inject sensor_silent@3
expect 1 $D gains $H --specimen none --yes --force --out-folder steps
cmp -s flash.bin before.bin || fail "a step that fails changes the flash"
done_testing
