#!/bin/sh
# measured.sh DIR [ROW]: imports, characterizes and explains the measured data of others (data/measured), one row of
# doc/explain-cases.md after the other, or those whose name has ROW in it: name, verdict, rms before and after, the same
# of runs left out, noise level; then the candidates that come first. Results stay in DIR.
#     data/explain/measured.sh measured hayes_02
set -eu
here=$(cd "$(dirname "$0")/../measured" && pwd)
palpate=${PALPATE:-$here/../../build/palpate}
dir=${1:?a folder} row=${2-}
mkdir -p "$dir"
[ -d "$dir/mach1" ] || "$palpate" import "$here"/mach1/*.csv --specimen-height-mm 3 --out "$dir/mach1" >"$dir/import.txt" 2>&1
[ -d "$dir/ecoflex" ] || "$palpate" import "$here"/ecoflex/*.csv --out "$dir/ecoflex" >>"$dir/import.txt" 2>&1

[ -d "$dir/afm" ] || "$palpate" import "$here"/afm/AFM_*.txt --specimen-height-mm 0.05 --out "$dir/afm" >>"$dir/import.txt" 2>&1
[ -d "$dir/titin" ] || "$palpate" import "$here"/titin/*.csv --units depth=stretch,force=kPa --specimen-height-mm 2 \
    --specimen-area-mm2 0.5 --out "$dir/titin" >>"$dir/import.txt" 2>&1

# explain NAME EVERY 'CHARACTERIZE OPTIONS' RUNS...
explain() {
    name=$1 every=$2 options=$3
    shift 3
    case $name in *"$row"*) ;; *) return 0 ;; esac
    "$palpate" characterize "$@" $options --out "$dir/$name.json" >"$dir/$name.fit.txt" 2>&1
    "$palpate" explain --model "$dir/$name.json" "$@" --every "$every" --result "$dir/$name.explained.json" >"$dir/$name.txt"
    python3 - "$name" "$dir/$name.explained.json" <<'P'
import json, sys
e = json.load(open(sys.argv[2]))
g = e["gap"]
print("%-15s %-11s %.2g %.2g, left out %.2g %.2g, noise level %.2g;" % (sys.argv[1], e["verdict"], *(g[k] for k in (
    "before_N", "after_N", "heldout_before_N", "heldout_after_N", "noise_level_N"))),
    ", ".join("%s %s" % (f["id"], f["parameters"]) for f in e["effects"]) or "nothing", "|",
    ", ".join(s["id"] for s in sorted(e["rejected"], key=lambda s: -s["score"])[:4]))
P
}

m="$dir/mach1"
for site in hayes_02 hayes_05 hayes_08; do
    for arms in 1 2; do
        explain "${site}_$arms" 20 "--arms $arms --law polynomial" "$m/${site}"_*.csv
    done
done
for arms in 1 2 3; do
    explain "hayes_all_$arms" 20 "--arms $arms --law polynomial" "$m"/hayes_0[258]_*.csv
done
explain static_00 100 "--degree 2" "$m"/static_00*.csv
for material in EF10_0T EF30_0T EF30_50T; do
    explain "$material" 4 "--arms 0 --law mooney_rivlin5" "$dir/ecoflex/${material}"_[AB]*.csv
done
for arms in 1 2; do
    explain "afm_$arms" 1 "--arms $arms" "$dir"/afm/*.csv
    explain "titin_$arms" 1 "--arms $arms" "$dir"/titin/*.csv
done
