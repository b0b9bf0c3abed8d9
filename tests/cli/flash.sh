#!/bin/sh
# flash.sh: palpate firmware flash, with programs that stand in for stm32flash and dfu-util: what they are given, what is said.
. tests/cli/common

mkdir -p bin fw
# Both say something on stdout, keep in NAME.args what they were given to write, and end with the exit code in ./code. To
# read the board is to copy the file ./board, and does not end in a file that is there already.
stand_in() { # name, the option that reads
    cat >"bin/$1" <<END
#!/bin/sh
echo "progress of $1"
code=\$(cat $PWD/code)
all=\$*
while [ \$# -gt 0 ]; do
    if [ "\$1" = $2 ]; then
        [ ! -e "\$2" ] || exit 74
        echo "\$all" | sed "s,\$2,FILE," >$PWD/$1.read
        [ "\$code" -ne 0 ] || cp $PWD/board "\$2"
        exit "\$code"
    fi
    shift
done
echo "\$all" >$PWD/$1.args
exit "\$code"
END
    chmod +x "bin/$1"
}
stand_in stm32flash -r
stand_in dfu-util -U
mkdir tmp
PATH=$PWD/bin:$PATH PALPATE_FIRMWARE=$PWD/fw TMPDIR=$PWD/tmp
export PATH PALPATE_FIRMWARE TMPDIR
given() { cat "$1.args"; }
# where the stack ends, 0x20008000; where it starts, 0x08000101; the kind of board; and some more
image() { printf '\000\200\000\040\001\001\000\010'; head -c 200 /dev/zero; printf 'palpate board %s\000' "$1"; head -c 1000 /dev/zero; }
echo 0 >code
image stm32f405 >fw/indenter.bin
image stepper_hx711 >fw/stepper_hx711.bin
image stm32f405 >own.bin
image stm32f405 >board

expect 0 firmware flash --port /dev/ttyUSB7
[ "$(cat stm32flash.read)" = "-b 115200 -r FILE -S 0x08000000:1024 /dev/ttyUSB7" ] || fail "stm32flash read by $(cat stm32flash.read)"
[ "$(given stm32flash)" = "-b 115200 -w $PWD/fw/indenter.bin -v /dev/ttyUSB7" ] || fail "stm32flash was given $(given stm32flash)"
grep -q "written and verified" err && grep -q "progress of stm32flash" err || fail "not said: $(cat err)"
[ ! -s out ] || fail "on stdout: $(cat out)"
expect 0 firmware flash --port dfu --image own.bin
[ "$(cat dfu-util.read)" = "-a 0 -d 0483:df11 -s 0x08000000:1024 -U FILE" ] || fail "dfu-util read by $(cat dfu-util.read)"
[ "$(given dfu-util)" = "-a 0 -d 0483:df11 -s 0x08000000:leave -D own.bin" ] || fail "dfu-util was given $(given dfu-util)"
grep -q "the board starts it" err || fail "not said: $(cat err)"
# the board says which image is its own
cp fw/stepper_hx711.bin board
expect 0 firmware flash --port /dev/ttyUSB7
[ "$(given stm32flash)" = "-b 115200 -w $PWD/fw/stepper_hx711.bin -v /dev/ttyUSB7" ] || fail "a stepper's board was given $(given stm32flash)"
# a new board, or one whose parts were changed, says nothing, or the wrong thing
head -c 1024 /dev/zero | tr '\000' '\377' >board
expect 0 firmware flash --port dfu --board stm32f405
[ "$(given dfu-util)" = "-a 0 -d 0483:df11 -s 0x08000000:leave -D $PWD/fw/indenter.bin" ] || fail "a new board was given $(given dfu-util)"

# ---- what goes wrong; nothing is written then ----
echo 3 >code
expect 1 firmware flash --port /dev/ttyUSB7
grep -q "stm32flash failed (exit code 3): was the board reset with BOOT0 high" err || fail "not said: $(cat err)"
echo 0 >code
rm -f ./*.args
refused() { # text, arguments...
    text=$1; shift
    expect 1 firmware flash --port /dev/ttyUSB7 "$@"
    tail -n 1 err >last && mv last err
    says "$text"
}
refused "has no firmware of palpate yet: say which board it is with --board"
printf 'palpate board \033[31m' >board; head -c 1000 /dev/zero >>board
refused "has no firmware of palpate yet"
image stepper_ads1220 >board
refused "there is no stepper_ads1220.bin for the board stepper_ads1220: make firmware builds it"
refused "own.bin is for the board stm32f405, and this board is stepper_ads1220: nothing was written" --image own.bin
refused "own.bin is for the board stm32f405, and this board is stepper_hx711: nothing was written" --image own.bin --board stepper_hx711
for bad in empty text long even nameless; do
    case $bad in
    empty) : >bad.bin ;;
    text) echo "no image of anything" >bad.bin ;;
    long) { image stm32f405; head -c 70000 /dev/zero; } >bad.bin ;;
    even) { printf '\000\200\000\040\000\001\000\010'; image stm32f405 | tail -c +9; } >bad.bin ;;
    nameless) { image stm32f405 | head -c 200; head -c 1000 /dev/zero; } >bad.bin ;;
    esac
    refused "bad.bin is no image for an indenter's board" --image bad.bin --board stm32f405
done
refused "none.bin: No such file" --image none.bin --board stm32f405
rm fw/indenter.bin
refused "there is no indenter.bin for the board stm32f405: make firmware builds it" --board stm32f405
expect 2 firmware flash --port tcp:localhost:4000
says "wants a serial port such as"
expect 2 firmware flash --port dfu --board other
expect 2 firmware flash
says "name the device with --port"
[ -z "$(ls tmp)" ] || fail "left in the folder of temporary files: $(ls tmp)"
ls ./*.args 2>/dev/null && fail "a program was called all the same"
rm bin/dfu-util
if ! command -v dfu-util >/dev/null; then
    expect 1 firmware flash --port dfu --board stm32f405 --image own.bin
    says "there is no dfu-util: install it"
fi
done_testing
