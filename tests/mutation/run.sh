#!/bin/sh
# run.sh: how many small errors of arithmetic the tests notice.
#   tests/mutation/run.sh [--count 104] [--seed 1] [--jobs N] [--out DIR] [FOLDER...]
# Each mutant is one edit, drawn from the seed (mutate.py), in a copy of the tree of its own under DIR. It is killed by the
# first of its folder's tests in `make check` that fails, or takes ten times as long. What does not compile is drawn again.
# Prints one line a mutant, the diffs of the survivors, and the share killed of each folder and of all.
set -u
cd "$(dirname "$0")/../.." || exit 1
root=$PWD

files_of() {
    case $1 in
    multigrid) echo lib/solve/multigrid*.c ;;
    *) echo "lib/$1"/*.c ;;
    esac
}
# The tests of a folder; what runs in `make check-all` only does not count.
tests_of() {
    case $1 in
    multigrid) ls tests/lib/solve/test_multigrid*.c tests/lib/realtime/test_*.c ;;
    data) ls tests/lib/data/test_*.c tests/lib/fit/test_fit*.c tests/cli/import.sh tests/cli/characterize.sh ;;
    fit) ls tests/lib/fit/test_*.c tests/cli/characterize.sh tests/cli/calibrate*.sh ;;
    explain) ls tests/lib/explain/test_*.c tests/cli/explain*.sh ;;
    contact) ls tests/lib/contact/test_*.c tests/lib/cut/test_cut_terms.c ;;
    reduce) ls tests/lib/reduce/test_*.c tests/cli/reduce.sh ;;
    *) ls "tests/lib/$1"/test_*.c ;;
    esac 2>/dev/null | while read -r t; do
        head -n 10 "$t" | grep -q 'check: all' || echo "${t%.c}"
    done
}
quick_first() { # the same, the quick ones first, as measured on the whole tree
    for t in $(tests_of "$1"); do awk -v t="$t" '$1 == t { print $2, t }' "$mutation_out/seconds"; done | sort -n | cut -d' ' -f2
}

build() { # tests: what they need, quietly, in the current tree
    for t in "$@"; do
        case $t in *.sh) echo build/palpate build/firmware/indenter_host ;; *) echo "build/$t" ;; esac
    done | sort -u | xargs ${MAKE:-make} --no-print-directory -s CC="$mutation_cc" >build.log 2>&1
}
run_test() { # test limit_s
    rm -rf scratch && mkdir scratch
    case $1 in
    *.sh) SCRATCH=$PWD/scratch PALPATE=build/palpate timeout -k 5 "$2" sh "$1" ;;
    *) SCRATCH=$PWD/scratch timeout -k 5 "$2" "build/$1" ;;
    esac >test.log 2>&1 </dev/null
}

if [ "${1-}" = one ]; then # folder number, from xargs: draws, builds and judges one mutant in the tree of its slot
    # shellcheck disable=SC2086
    set -- $2
    folder=$1 number=$2
    cd "$mutation_out/tree$SLOT" || exit 255
    try=0
    while :; do
        try=$((try + 1))
        # shellcheck disable=SC2046
        python3 "$root/tests/mutation/mutate.py" "$mutation_seed" "$folder" "$number.$try" $(files_of "$folder") >mutant.diff || exit 255
        file=$(sed -n 's/^--- //p' mutant.diff)
        # shellcheck disable=SC2046
        build $(tests_of "$folder") && break
        cp -p "$root/$file" "$file" && touch "$file"
    done
    by=
    for t in $(quick_first "$folder"); do
        limit=$(awk -v t="$t" '$1 == t { print int(30 + 0.01 * $2) }' "$mutation_out/seconds")
        if ! run_test "$t" "$limit"; then by=$t; break; fi
    done
    cp -p "$root/$file" "$file" && touch "$file"
    line=$(sed -n 's/^@@ -\([0-9]*\).*/\1/p' mutant.diff)
    echo "$folder ${by:-survives}" >>"$mutation_out/results"
    if [ -n "$by" ]; then
        echo "killed    $folder $number $file:$line by $by"
    else
        cp mutant.diff "$mutation_out/survivor_${folder}_$number.diff"
        echo "SURVIVES  $folder $number $file:$line"
    fi
    exit 0
fi

count=104 mutation_seed=1 jobs=$(nproc) mutation_out=$root/build/mutation folders=
while [ $# -gt 0 ]; do
    case $1 in
    --count) count=$2; shift ;;
    --seed) mutation_seed=$2; shift ;;
    --jobs) jobs=$2; shift ;;
    --out) mutation_out=$2; shift ;;
    *) folders="$folders $1" ;;
    esac
    shift
done
folders=${folders:-data explain fit contact cut reduce multigrid realtime}
mutation_cc=${CC:-gcc}
if command -v ccache >/dev/null && [ "$mutation_cc" = gcc ]; then mutation_cc="ccache gcc"; fi
OPENBLAS_NUM_THREADS=1 OMP_THREAD_LIMIT=1
export mutation_seed mutation_out mutation_cc OPENBLAS_NUM_THREADS OMP_THREAD_LIMIT
rm -rf "$mutation_out"
mkdir -p "$mutation_out/tree0"

# The first tree is built whole and must pass; the others are copies of it.
cd "$mutation_out/tree0" || exit 1
cp -pr "$root/lib" .
for entry in Makefile include tools firmware tests data examples bench doc; do ln -s "$root/$entry" "$entry"; done
all=$(for f in $folders; do tests_of "$f"; done | sort -u)
# shellcheck disable=SC2086
build $all || { cat build.log >&2; echo "the tree does not build" >&2; exit 1; }
for t in $all; do
    start=$(date +%s%N)
    run_test "$t" 1800 || { tail test.log >&2; echo "$t fails without a mutation" >&2; exit 1; }
    echo "$t $((($(date +%s%N) - start) / 1000000))"
done >"$mutation_out/seconds"
slot=1
while [ "$slot" -lt "$jobs" ]; do cp -pr . "../tree$slot"; slot=$((slot + 1)); done

cd "$root" || exit 1
n=0
while [ "$n" -lt "$count" ]; do
    for f in $folders; do
        if [ "$n" -lt "$count" ]; then n=$((n + 1)); echo "$f $n"; fi
    done
done | xargs -d '\n' -n 1 -P "$jobs" --process-slot-var=SLOT sh tests/mutation/run.sh one
for d in "$mutation_out"/survivor_*.diff; do [ -e "$d" ] && { echo; cat "$d"; }; done
awk '{ all[$1]++; n++ } $2 != "survives" { killed[$1]++; k++ }
    END { for (f in all) print f ": " killed[f] + 0 " of " all[f]; print "all: " k + 0 " of " n " killed" }' "$mutation_out/results"
