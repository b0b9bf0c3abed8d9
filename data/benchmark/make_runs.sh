#!/bin/sh
# make_runs.sh: the runs of this benchmark from data/measured: imported, thinned, and cut where a split leaves a part out.
# Run it from the root of the tree: data/benchmark/make_runs.sh
set -eu
palpate=${PALPATE:-build/palpate}
out=data/benchmark/runs
all=$(mktemp -d)
trap 'rm -rf "$all"' EXIT
"$palpate" import data/measured/mach1/*.csv --specimen-height-mm 3 --out "$all/mach1" 2>/dev/null >&2
"$palpate" import data/measured/ecoflex/*.csv --out "$all/ecoflex" 2>/dev/null >&2
"$palpate" import data/measured/titin/*.csv --units depth=stretch,force=kPa --specimen-height-mm 2 --specimen-area-mm2 0.5 --out "$all/titin" 2>/dev/null >&2
"$palpate" import data/measured/afm/AFM_contact_test.txt --specimen-height-mm 0.05 --out "$all/afm" 2>/dev/null >&2
mkdir -p "$out"

# keep FILE NAME EVERY [FIRST_S [UNTIL_S [UNTIL_MM]]]: all of the first seconds, then one sample in EVERY.
keep() {
    awk -F, -v every="$3" -v first="${4:-0}" -v until="${5:-1e9}" -v deepest="${6:-1e9}" '
        /^#/ { if (/palpate.experiment|specimen\.|contact\.(rule|sd_mm)|import.file/) print; next }
        !/^[-0-9]/ { print "time_s,depth_mm,force_N"; next }
        { if (!n) start = $1; t = $1 - start
          if (t <= until && $2 <= deepest && (t <= first || n % every == 0)) printf "%s,%s,%.6g\n", $1, $2, $3; n++ }' \
        "$all/$1" >"$out/$2.csv"
}
for site in 02 05 08; do keep mach1/hayes_${site}_StressRelaxation.csv mach1_$site 50 2; done
keep mach1/hayes_02_StressRelaxation.csv mach1_02_first 50 2 30
for way in 0.1 1 10 100; do keep titin/AvgRelaxed_${way}s.csv titin_${way}s 1; done
for grade in EF10_0T EF30_0T EF30_50T; do for batch in A2 B2; do keep ecoflex/${grade}_$batch.csv ecoflex_${grade}_$batch 4; done; done
keep ecoflex/EF30_50T_A2.csv ecoflex_EF30_50T_A2_shallow 4 0 1e9 15
keep afm/AFM_contact_test.csv afm 1
keep afm/AFM_contact_test.csv afm_approach 1 0 0.02495
