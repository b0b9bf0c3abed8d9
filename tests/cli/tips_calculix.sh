#!/bin/sh
# tips_calculix.sh: random presses that CalculiX makes, on meshes and at places that the tables do not have, give its modulus within 2 %. With
# TIPS_DEEP=1 also five deep presses of spheres and cones, which take half of the time. check: all
. tests/cli/common
command -v ccx >/dev/null || { echo "ccx is not installed"; exit 77; }
command -v python3 >/dev/null || { echo "there is no python3"; exit 77; }
kinds="small large narrow stick sphere cone" wanted=17
[ -z "${TIPS_DEEP-}" ] || kinds="" wanted=22
# shellcheck disable=SC2086
python3 "$ROOT/tests/cli/tips_calculix.py" "$PALPATE" "$SCRATCH" $kinds >cases 2>wrong || fail "tips_calculix.py: $(tail -n 3 wrong)"
[ "$(wc -l <cases)" -eq "$wanted" ] || fail "$(wc -l <cases) cases, not $wanted"
awk '{ d = $NF - 1; if (d < 0) d = -d; if (!(d <= 0.02)) { print; bad = 1 } } END { exit bad }' cases || fail "a modulus beyond 2 %"
# The tables are those of the forces.
cp -r "$ROOT/data/tips" tips && mkdir -p lib/material && sed -i 's,"../../lib/material/,"../lib/material/,' tips/make_tables.py
python3 tips/make_tables.py && cmp lib/material/indentation_tables.h "$ROOT/lib/material/indentation_tables.h" || fail "lib/material/indentation_tables.h is not of data/tips/forces.csv"
done_testing
