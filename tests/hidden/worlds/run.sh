#!/bin/sh
# run.sh: writes the cases of laboratories that are not ours, takes each the whole way (characterize, then explain), judges the answers.
#   run.sh [--seed N] [--set all|quick|testers|outside] [--jobs N] [--out DIR] [--oracle] [--likelihood] [--report-only] [--print-table]
# With --likelihood characterize is asked so. The set outside is what comes again in all runs and is in no catalogue.
# From any folder; PALPATE is the command (default: build/palpate of this tree), CC compiles the generator. A run that was interrupted
# goes on in its --out while the seed, the set, the generator and the command are the same. See ../README.md.
set -u
here=$(cd "$(dirname "$0")" && pwd)
PALPATE=${PALPATE:-$here/../../../build/palpate}

if [ "${1-}" = one ]; then # from xargs: folder, options of characterize: the whole way in the case's own folder
    cd "$2" || exit 1
    shift 2
    [ ! -e done ] || exit 0
    ulimit -t 900
    "$PALPATE" characterize run_*.csv "$@" $LIKELIHOOD --out model.json --force >characterize.log 2>&1 </dev/null &&
        "$PALPATE" explain --model model.json run_*.csv --jobs 1 --sparse --result result.json --out explained.json --force >explain.log 2>&1 </dev/null
    echo $? >done
    exit 0
fi
if [ "${1-}" = oracle ]; then # folder, ids: only what is true is a candidate
    cd "$2" || exit 1
    [ -e model.json ] && [ ! -e oracle.json ] || exit 0
    ulimit -t 900
    "$PALPATE" explain --model model.json run_*.csv --jobs 1 --candidates "$3" --result oracle.json >oracle.log 2>&1 </dev/null
    exit 0
fi

same() { [ -f "$1" ] && [ "$(cat "$1")" = "$2" ]; } # whether FILE says TEXT

seed=1 set=all jobs=$(nproc) out='' oracle='' judge='' LIKELIHOOD=
while [ $# -gt 0 ]; do
    case $1 in
    --seed) seed=$2; shift ;;
    --set) set=$2; shift ;;
    --jobs) jobs=$2; shift ;;
    --out) out=$2; shift ;;
    --oracle) oracle=1 ;;
    --likelihood) LIKELIHOOD=--likelihood ;;
    --report-only | --print-table) judge="$judge $1" ;;
    *) sed -n '2,7s/^# //p' "$0"; exit 2 ;;
    esac
    shift
done
[ -x "$PALPATE" ] || { echo "run.sh: no command at $PALPATE; run make, or set PALPATE"; exit 1; }
PALPATE=$(cd "$(dirname "$PALPATE")" && pwd)/$(basename "$PALPATE")
export PALPATE LIKELIHOOD OMP_THREAD_LIMIT=1 OPENBLAS_NUM_THREADS=1 LC_ALL=C
if [ -z "$out" ]; then
    out=$(mktemp -d)
    trap 'rm -rf "$out"' EXIT
fi
mkdir -p "$out" && out=$(cd "$out" && pwd) || exit 1

set -- "$here"/*.c "$here/../random.c" "$here/../path.c" "$here/../kinds.c"
cases="$seed $set $(cat "$@" "$here"/*.h "$here/../hidden.h" | cksum)"
if ! same "$out/made" "$cases"; then
    rm -rf "$out/made" "$out/cases"
    ${CC:-cc} -std=c99 -O2 -ffp-contract=off "$@" -lm -o "$out/worlds" &&
        "$out/worlds" --self-test >"$out/self_test.log" && "$out/worlds" "$set" "$seed" "$out/cases" "$out/truth.json" || {
        cat "$out/self_test.log"
        exit 1
    }
    echo "$cases" >"$out/made"
fi
tool="$(cksum <"$PALPATE") $LIKELIHOOD"
same "$out/asked" "$tool" || (cd "$out/cases" && rm -f case_*/done case_*/model.json case_*/result.json case_*/oracle.json)
echo "$tool" >"$out/asked"

list() { python3 "$here/judge.py" --truth "$out/truth.json" --list "$1" | sed "s|^|$1 $out/cases/|" | grep . ; }
list one | xargs -L 1 -P "$jobs" sh "$here/run.sh"
[ -z "$oracle" ] || list oracle | xargs -L 1 -P "$jobs" sh "$here/run.sh"
[ "$set" != outside ] || exec python3 "$here/judge_free.py" --cases "$out/cases" --truth "$out/truth.json"
# shellcheck disable=SC2086
python3 "$here/judge.py" --cases "$out/cases" --truth "$out/truth.json" $judge
