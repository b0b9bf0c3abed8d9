#!/bin/sh
# calibrate_relaxation.sh: Table 5.2 by the three phases; one material for many depths by least squares. check: once
. tests/cli/common

seed="--nodes 3 --scaling none --stage relaxation --method three_phase --formulation sedef2008 --ramp-s 1 --dt-ms 1"
expect 0 calibrate $DATA/lumped_n1.json $seed --depth-mm 6 --start $DATA/network_27.json --json
grep -v '^#' $DATA/table_5_2.csv | grep '^[0-9]' | cut -d, -f4 >wanted
values out peak_error_percent | head -n "$(wc -l <wanted)" >got
paste -d' ' got wanted | awk '{ d = $1 - $2; if (d < 0) d = -d; if (d > 0.4 || NF < 2) { print NR ": " $0; bad = 1 } }
    END { exit bad || NR != 15 }' || fail "Table 5.2: a peak error off by more than 0.4 percentage points"
for key in phase stiffness_N viscosity_Ns peak_error_percent steady_time_error_percent steady_force_error_percent; do
    grep -q "\"$key\":" out || fail "--json lacks $key"
done

# Two arms whose stiffness grows with strain hold for all of the seed's depths.
expect 0 calibrate $DATA/lumped_n2.json --nodes 3 --scaling none --stage all --arms 2 --strain-dependent --out network.json --json
grep -q '"static":' out && grep -q '"relaxation":' out || fail "--json lacks static or relaxation"
values out max_error_percent | awk '$1 > 0.7 { print; bad = 1 } END { exit bad || NR < 12 }' ||
    fail "an error above 0.7 % of the peak"

# The written network answers as the lumped model.
for model in network.json $DATA/lumped_n2.json; do
    expect 0 simulate $model --protocol ramp_hold --depth-mm 5 --hold-s 100 --json
    value out peak_force_N >>peaks
    value out final_force_N >>finals
done
near "peak at 5 mm" "$(sed -n 1p peaks)" "$(sed -n 2p peaks)" 0.007
near "after 100 s at 5 mm" "$(sed -n 1p finals)" "$(sed -n 2p finals)" 0.007

# Recorded runs of two depths in place of the lumped model.
for depth in 3 5; do
    expect 0 simulate $DATA/lumped_n2.json --protocol ramp_hold --depth-mm $depth --hold-s 50 --dt-ms 20 --out run$depth.csv
done
expect 0 calibrate $DATA/lumped_n2.json run3.csv run5.csv --start network.json --stage relaxation --arms 2 --strain-dependent \
    --json
values out max_error_percent | awk '$1 > 1 { print; bad = 1 } END { exit bad || NR != 2 }' || fail "fitted to recorded runs"
done_testing
