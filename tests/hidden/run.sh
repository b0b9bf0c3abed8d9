#!/bin/sh
# run.sh: hides effects in cases, has palpate explain find them, scores the answers. See README.md.
#   run.sh [--seed N] [--set all|quick] [--jobs N] [--out DIR] [--oracle] [--slack N] [--report-only]
#          [--print-table] [--every N]
# --every: explain takes one sample in N.
# From any folder; PALPATE is the command (default: build/palpate of this tree), CC compiles the generator.
# A run that was interrupted goes on in its --out: cases and answers that are there are kept while the seed,
# the set, the generator and the command are the same.
set -u
here=$(cd "$(dirname "$0")" && pwd)
PALPATE=${PALPATE:-$here/../../build/palpate}

if [ "${1-}" = one ]; then # from xargs: folder answer [ids]: one run of the command, in the case's own folder
    cd "$2" || exit 1
    [ ! -s "$3" ] || exit 0
    start=$(date +%s.%N) name=${3%.json}
    # shellcheck disable=SC2086
    "$PALPATE" explain --model model.json run_*.csv --jobs 1 ${EVERY:+--every $EVERY} ${4:+--candidates $4} --result "$3.part" \
        --out "${name}_model.json" --report "$name.html" >"$name.log" 2>&1 </dev/null || {
        echo "$(basename "$2"): exit code $?: $(tail -n 1 "$name.log")" >&2
        exit 0
    }
    [ "$3" = oracle.json ] || date +%s.%N | awk -v a="$start" '{ printf "%.2f\n", $1 - a }' >seconds
    mv "$3.part" "$3"
    exit 0
fi

# same FILE TEXT: whether FILE says TEXT
same() { [ -f "$1" ] && [ "$(cat "$1")" = "$2" ]; }

seed=1 set=all jobs=$(nproc) out='' oracle='' score='' EVERY=
while [ $# -gt 0 ]; do
    case $1 in
    --seed) seed=$2; shift ;;
    --set) set=$2; shift ;;
    --jobs) jobs=$2; shift ;;
    --out) out=$2; shift ;;
    --slack) score="$score --slack $2"; shift ;;
    --oracle) oracle=1 ;;
    --every) EVERY=$2; shift ;;
    --report-only | --print-table) score="$score $1" ;;
    *) sed -n '2,8s/^# //p' "$0"; exit 2 ;;
    esac
    shift
done
[ -x "$PALPATE" ] || { echo "run.sh: no command at $PALPATE; run make, or set PALPATE"; exit 1; }
PALPATE=$(cd "$(dirname "$PALPATE")" && pwd)/$(basename "$PALPATE")
export PALPATE EVERY OMP_THREAD_LIMIT=1 LC_ALL=C
if [ -z "$out" ]; then
    out=$(mktemp -d)
    trap 'rm -rf "$out"' EXIT
fi
mkdir -p "$out" && out=$(cd "$out" && pwd) || exit 1

set --
for source in "$here"/*.c; do
    [ "$source" = "$here/compare.c" ] || set -- "$@" "$source"
done
${CC:-cc} -std=c99 -O2 -ffp-contract=off "$@" -lm -o "$out/generate" || exit 1
cases="$seed $set $(cat "$@" "$here/hidden.h" | cksum)"
if ! same "$out/made" "$cases"; then
    "$out/generate" --self-test >"$out/self_test.log" || { cat "$out/self_test.log"; exit 1; }
    rm -rf "$out/made" "$out/cases"
    "$out/generate" --seed "$seed" --set "$set" --jobs "$jobs" --out "$out/cases" --truth "$out/truth.json" ||
        exit 1
    echo "$cases" >"$out/made"
fi
tool="$(cksum <"$PALPATE") $EVERY"
same "$out/asked" "$tool" || rm -f "$out"/cases/case_*/result.json "$out"/cases/case_*/oracle.json
echo "$tool" >"$out/asked"

for folder in "$out"/cases/case_*; do
    echo "$folder result.json"
done | xargs -L 1 -P "$jobs" sh "$here/run.sh" one
if [ -n "$oracle" ]; then
    python3 "$here/score.py" --truth "$out/truth.json" --list-oracle | while read -r name ids; do
        echo "$out/cases/$name oracle.json $ids"
    done | xargs -L 1 -P "$jobs" sh "$here/run.sh" one
fi
# shellcheck disable=SC2086
python3 "$here/score.py" --cases "$out/cases" --truth "$out/truth.json" $score
