#!/bin/sh
# panel.sh: palpate panel against the virtual indenter: who may ask, runs, stops, faults, two pages, what is on disk. check: asan
. tests/cli/common

wrong() { # text, arguments...
    text=$1; shift
    expect 2 panel "$@"
    says "$text"
}
wrong "name the device with --port" --out x
wrong "name the folder of the recordings" --port rig
wrong "--noise-N needs --port rig" --port /dev/none --noise-N 0.1 --out x
expect 1 panel --port /dev/none --out x
if grep -q "without libmicrohttpd" err; then
    echo "this palpate has no page: install libmicrohttpd-dev and build it again"; exit 77
fi
says "/dev/none"
command -v python3 >/dev/null || { echo "there is no python3"; exit 77; }
export PALPATE
PYTHONDONTWRITEBYTECODE=1 timeout 1500 python3 "$ROOT/tests/cli/panel/test_panel.py" || fail "test_panel.py: $(cat panel.err)"

# ---- the runs without a device: acquire --dry-run ----
echo '{"palpate": {"protocol": 1}, "runs": [{"kind": "segments", "segments": [{"move_to_mm": 2, "rate_mm_s": 4},
 {"force_N": 0.5, "ramp_s": 1, "duration_s": 2}]}]}' >p.json
expect 0 acquire --dry-run --json --protocol p.json --specimen-height-mm 24
python3 - <<'END' || fail "--dry-run: $(cat out)"
import json
run, = json.load(open("out"))["runs"]
assert run["path"][:3] == [[0, -1], [1, -1], [1.75, 2]], run
assert [f for t, f in run["force"]] == [0, 0.5, 0.5] and run["force"][2][0] - run["force"][1][0] == 2, run
END
expect 0 acquire --dry-run --ramp-hold 2,4 --specimen-height-mm 24
[ "$(grep -c '^ramp_hold_' out)" -eq 2 ] || fail "--dry-run as a table: $(cat out)"
expect 2 acquire --dry-run --ramp-hold 2,40 --specimen-height-mm 24
done_testing
