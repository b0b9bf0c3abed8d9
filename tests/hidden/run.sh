#!/bin/sh
# run.sh: hides effects in cases, has palpate explain find them, scores the answers. See README.md.
#   run.sh [--seed N] [--set all|quick] [--jobs N] [--out DIR] [--oracle] [--slack N] [--report-only]
#          [--print-table] [--every N]
# --every: explain takes one sample in N.
# From any folder; PALPATE is the command (default: build/palpate of this tree), CC compiles the generator.
# A run that was interrupted goes on in its --out: cases are kept while seed, set and generator are the same, answers
# (palpate batch in explain/ and oracle/) while the command is the same too.
set -u
here=$(cd "$(dirname "$0")" && pwd)
PALPATE=${PALPATE:-$here/../../build/palpate}

# same FILE TEXT: whether FILE says TEXT
same() { [ -f "$1" ] && [ "$(cat "$1")" = "$2" ]; }

seed=1 set=all jobs=$(nproc) out='' oracle='' score='' every=''
while [ $# -gt 0 ]; do
    case $1 in
    --seed) seed=$2; shift ;;
    --set) set=$2; shift ;;
    --jobs) jobs=$2; shift ;;
    --out) out=$2; shift ;;
    --slack) score="$score --slack $2"; shift ;;
    --oracle) oracle=oracle ;;
    --every) every="--every $2"; shift ;;
    --report-only | --print-table) score="$score $1" ;;
    *) sed -n '2,8s/^# //p' "$0"; exit 2 ;;
    esac
    shift
done
[ -x "$PALPATE" ] || { echo "run.sh: no command at $PALPATE; run make, or set PALPATE"; exit 1; }
export OMP_THREAD_LIMIT=1 LC_ALL=C
if [ -z "$out" ]; then
    out=$(mktemp -d)
    trap 'rm -rf "$out"' EXIT
fi
mkdir -p "$out" || exit 1

set --
for source in "$here"/*.c; do
    [ "$source" = "$here/compare.c" ] || set -- "$@" "$source"
done
${CC:-cc} -std=c99 -O2 -ffp-contract=off "$@" -lm -o "$out/generate" || exit 1
cases="$seed $set $(cat "$@" "$here/hidden.h" | cksum)"
if ! same "$out/made" "$cases"; then
    "$out/generate" --self-test >"$out/self_test.log" || { cat "$out/self_test.log"; exit 1; }
    rm -rf "$out/made" "$out/cases" "$out/asked"
    "$out/generate" --seed "$seed" --set "$set" --jobs "$jobs" --out "$out/cases" --truth "$out/truth.json" ||
        exit 1
    echo "$cases" >"$out/made"
fi
tool=$(cksum <"$PALPATE")
same "$out/asked" "$tool" || rm -rf "$out/explain" "$out/oracle"
echo "$tool" >"$out/asked"

# shellcheck disable=SC2086
for step in explain $oracle; do
    python3 "$here/score.py" "$out" --manifest "$step" $every >"$out/$step.json"
    "$PALPATE" batch "$out/$step.json" --jobs "$jobs" --out "$out/$step"
done
# shellcheck disable=SC2086
python3 "$here/score.py" "$out" $score
