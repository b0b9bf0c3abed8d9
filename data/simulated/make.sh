#!/bin/sh
# make.sh: calculix.csv, the force of a network of 5 nodes a side by CalculiX, 0.18 mm apart: palpate export and ccx.
# Run it from the root of the tree: data/simulated/make.sh >data/simulated/calculix.csv
set -eu
PALPATE=$(cd "$(dirname "${PALPATE:-build/palpate}")" && pwd)/palpate
here=$(mktemp -d)
trap 'rm -rf "$here"' EXIT
sed 's/\[3, 3, 3\]/[5, 5, 5]/' data/sedef2008/network_27.json >"$here/network.json"
cd "$here"
depths=$(awk 'BEGIN { for (i = 1; i <= 60; i++) printf "%s%g", (i > 1 ? "," : ""), i * 0.18 }')
"$PALPATE" export network.json --depth-mm "$depths" --out press.inp
OMP_NUM_THREADS=1 ccx -i press >press.log
echo depth_mm,force_N
echo 0,0
awk '/time/ { t = $NF } !/force/ && NF == 3 { printf "%.10g,%.10g\n", t * 0.18, -$2 }' press.dat
