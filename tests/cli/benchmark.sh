#!/bin/sh
# benchmark.sh: held-out errors that are known beforehand, palpate's own fit, and what is wrong with a folder.
. tests/cli/common
mkdir temporary
TMPDIR=$PWD/temporary
export TMPDIR

# ---- a specimen whose force is 2 N/mm of depth: what is predicted is off by what was put there ----
mkdir -p set/runs set/predictions/off/deeper set/predictions/late/deeper
run() { # deepest depth in mm, added to the force
    awk -v deep="$1" -v off="$2" 'BEGIN { srand(3); print "# palpate.experiment: 1\n# specimen.height_mm: 20\ntime_s,depth_mm,force_N"
        for (i = 0; i <= deep * 100; i++) printf "%.9g,%.9g,%.9g\n", i / 50, i / 100, i / 50 + off + (off ? 0 : 1e-4 * (rand() - 0.5)) }'
}
run 2 0 >set/runs/shallow.csv
run 4 0 >set/runs/deep.csv
run 4 0.5 >set/predictions/off/deeper/deep.csv
run 3.9 0.5 >set/predictions/late/deeper/deep.csv
manifest() { # programs
    cat <<J
{"palpate": {"benchmark": 1}, "palpate_with": [{"name": "palpate", "arguments": []}], "programs": [$1],
 "splits": [{"name": "deeper", "leaves_out": "depths", "fit": ["runs/shallow.csv"], "predict": ["runs/deep.csv"], "deeper_than_mm": 2.005}]}
J
}
manifest '"off", "absent"' >set/benchmark.json
expect 0 benchmark set --out table.csv
awk -F, '$3 == "off" { exit !($1 == "deeper" && $2 == "depths" && $4 == 200 && $5 > 0.49999 && $5 < 0.50001 && $7 > 0.06249 && $7 < 0.06251) }' table.csv ||
    fail "what is off by 0.5 N: $(cat table.csv)"
awk -F, '$3 == "palpate" { n++; exit !($7 < 1e-4) } END { exit !n }' table.csv || fail "palpate of a straight line: $(cat table.csv)"
grep -q absent table.csv && fail "a row without predictions: $(cat table.csv)"
grep -q "^deeper  *depths  *[0-9.e-]*  *6.25  *-$" out || fail "the table: $(cat out)"
expect 0 benchmark set --json
near "rms in the JSON" "$(values out rms_N | sed -n 2p)" 0.5 1e-4
[ "$(grep -c '"share": null' out)" -eq 1 ] || fail "what was not handed in is null: $(cat out)"

# ---- what is wrong ----
manifest '"late"' >set/benchmark.json
expect 1 benchmark set
says "set/predictions/late/deeper/deep.csv: has no force at 7.82 s, where set/runs/deep.csv has one"
sed 's/deeper_than_mm": 2.005/deeper_than_mm": 9/' set/benchmark.json >m && cp m set/benchmark.json
expect 1 benchmark set
says "deeper: no sample is left to predict"
sed 's/"fit"/"fits"/' set/benchmark.json >m && cp m set/benchmark.json
expect 1 benchmark set
says "set/benchmark.json: split 1: fits is no key here"
echo '{"palpate": {"benchmark": 1},' >set/benchmark.json
expect 1 benchmark set
says "set/benchmark.json:2:"
echo '{"palpate": {"batch": 1}}' >set/benchmark.json
expect 1 benchmark set
says 'lacks "palpate": {"benchmark": 1}'
manifest '"../off"' >set/benchmark.json
expect 1 benchmark set
says "must list names of folders of predictions/"
manifest "" | sed 's/shallow/none/' >set/benchmark.json
expect 1 benchmark set
says "palpate characterize set/runs/none.csv failed: palpate characterize:"
expect 1 benchmark nowhere
says "nowhere/benchmark.json"
expect 2 benchmark
says "name a folder with a benchmark.json"

# ---- the recordings of others: every split is predicted, and the runs are those of data/measured ----
ls -A "$TMPDIR" | grep -q . && fail "a folder is left behind"
cp -R "$ROOT/data/benchmark" kept
(cd "$ROOT" && mkdir -p "$SCRATCH/tree/data/benchmark" && cp data/benchmark/make_runs.sh "$SCRATCH/tree/data/benchmark" && cp -R data/measured "$SCRATCH/tree/data")
(cd tree && PALPATE=$PALPATE data/benchmark/make_runs.sh) || fail "make_runs.sh"
diff -r tree/data/benchmark/runs "$ROOT/data/benchmark/runs" >differs || fail "runs that data/measured does not give: $(head -n 3 differs)"
expect 0 benchmark "$ROOT/data/benchmark" --out table.csv
awk -F, '$3 == "palpate" { n++; if (!($7 < 0.6)) bad = 1; if ($1 ~ /^ecoflex_EF/ && !($7 < 0.01)) bad = 1 } END { exit !(n == 9 && !bad) }' table.csv ||
    fail "the recordings of others: $(cat table.csv)"
done_testing
