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
input="is an input or named twice"
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
refused model.json "$input" explain --model $L run.csv --out model.json --json model.json
refused run.csv "$input" report run.csv --out run.csv
refused folder/run.csv "$input" report folder --out folder/run.csv
ln -s run.csv link.csv
refused run.csv "$input" simulate model.json --like run.csv --out link.csv
recording="is a recording: name another output, or give --force"
refused run.csv "$recording" simulate model.json --protocol static --depth-mm 3 --out run.csv
refused run.csv "$recording" export network.json --strain 0.1 --out run.csv
grep -v '^#' run.csv >raw.csv
refused raw.csv "$input" import raw.csv --specimen-height-mm 24 --out .
mkdir imported
expect 0 import raw.csv --specimen-height-mm 24 --out imported
refused imported/raw.csv "$recording" import raw.csv --specimen-height-mm 24 --out imported
expect 0 import raw.csv --specimen-height-mm 24 --out imported --force
expect 0 simulate model.json --protocol static --depth-mm 3 --out simulated.csv

# A link is followed, and --force replaces.
expect 0 simulate model.json --protocol static --depth-mm 3 --out link.csv --force
[ -h link.csv ] && cmp -s run.csv simulated.csv || fail "a link is not followed"
mkfifo pipe
cat pipe >through &
expect 0 export network.json --strain 0.1 --out pipe
wait $!
[ -p pipe ] && grep -q '^\*NODE' through || fail "a FIFO is not written"

# Standard input and output.
for command in "simulate - --protocol static --depth-mm 3" "simulate model.json --protocol static --depth-mm 3 --out -"; do
    "$PALPATE" $command <model.json >piped 2>err || fail "palpate $command: $(cat err)"
    grep -v '^# model.file' piped | cmp -s - /dev/null && fail "palpate $command: no run"
    [ "$(grep -c '^[0-9]' piped)" -eq "$(grep -c '^[0-9]' simulated.csv)" ] || fail "palpate $command: another run"
done
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
    full export network.json --strain 0.1 --out -
    mkdir figures
    ln -s /dev/full figures/stiffness_law.svg
    if command -v gnuplot >/dev/null; then
        expect 1 characterize run.csv --arms 1 --degree 2 --plot figures
        grep -q 'stiffness_law.svg: cannot write: No space left on device' err || fail "the figure's reason: $(cat err)"
        [ -e figures/stiffness_law.gp ] && fail "a script without its figure"
    fi
fi

# The two files of a reduced model stay a pair where one cannot be written.
echo json >reduced.json
mkdir reduced.bin
expect 1 reduce network.json --runs run.csv --hold-out 0 --modes 2 --samples 5 --out reduced.json
[ "$(cat reduced.json)" = json ] || fail "one file of a pair is replaced"
ls . folder figures | grep -q 'tmp$' && fail "a temporary file was left behind"
done_testing
