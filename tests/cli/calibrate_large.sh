#!/bin/sh
# calibrate_large.sh: a lattice too large to be run again and again takes its arms from a coarse one. check: all
. tests/cli/common

expect 0 calibrate $DATA/lumped_n1.json --nodes 16 --stage static --depth-mm 6 --out static.json
expect 0 calibrate $DATA/lumped_n1.json --stage relaxation --start static.json --depth-mm 3,5 --out network.json --json
values out max_error_percent | awk '$1 > 2 { print; bad = 1 } END { exit bad || NR != 2 }' || fail "an error above 2 % of the peak"
done_testing
