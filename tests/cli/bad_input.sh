#!/bin/sh
# bad_input.sh: files that are missing or wrong: one line that names the file, exit code 1. check: asan
. tests/cli/common

M=$DATA/network_27.json L=$DATA/lumped_n1.json
wrong() { # text, arguments...
    text=$1; shift
    expect 1 "$@"
    says "palpate $1: "
    says "$text"
}
wrong "none.json" simulate none.json --protocol static --depth-mm 3
wrong "none.csv" simulate $M --like none.csv
wrong "none.json" calibrate none.json --nodes 3
wrong "none.json" export none.json --strain 0.1
printf '{"palpate": {"model": 1},\n "kind": "lumped"' >half.json
wrong "half.json:2" simulate half.json --protocol static --depth-mm 3
sed 's/-0.70/-700/' $L >negative.json
wrong "negative.json" simulate negative.json --protocol static --depth-mm 3
sed 's/height_mm/height_m/' $L >unit.json
wrong "unit.json:4" simulate unit.json --protocol static --depth-mm 3

run() { # name kind rows...
    { printf '# palpate.experiment: 1\n# protocol.kind: "%s"\ntime_s,depth_mm,force_N\n' "$2"; printf '%b' "$3"; } >"$1"
}
run nan.csv static '0,0,0\n1,1,nan\n'
wrong "nan.csv:5" simulate $M --like nan.csv
run back.csv static '0,0,0\n1,1,1\n1,2,2\n'
wrong "back.csv:6" simulate $M --like back.csv
{ sed '1,/^time_s/!d' nan.csv; awk 'BEGIN { for (i = 0; i < 40; i++) printf "%d,%d,%de300\n", i, i / 4, i }'; } >huge.csv
wrong "huge.csv" explain --model $L huge.csv
run short.csv static '0,0,0\n'
wrong "short.csv" simulate $M --like short.csv
run deep.csv static '0,0,0\n1,30,1\n'
wrong "deep.csv: depth_mm reaches 30" simulate $M --like deep.csv
# rows NAME AWK: twenty samples at i = 0 to 19 of a specimen, depth d and force f.
rows() { run "$1" static "$(awk "BEGIN { for (i = 0; i < 20; i++) { d = i / 4; f = i / 20; $2; printf \"%g,%.9g,%.9g\\\\n\", i, d, f } }")"; }
rows cyclic.csv 'd = i % 12; d = d > 6 ? 12 - d : d; f = d'
wrong "cyclic.csv: its path is more than one press" calibrate $L cyclic.csv --nodes 3
rows few.csv 'd = i < 15 ? 0 : i - 15; f = d'
wrong "few.csv: has 4 samples of increasing depth" calibrate $L few.csv --nodes 3 --stage static
run alone.csv static '0,0,0\n'
wrong "alone.csv: has 1 samples, but at least 16 are needed" calibrate $L alone.csv --nodes 3
# What characterize refuses no other command takes for a press of the specimen.
mkdir simulated
rows simulated/dead.csv ''
cp simulated/dead.csv simulated/negated.csv
rows dead.csv 'f = i % 2 ? 0.004 : -0.003'
rows negated.csv 'f = -f'
rows deeper.csv 'd *= 6'
rows far.csv 'd += 1e6'
for run in "dead.csv: force_N never exceeds its noise" "negated.csv: force_N grows while depth_mm falls" \
    "deeper.csv: the depth of 28.5 mm exceeds the specimen's height of 24 mm" "far.csv: the depth of 1e+06 mm exceeds"; do
    wrong "$run" characterize "${run%%:*}" --specimen-height-mm 24
    wrong "$run" explain --model $L "${run%%:*}"
    wrong "$run" calibrate $L "${run%%:*}" --nodes 3 --stage static
    wrong "$run" export $L --to febio --runs "${run%%:*}" --nodes 3 --poisson 0.45
done
for run in "dead.csv: force_N never exceeds its noise" "negated.csv: force_N grows while depth_mm falls"; do
    wrong "$run" explain --simulated "simulated/${run%%:*}" "${run%%:*}"
done
wrong "is a network" calibrate $M --nodes 3
sed 's/"arms": \[\]/"arms": [{"stiffness_N": 0.2, "viscosity_Ns": 2}], "density_kg_m3": 1000/' $M >heavy.json
wrong "heavy.json: has density_kg_m3" calibrate $L --start heavy.json --stage relaxation
wrong "heavy.json: has density_kg_m3" explain few.csv --model heavy.json
wrong "is a lumped model, but --start needs a network" calibrate $L --start $L
wrong "is a lumped model, which has no mesh" export $L --strain 0.1
wrong "three_phase fits one" calibrate $DATA/lumped_n2.json --nodes 3 --method three_phase
wrong "none.msh" calibrate $L --mesh none.msh --stage static
wrong "hex-diagonals" calibrate $L --mesh "$ROOT/data/meshes/box_hexa.msh" --stage static
wrong "nowhere/run.csv" simulate $L --protocol static --depth-mm 3 --out nowhere/run.csv
wrong "nowhere/deck.inp" export $M --strain 0.1 --out nowhere/deck.inp
ls | grep -q tmp && fail "a temporary file was left behind: $(ls | grep tmp)"
done_testing
