#!/bin/sh
# outputs.sh: what a command writes: no input and no recording is lost, links and pipes stay, pairs stay pairs. check: asan
. tests/cli/common

L=$DATA/lumped_n1.json M=$DATA/network_27.json
"$PALPATE" simulate $L --protocol ramp_hold --depth-mm 4 --hold-s 5 --sample-Hz 20 --air-s 1 --noise-N 0.004 >simulated.csv
grep -v '^# model.file' simulated.csv >run.csv
cp $L model.json
cp $M network.json
mkdir folder
cp run.csv folder

# refused WHAT WHY arguments...: the file stays as it is
refused() {
    file=$1 why=$2; shift 2
    cp "$file" before
    expect 1 "$@"
    says "palpate $1: "
    says "$why"
    cmp -s "$file" before || fail "palpate $*: $file is another one"
}
input="is an input, or an output named twice"
refused model.json "$input" simulate model.json --protocol static --depth-mm 3 --out model.json
refused model.json "$input" simulate model.json --protocol static --depth-mm 3 --out ./model.json --force
refused run.csv "$input" simulate model.json --like run.csv --out run.csv
refused run.csv "$input" characterize run.csv --out run.csv --specimen-height-mm 24
refused model.json "$input" calibrate model.json --nodes 3 --out model.json
refused network.json "$input" export network.json --strain 0.1 --out network.json
refused network.json "$input" reduce network.json --out network.json
refused run.csv "$input" reduce network.json --runs simulated.csv,run.csv --out run.csv
refused model.json "$input" explain --model model.json run.csv --out model.json
refused run.csv "$input" explain --model model.json run.csv --next run.csv
refused model.json "$input" explain --model $L run.csv --out model.json --result model.json
refused run.csv "$input" report run.csv --out run.csv
refused folder/run.csv "$input" report folder --out folder/run.csv
ln -s run.csv link.csv
refused run.csv "$input" simulate model.json --like run.csv --out link.csv
recording="is a recording; name another output, or give --force"
refused run.csv "$recording" simulate model.json --protocol static --depth-mm 3 --out run.csv
refused run.csv "$recording" export network.json --strain 0.1 --out run.csv
grep -v '^#' run.csv >raw.csv
refused raw.csv "$input" import raw.csv --specimen-height-mm 24 --out .
mkdir imported
expect 0 import raw.csv --specimen-height-mm 24 --out imported
refused imported/raw.csv "$recording" import raw.csv --specimen-height-mm 24 --out imported
expect 0 import raw.csv --specimen-height-mm 24 --out imported --force
expect 0 simulate model.json --protocol static --depth-mm 3 --out simulated.csv

# Folders of outputs: neither an input nor a recording is replaced there, nor another output.
mkdir plots
cp network.json plots/network.pvd
cp run.csv plots/recorded.csv
ln -s recorded.csv plots/network_0000.vtu
refused model.json "$input" calibrate model.json --nodes 3 --report model.json
refused plots/network.pvd "$input" simulate plots/network.pvd --protocol static --depth-mm 3 --vtu ./plots/
refused run.csv "$input" characterize run.csv --arms 1 --degree 2 --report ./run.csv
refused plots/recorded.csv "$recording" characterize run.csv --arms 1 --degree 2 --result plots/recorded.csv
refused plots/recorded.csv "$recording" explain --model model.json run.csv --report plots/recorded.csv
refused plots/recorded.csv "$recording" simulate network.json --protocol static --depth-mm 3 --vtu plots
refused run.csv "$input" characterize run.csv --result page.html --report ./page.html
refused run.csv "$input" explain --model model.json run.csv --out new.json --next ./new.json

# The virtual indenter's log and the file that its port may be.
refused model.json "$input" rig --firmware host --until-s 0.01 --model model.json --log model.json
refused model.json "$input" rig --firmware host --until-s 0.01 --model model.json --port file:model.json
refused run.csv "$recording" rig --firmware host --until-s 0.01 --log run.csv
refused run.csv "$recording" rig --firmware host --until-s 0.01 --port file:run.csv
expect 0 rig --firmware host --until-s 0.01 --port file:forced.csv --log forced.csv.log
expect 1 rig --firmware host --until-s 0.01 --port file:forced.csv --log forced.csv
says "$input"
cp run.csv forced.csv
expect 0 rig --firmware host --until-s 0.01 --log forced.csv --force
refused model.json "$input" acquire --port rig:model.json --firmware host --static --depth-mm 2 --rate-mm-s 1 --out folder --log model.json
expect 1 acquire --port rig:model.json --firmware host --static --depth-mm 2 --rate-mm-s 1 --out folder --log ./folder/static_2mm.csv --force
says "$input"

