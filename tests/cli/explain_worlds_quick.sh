#!/bin/sh
# explain_worlds_quick.sh: four cases of laboratories that are not ours, from recordings to the missing effect. check: all
. tests/cli/common
command -v python3 >/dev/null || { echo "there is no python3, which judges the answers"; exit 77; }
PALPATE=$PALPATE sh "$ROOT/tests/hidden/worlds/run.sh" --seed 101 --set quick --jobs 1 --out worlds >out 2>&1 || {
    fail "not all of four answers are right"
    cat out
}
grep -q "^4 of 4 cases" out || fail "not four cases were judged: $(cat out)"
done_testing
