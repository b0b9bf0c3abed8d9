#!/bin/sh
# flash.sh: palpate firmware flash, with programs that stand in for stm32flash and dfu-util: what they are given, what is said.
. tests/cli/common

mkdir -p bin fw
stand_in() { # name: it says on stdout and keeps in NAME.args what it was given, and ends with the exit code in ./code
    printf '#!/bin/sh\necho "progress of %s"\nprintf "%%s\\n" "$@" >%s/%s.args\nexit $(cat %s/code)\n' "$1" "$PWD" "$1" "$PWD" >"bin/$1"
    chmod +x "bin/$1"
}
stand_in stm32flash
stand_in dfu-util
PATH=$PWD/bin:$PATH PALPATE_FIRMWARE=$PWD/fw
export PATH PALPATE_FIRMWARE
given() { tr '\n' ' ' <"$1.args"; }
# where the stack ends, 0x20008000; where it starts, 0x08000101; and some more
image() { printf '\000\200\000\040\001\001\000\010'; head -c 1000 /dev/zero; }
echo 0 >code
image >fw/indenter.bin
image >own.bin

expect 0 firmware flash --port /dev/ttyUSB7
[ "$(given stm32flash)" = "-b 115200 -w $PWD/fw/indenter.bin -v /dev/ttyUSB7 " ] || fail "stm32flash was given $(given stm32flash)"
grep -q "written and verified" err && grep -q "progress of stm32flash" err || fail "not said: $(cat err)"
[ ! -s out ] || fail "on stdout: $(cat out)"
expect 0 firmware flash --port dfu --image own.bin
[ "$(given dfu-util)" = "-a 0 -d 0483:df11 -s 0x08000000:leave -D own.bin " ] || fail "dfu-util was given $(given dfu-util)"
grep -q "the board starts it" err || fail "not said: $(cat err)"

# ---- what goes wrong; nothing is written then ----
echo 3 >code
expect 1 firmware flash --port /dev/ttyUSB7
grep -q "stm32flash failed (exit code 3): was the board reset with BOOT0 high" err || fail "not said: $(cat err)"
rm -f ./*.args
for bad in empty text long even; do
    case $bad in
    empty) : >bad.bin ;;
    text) echo "no image of anything" >bad.bin ;;
    long) { image; head -c 70000 /dev/zero; } >bad.bin ;;
    even) { printf '\000\200\000\040\000\001\000\010'; head -c 1000 /dev/zero; } >bad.bin ;;
    esac
    expect 1 firmware flash --port /dev/ttyUSB7 --image bad.bin
    says "bad.bin is no image for the indenter's board"
done
expect 1 firmware flash --port /dev/ttyUSB7 --image none.bin
says "none.bin: No such file"
rm fw/indenter.bin
expect 1 firmware flash --port /dev/ttyUSB7
says "there is no indenter.bin: make firmware builds it"
expect 2 firmware flash --port tcp:localhost:4000
says "wants a serial port such as"
expect 2 firmware flash
says "name the device with --port"
ls ./*.args 2>/dev/null && fail "a program was called all the same"
rm bin/dfu-util
if ! command -v dfu-util >/dev/null; then
    expect 1 firmware flash --port dfu --image own.bin
    says "there is no dfu-util: install it"
fi
done_testing