# A link is followed, and --force replaces.
expect 0 simulate model.json --protocol static --depth-mm 3 --out link.csv --force
[ -h link.csv ] && cmp -s run.csv simulated.csv || fail "a link is not followed"
mkfifo pipe
cat pipe >through &
expect 0 export network.json --strain 0.1 --out pipe
wait $!
[ -p pipe ] && grep -q '^\*NODE' through || fail "a FIFO is not written"

# What is cut off leaves nothing half written: neither the log nor what stood there.
echo before >log.csv
"$PALPATE" rig --firmware host --log log.csv --port file:stream >out 2>err &
rig=$!
for _ in 1 2 3 4 5 6 7 8 9 10; do
    ls | grep -q '^log.csv.*tmp$' && break
    sleep 0.2
done
kill -9 $rig
wait $rig 2>/dev/null
[ "$(cat log.csv)" = before ] || fail "a log that was cut off: $(tail -n 1 log.csv)"
[ -e stream ] && fail "a stream that was cut off is there"
rm -f log.csv.*.tmp stream.*.tmp

# Standard input and output.
for command in "simulate - --protocol static --depth-mm 3" "simulate model.json --protocol static --depth-mm 3 --out -"; do
    "$PALPATE" $command <model.json >piped 2>err || fail "palpate $command: $(cat err)"
    grep -v '^# model.file' piped | cmp -s - /dev/null && fail "palpate $command: no run"
    [ "$(grep -c '^[0-9]' piped)" -eq "$(grep -c '^[0-9]' simulated.csv)" ] || fail "palpate $command: another run"
done
for file in model.json run.csv; do
    "$PALPATE" report - --out piped.html <$file 2>err || fail "palpate report -: $(cat err)"
    "$PALPATE" report $file --out named.html 2>err || fail "palpate report $file: $(cat err)"
    crc=$(sed -n 's/.*"crc32":"\([0-9a-f]\{8\}\)".*/\1/p' named.html)
    [ -n "$crc" ] && grep -q "$crc" piped.html || fail "palpate report -: another file than $file"
done
echo "# palpate.experiment: 1" | "$PALPATE" report - --out piped.html 2>err && fail "a run without rows on standard input"
says "palpate report: /dev/stdin:"
{ echo first; "$PALPATE" export network.json --strain 0.1 --out -; echo last; } >both
[ "$(sed -n '1p;$p' both | tr '\n' ' ')" = "first last " ] || fail "standard output was replaced"

# A full device: its name and the reason, whatever is written.
if [ -w /dev/full ]; then
    full() {
        "$PALPATE" "$@" >/dev/full 2>err
        [ $? -eq 1 ] || fail "palpate $*: a full device is no failure"
        says "No space left on device"
    }
    full simulate model.json --protocol static --depth-mm 3
    full simulate model.json --protocol static --depth-mm 3 --json
    full export network.json --strain 0.1
    full report run.csv
    expect 1 rig --firmware host --until-s 0.1 --log /dev/full
    grep -q '/dev/full: cannot write: No space left on device' err || fail "the log's reason: $(cat err)"
    expect 1 rig --firmware host --until-s 0.1 --port file:/dev/full
    grep -q '/dev/full: cannot write: No space left on device' err || fail "the port's reason: $(cat err)"
    full export network.json --strain 0.1 --out -
    for option in --result --report; do
        ln -sf /dev/full full.json
        expect 1 characterize run.csv --arms 1 --degree 2 $option full.json
        grep -q 'full.json: cannot write: No space left on device' err || fail "$option: the reason: $(cat err)"
    done
fi

# The two files of a reduced model stay a pair where one cannot be written.
echo json >reduced.json
mkdir reduced.bin
expect 1 reduce network.json --runs run.csv --hold-out 0 --modes 2 --samples 5 --out reduced.json
[ "$(cat reduced.json)" = json ] || fail "one file of a pair is replaced"
ls . folder | grep -q 'tmp$' && fail "a temporary file was left behind"
done_testing
