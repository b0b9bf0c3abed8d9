#!/bin/sh
# calibrate_device.sh: an indenter's parameters: shown, set, kept, loaded, damaged; recordings say them. check: once
. tests/cli/common

D="calibrate-device"
H="--port rig --firmware host --store flash.bin"
"$PALPATE" rig --firmware host --until-s 0.01 >/dev/null 2>&1 || { echo "there is no firmware: make firmware-host"; exit 77; }

# ---- shown and set ----
expect 0 $D show $H
head -n 1 out | grep -q '(compiled in), no date; not saved' || fail "show: $(head -n 1 out)"
grep -q '^travel_m  *0.03  *0.03  *0.002  *0.5$' out || fail "show lacks the travel: $(grep travel out)"
expect 0 $D set travel_m=0.028 Fz_N.0=2.7e-4 calibration_day=20000 compliance_m_N=2e-6 $H --yes
grep -q '^travel_m: 0.028 instead of 0.03$' err || fail "set does not say what changes: $(cat err)"
expect 0 $D show $H --json --out machine.json --force
cmp -s out machine.json || fail "--json and --out differ"
near "travel that was kept" "$(value out travel_m)" 0.028 0
grep -q '"source": "flash"' out || fail "what was kept is not in use after a start"
grep -q '"date": "2024-10-04"' out || fail "the date: $(grep date out)"
id=$(sed -n 's/.*"id": "\(.*\)",/\1/p' out | head -n 1)

# What a recording says, and that the travel is the one that was set.
expect 0 acquire $H --static --depth-mm 1 --rate-mm-s 2 --air-s 0.2 --after-s 0.2 --out runs
grep -q "^# calibration.id: \"$id\"\$" runs/static_1mm.csv || fail "calibration.id is not $id"
grep -q '^# calibration.source: "flash"$' runs/static_1mm.csv || fail "calibration.source"
grep -q '^# calibration.date: "2024-10-04T00:00:00Z"$' runs/static_1mm.csv || fail "calibration.date"
grep -q '^# calibration.frame_mm_N: 0.002$' runs/static_1mm.csv || fail "calibration.frame_mm_N"
grep -q '^# limits.travel_mm: 28' runs/static_1mm.csv || fail "the travel: $(grep travel runs/static_1mm.csv)"

# ---- the same by the image under QEMU, from the same flash ----
if command -v qemu-system-arm >/dev/null && [ -e "$(dirname "$PALPATE")/firmware/rig.elf" ]; then
    cp flash.bin flash_qemu.bin
    Q="--port rig --firmware qemu --store flash_qemu.bin"
    expect 0 $D set friction_N=0.2 $Q --yes
    expect 0 $D set friction_N=0.2 $H --yes
    cmp -s flash.bin flash_qemu.bin || fail "the two firmwares keep other bytes"
    expect 0 $D show $Q --json && near "kept by QEMU" "$(value out friction_N)" 0.2 0
fi

# ---- a file, and back ----
expect 0 $D standard $H --yes
expect 0 $D show $H --json && near "standard" "$(value out travel_m)" 0.03 0
grep -q "\"id\": \"$id\"" out && fail "other parameters have the same id"
expect 0 $D load machine.json $H --yes
expect 0 $D show $H --json
grep -q "\"id\": \"$id\"" out || fail "what was loaded is not what was saved"

# ---- asked, and refused: nothing changes ----
cp flash.bin before.bin
echo n | "$PALPATE" $D set travel_m=0.02 $H >out 2>err && fail "no is taken for yes"
"$PALPATE" $D set travel_m=0.02 $H >out 2>err </dev/null && fail "nothing is taken for yes"
expect 1 $D set travel_m=0.02 count_m=1 $H --yes
grep -q 'count_m cannot be 1: it goes from 1e-08 to 0.0001$' err || fail "range: $(cat err)"
expect 1 $D set Fz_N.0=0 Fz_N.1=0 Fz_N.2=0 Fz_N.3=0 Fz_N.4=0 Fz_N.5=0 $H --yes
grep -q 'is not 0 in all channels' err || fail "a blind sensor: $(cat err)"
expect 2 $D set travel=1 $H --yes; says "has no parameter travel"
expect 2 $D set Fz_N=1 $H --yes; says "Fz_N has 6 values: name one as Fz_N.0 to Fz_N.5"
expect 2 $D set Fz_N.6=1 $H --yes; says "Fz_N.0 to Fz_N.5"
expect 2 $D set travel_m=ten $H --yes; says "must be a number"
expect 2 $D $H; says "name an action"
expect 2 $D reset $H; says "no such action: reset"
expect 2 $D show; says "--port"
printf '{"palpate": {"machine": 1},\n "parameters": {\n"travel_m": "far"}}' >bad.json
expect 1 $D load bad.json $H --yes; says "bad.json:3: parameters.travel_m must be a number"
printf '{"palpate": {"machine": 1}, "parameters": {"tarvel_m": 1}}' >bad.json
expect 1 $D load bad.json $H --yes; says "parameters.tarvel_m is not a parameter of this device"
cmp -s flash.bin before.bin || fail "what is refused changes the flash"

# ---- damage: the record before it, and then none ----
records=$(($(wc -c <flash.bin) / 512))
printf '\0\0\0\0' | dd of=flash.bin bs=1 seek=$((512 * records + 40)) conv=notrunc 2>/dev/null
expect 0 $D show $H --json && near "the record before the damaged one" "$(value out travel_m)" 0.03 0
grep -q '"damaged_records": 1' out || fail "the damage is not told"
awk 'BEGIN { for (i = 0; i < 1536; i++) printf "%s", "abcd" }' >flash.bin
expect 0 $D show $H --json
grep -q '"source": "compiled in, flash damaged"' out || fail "a flash of nonsense: $(grep source out)"
expect 0 $D set friction_N=0.2 $H --yes
expect 0 $D show $H --json && near "kept beside nonsense" "$(value out friction_N)" 0.2 0
rm flash.bin
expect 0 $D set friction_N=0.2 $H --yes
cp flash.bin short.bin
printf '\0\0\0\0' | dd of=short.bin bs=1 seek=40 conv=notrunc 2>/dev/null
expect 0 acquire --port rig --firmware host --store short.bin --static --depth-mm 1 --rate-mm-s 2 --air-s 0.2 --after-s 0.2 --out damaged
grep -q 'saved parameters are damaged' err || fail "acquire does not warn: $(cat err)"
done_testing
