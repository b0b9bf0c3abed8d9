#!/bin/sh
# run.sh: writes the cases of laboratories that are not ours, takes each the whole way (characterize, then explain), judges the answers.
#   run.sh [--seed N] [--set all|quick|testers|outside] [--jobs N] [--out DIR] [--oracle] [--report-only] [--print-table]
# The set outside is what comes again in all runs and is in no catalogue.
# From any folder; PALPATE is the command (default: build/palpate of this tree), CC compiles the generator. A run that was interrupted
# goes on in its --out (palpate batch) while the seed, the set, the generator and the command are the same. See ../README.md.
set -u
here=$(cd "$(dirname "$0")" && pwd)
PALPATE=${PALPATE:-$here/../../../build/palpate}

same() { [ -f "$1" ] && [ "$(cat "$1")" = "$2" ]; } # whether FILE says TEXT

seed=1 set=all jobs=$(nproc) out='' oracle='' judge=''
while [ $# -gt 0 ]; do
    case $1 in
    --seed) seed=$2; shift ;;
    --set) set=$2; shift ;;
    --jobs) jobs=$2; shift ;;
    --out) out=$2; shift ;;
    --oracle) oracle=oracle ;;
    --report-only | --print-table) judge="$judge $1" ;;
    *) sed -n '2,7s/^# //p' "$0"; exit 2 ;;
    esac
    shift
done
[ -x "$PALPATE" ] || { echo "run.sh: no command at $PALPATE; run make, or set PALPATE"; exit 1; }
export OMP_THREAD_LIMIT=1 OPENBLAS_NUM_THREADS=1 LC_ALL=C
if [ -z "$out" ]; then
    out=$(mktemp -d)
    trap 'rm -rf "$out"' EXIT
fi
mkdir -p "$out" || exit 1

set -- "$here"/*.c "$here/../random.c" "$here/../path.c" "$here/../kinds.c"
cases="$seed $set $(cat "$@" "$here"/*.h "$here/../hidden.h" | cksum)"
if ! same "$out/made" "$cases"; then
    rm -rf "$out/made" "$out/cases" "$out/asked"
    ${CC:-cc} -std=c99 -O2 -ffp-contract=off "$@" -lm -o "$out/worlds" &&
        "$out/worlds" --self-test >"$out/self_test.log" && "$out/worlds" "$set" "$seed" "$out/cases" "$out/truth.json" || {
        cat "$out/self_test.log"
        exit 1
    }
    echo "$cases" >"$out/made"
fi
tool=$(cksum <"$PALPATE")
same "$out/asked" "$tool" || rm -rf "$out/characterize" "$out/explain" "$out/oracle"
echo "$tool" >"$out/asked"

ulimit -t 900 # of each process
for step in characterize explain $oracle; do
    python3 "$here/judge.py" "$out" --manifest "$step" >"$out/$step.json"
    "$PALPATE" batch "$out/$step.json" --jobs "$jobs" --out "$out/$step"
done
[ "$set" != outside ] || exec python3 "$here/judge_free.py" "$out"
# shellcheck disable=SC2086
python3 "$here/judge.py" "$out" $judge
