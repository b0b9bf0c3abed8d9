#!/bin/sh
# explain_worlds.sh: the generator of laboratories that are not ours, and their judge, hold their own tests (check: once).
# The run itself takes too long to be a test: see tests/hidden/README.md.
. tests/cli/common
command -v python3 >/dev/null || { echo "there is no python3, which judges the answers"; exit 77; }

hidden=$ROOT/tests/hidden
${CC:-cc} -std=c99 -O2 -ffp-contract=off "$hidden"/worlds/*.c "$hidden/random.c" "$hidden/path.c" "$hidden/kinds.c" -lm -o worlds ||
    fail "the generator does not build"
./worlds --self-test >out || fail "the generator: $(grep WRONG out)"
[ "$(grep -c "chi2 of a sample" out)" -eq 5 ] || fail "the noise of five laboratories was not looked at"
python3 "$hidden/worlds/judge.py" --self-test || fail "the judge"
python3 "$hidden/constants.py" --list >out 2>&1 || fail "$(cat out)"

# An answer that is not there is no right answer, and the exit code says so.
printf '{"seed": 1, "set": "all", "cases": [{"case": "case_001", "world": "cheap", "arms": 1, "effect": null, "outside": "", "nats": 0, "cosine": {}}]}' >truth.json
judge() { python3 "$hidden/worlds/judge.py" . >out; }
judge && fail "a run that has not begun was passed"
grep -q "^0 of 1 cases" out || fail "cases that were not asked for are counted: $(cat out)"
mkdir -p cases/case_001 characterize explain
echo '{"arms": []}' | tee cases/case_001/model.json >characterize/case_001.out
printf 'name,status,seconds\ncase_001,0,1\n' | tee characterize/table.csv >explain/table.csv
judge && fail "no answer was passed as right"
grep -q "case_001 no answer" out || fail "the missing answer is not listed: $(cat out)"
printf '{"verdict": "agrees", "effects": [], "gap": {}}' >explain/case_001.out
judge || fail "a null that agrees was not right: $(cat out)"
sed -i s/,0,/,1,/ explain/table.csv
judge && fail "an answer of a command that failed was passed as right"
done_testing
