#!/bin/sh
# import_any.sh: recordings in dresses made by chance (language, separator, decimal sign, encoding, units, columns, faults)
# become the numbers that they were made of, without a hint. check: once
. tests/cli/common
command -v python3 >/dev/null || { echo "there is no python3"; exit 77; }
python3 "$ROOT/tests/cli/import_any.py" files "${COUNT:-150}" "${SEED:-1}" || fail "files"
for file in files/*.truth; do
    name=${file%.truth}
    "$PALPATE" import $(ls $name.* | grep -v truth) --out out >/dev/null 2>err || { fail "$name"; head -n 2 err; }
done
python3 "$ROOT/tests/cli/import_any.py" --compare files out || fail "numbers"
done_testing
