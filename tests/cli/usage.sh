#!/bin/sh
# usage.sh: help, version, and every way to call a command wrongly: one line, exit code 2. check: asan
. tests/cli/common

expect 0 --version
grep -q '^palpate [0-9]*\.[0-9]*\.[0-9]*$' out || fail "--version: $(cat out)"
expect 0 --help
grep -q '^Usage: palpate COMMAND' out || fail "--help lacks its usage"
grep -q '^Example:' out || fail "--help lacks an example"
for command in acquire panel rig import characterize explain report simulate calibrate reduce export firmware calibrate-device batch benchmark; do
    grep -q "^  $command " out || fail "--help lacks $command"
    "$PALPATE" $command --help >help 2>err || fail "$command --help: exit code $?"
    [ -s err ] && fail "$command --help writes to stderr"
    grep -q "^Usage: palpate $command" help || fail "$command --help lacks its usage"
    grep -q '^Example:' help || fail "$command --help lacks an example"
    grep -q '^  --json [A-Z]' help && fail "$command --json takes a file"
    awk 'length > 110 { exit 1 }' help || fail "$command --help has a line above 110 columns"
done
"$PALPATE" >out 2>err
[ $? -eq 2 ] && [ ! -s out ] && [ -s err ] || fail "without arguments: help on stderr, exit code 2"
expect 2 press; says "no such command: press"
expect 2 simualte; says "no such command: simualte; did you mean simulate?"
expect 2 help simualte; says "did you mean simulate?"
for command in "help simulate" "--help simulate"; do
    expect 0 $command
    head -n 1 out | grep -q '^Usage: palpate simulate' || fail "palpate $command: $(head -n 1 out)"
done
if [ -w /dev/full ]; then
    for command in --help --version "help simulate" "simulate --help"; do
        "$PALPATE" $command >/dev/full 2>err
        [ $? -eq 1 ] || fail "palpate $command to a full device: not exit code 1"
        says "standard output: No space left on device"
    done
fi

M=$DATA/network_27.json L=$DATA/lumped_n1.json
wrong() { # text that the line must hold, arguments...
    text=$1; shift
    expect 2 "$@"
    says "palpate $1: "
    says "$text"
    [ -s out ] && fail "palpate $*: wrote to stdout"
}
wrong "name a MODEL.json" simulate
wrong "no such option: --deepness" simulate $M --deepness 3
wrong "no such option: --depht-mm=3; did you mean --depth-mm?" simulate $M --depht-mm=3
wrong "no such option: -x" simulate -x $M
wrong "needs a value" simulate $M --protocol static --depth-mm
wrong "takes no value" simulate $M --json=yes
wrong "one argument too many" simulate $M $M --protocol static --depth-mm 3
wrong "must be a number (MM), not \"abc\"" simulate $M --protocol static --depth-mm abc
wrong "not \"3mm\"" simulate $M --protocol static --depth-mm 3mm
wrong "not \"nan\"" simulate $M --protocol static --depth-mm nan
wrong "not \"inf\"" simulate $M --protocol static --depth-mm inf
wrong "not \"1e999\"" simulate $M --protocol static --depth-mm 1e999
wrong "not \"\"" simulate $M --protocol static --depth-mm ""
wrong "must be above 0" simulate $M --protocol static --depth-mm -3
wrong "must be above 0" simulate $M --protocol static --depth-mm 0
wrong "must be above 0" simulate $M --protocol static --depth-mm 3 --dt-ms 0
wrong "at most 0.1" simulate $M --protocol static --depth-mm 3 --tolerance 2
wrong "must be from 1 to" simulate $M --protocol cyclic --depth-mm 3 --cycles 0
wrong "whole number" simulate $M --protocol cyclic --depth-mm 3 --cycles 2.5
wrong "must be one of static|ramp_hold|cyclic|creep" simulate $M --protocol press --depth-mm 3
wrong "must be one of continue|stable" simulate $M --protocol static --depth-mm 3 --branch any
wrong "either --protocol or --like" simulate $M
wrong "either --protocol or --like" simulate $M --protocol static --depth-mm 3 --like run.csv
wrong "needs --depth-mm" simulate $M --protocol static
wrong "needs --force-N" simulate $M --protocol creep
wrong "--cycles does not go with --protocol static" simulate $M --protocol static --depth-mm 3 --cycles 2
wrong "--depth-mm does not go with --protocol creep" simulate $M --protocol creep --force-N 1 --depth-mm 3
wrong "--depth-mm does not go with --like" simulate $M --like run.csv --depth-mm 3
wrong "leave one out" simulate $M --protocol ramp_hold --depth-mm 3 --ramp-s 1 --rate-mm-s 3
wrong "either --dt-ms or --tolerance" simulate $M --protocol static --depth-mm 3 --dt-ms 1 --tolerance 1e-3
wrong "beyond the model's height of 24 mm" simulate $M --protocol static --depth-mm 30
wrong "beyond the model's height of 24 mm" simulate $L --protocol static --depth-mm 24
wrong "raise --dt-ms" simulate $L --protocol static --depth-mm 9 --dt-ms 1e-6
wrong "--nodes must be one or three" simulate $M --protocol static --depth-mm 3 --nodes 3,3
wrong "separated by commas" simulate $M --protocol static --depth-mm 3 --nodes 3,,3
wrong "must be from 2 to" simulate $M --protocol static --depth-mm 3 --nodes 1
wrong "--nodes changes a lattice" simulate $L --protocol static --depth-mm 3 --nodes 3
wrong "--vtu needs a network" simulate $L --protocol static --depth-mm 3 --vtu frames

wrong "name a LUMPED.json" calibrate
wrong "name the network: " calibrate $L
wrong "either --nodes or --mesh" calibrate $L --nodes 3 --mesh box.msh
wrong "goes with --nodes" calibrate $L --mesh box.msh --size-mm 24
wrong "go with --mesh" calibrate $L --nodes 3 --scale-mm 2
wrong "--size-mm must be one or three" calibrate $L --nodes 3 --size-mm 24,24
wrong "for --stage relaxation or all" calibrate $L --nodes 3 --stage static --method three_phase
wrong "for --stage static or all" calibrate $L --nodes 3 --stage relaxation --method fixed_point
wrong "has one arm" calibrate $L --nodes 3 --stage relaxation --method three_phase --arms 2
wrong "has one arm" calibrate $L --nodes 3 --formulation sedef2008 --arms 2
wrong "takes one depth" calibrate $L --nodes 3 --stage relaxation --method three_phase --depth-mm 4,6
wrong "takes one --depth-mm" calibrate $L --nodes 3 --stage static --depth-mm 4,6
wrong "needs --method nlopt" calibrate $L --nodes 3 --stage static --method fixed_point --law spline
wrong "--strain-dependent needs" calibrate $L --nodes 3 --method three_phase --strain-dependent
wrong "must be from 1 to 16" calibrate $L --nodes 3 --arms 99
wrong "exceeds the network's height" calibrate $L --nodes 3 --stage static --depth-mm 30

wrong "name a MODEL.json" export
wrong "either --depth-mm or --strain" export $M
wrong "either --depth-mm or --strain" export $M --depth-mm 3 --strain 0.1
wrong "must be one of calculix" export $M --strain 0.1 --to ansys
wrong "must be from 5 to 200" export $M --strain 0.1 --table-points 1000
wrong "press less" export $M --depth-mm 24
wrong "two successive steps" export $M --depth-mm 3,3
done_testing
