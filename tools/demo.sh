#!/bin/sh
# demo.sh: what `make demo` runs: the seed's measured phantom becomes a calibrated network, with plots.
set -eu
cd "$(dirname "$0")/.."
palpate=${PALPATE:-build/palpate}
out=build/demo
mkdir -p "$out"

"$palpate" calibrate data/sedef2008/lumped_n2.json --nodes 3 --stage all --arms 2 \
    --out "$out/network.json" --plot "$out"

echo
echo "The calibrated network:  $out/network.json"
for plot in "$out"/*.svg; do
    [ ! -e "$plot" ] || echo "A plot:                  $plot"
done
