#!/bin/sh
# run.sh: builds and runs tests, one line each, the sum last. Called by make with BUILD and MAKE set.
#   tests/run.sh check|rest|asan
# check: the gcc build and each of its tests once, in minutes. rest: what check-all adds to a check just done: the
# sanitizers, by clang where it is installed, valgrind, a fuzzer, the long tests. asan: the sanitizers alone.
# A comment in a test's first ten lines says where it runs:
#   nothing            in check; programs under the sanitizers in rest too
#   "check: once"      a slow one: in check only
#   "check: all"       a long one, of statistics mostly: in rest, as gcc optimizes it
#   "check: valgrind"  (programs) under valgrind too
#   "check: asan"      (tests/cli) with the sanitized command too
#   "check: petsc"     (tests/cli) in rest only, with the command of make PETSC=1, where PETSc is installed
# Tests run from the root with SCRATCH, an empty folder of their own; tests/cli/*.sh get PALPATE, the command.
# Exit code 77 means skipped: said, not counted, and a failure where CI=true. 78 is the same, but never a failure:
# what the test needs is no Debian package.
set -u
cd "$(dirname "$0")/.." || exit 1
BUILD=${BUILD:-build} MAKE=${MAKE:-make}
export BUILD MAKE
logs=$BUILD/check

report() { # label exit_code seconds log
    case $2 in
    0) word=ok ;;
    77) if [ "${CI-}" = true ]; then word=FAIL; else word=skip; fi ;;
    78) word=skip ;;
    *) word=FAIL ;;
    esac
    echo "$word $1" >>"$logs/results"
    case $word in
    ok) printf 'ok    %s (%s s)\n' "$1" "$3" ;;
    skip) printf 'skip  %s: %s\n' "$1" "$(tail -n 1 "$4")" ;;
    FAIL) printf 'FAIL  %s (exit code %s, %s)\n%s\n' "$1" "$2" "$4" "$(tail -n 40 "$4" | sed 's/^/      | /')" ;;
    esac
}

run() { # label command...
    label=$1; shift
    name=$(echo "$label" | tr ' /' '__')
    SCRATCH=$PWD/$logs/$name.scratch
    export SCRATCH
    mkdir -p "$SCRATCH"
    start=$(date +%s)
    timeout --foreground -k 10 1800 "$@" >"$logs/$name.log" 2>&1 </dev/null
    report "$label" $? $(($(date +%s) - start)) "$logs/$name.log"
}

if [ "${1-}" = one ]; then # one line of the list, from xargs: label, tab, command
    tab=$(printf '\t')
    run "${2%%"$tab"*}" sh -c "${2#*"$tab"}"
    exit 0
fi

mode=${1:-check}
if [ "$mode" != rest ] || [ ! -e "$logs/results" ]; then # the rest is added to the sum of a check
    rm -rf "$logs"
    mkdir -p "$logs"
    : >"$logs/results"
    : >"$logs/planned"
fi
: >"$logs/list"
jobs=$(nproc)
case ${MAKEFLAGS-} in *-j*) j= ;; *) j=-j$jobs ;; esac

# Memory that is not set holds a pattern, so that a result that depends on it is wrong in the plain run.
export OPENBLAS_NUM_THREADS=1 MALLOC_PERTURB_=165 ASAN_OPTIONS=detect_leaks=1 UBSAN_OPTIONS=print_stacktrace=1

build() { # label variables and targets...
    label=$1; shift
    echo "build $label" >>"$logs/planned"
    run "build $label" $MAKE --no-print-directory -k $j "$@"
}
add() { printf '%s\t%s\n' "$1" "$2" >>"$logs/list"; }
tagged() { head -n 10 "$1" | grep -q "check: $2"; }
sources() { ls tests/lib/test_*.c tests/lib/*/test_*.c tests/tools/test_*.c tests/firmware/test_*.c 2>/dev/null; }
programs() { # label folder: the test programs
    for t in $(sources); do
        if tagged "$t" all || { [ "$1" = asan ] && tagged "$t" once; }; then continue; fi
        add "$1 ${t%.c}" "$2/${t%.c}"
    done
}
scripts() { # label folder: the runs of its command
    for t in tests/cli/*.sh; do
        if tagged "$t" all || { [ "$1" != gcc ] && ! tagged "$t" "$1"; }; then continue; fi
        if [ "$1" = gcc ] && tagged "$t" petsc; then continue; fi
        add "$1 ${t%.sh}" "PALPATE=$2/palpate sh $t"
    done
}
long() { # the long ones, first, since they take longest
    for t in $(sources); do
        if tagged "$t" all; then add "long ${t%.c}" "$BUILD/${t%.c}"; fi
    done
    for t in tests/cli/*.sh; do
        if tagged "$t" all; then add "long ${t%.sh}" "PALPATE=$BUILD/palpate sh $t"; fi
    done
}
missing() { run "$1" sh -c "echo there is no $2; exit 77"; echo "$1" >>"$logs/planned"; }
sanitized() {
    if command -v clang >/dev/null; then # the second compiler of everything
        build asan BUILD="$BUILD/asan" SANITIZE=1 CC=clang tests programs
    else
        build asan BUILD="$BUILD/asan" SANITIZE=1 tests
        missing "build clang" clang
    fi
    programs asan "$BUILD/asan"
    scripts asan "$BUILD/asan"
    add "asan seeds of the fuzzed readers" "sh tests/fuzz/run.sh seeds"
}
optimized() {
    man=$(command -v scdoc >/dev/null && echo man)
    # shellcheck disable=SC2086
    build gcc BUILD="$BUILD" all programs $man
    if command -v arm-none-eabi-gcc >/dev/null; then
        build firmware BUILD="$BUILD" firmware
    else
        missing "build firmware" arm-none-eabi-gcc
    fi
}

case $mode in
check)
    optimized
    scripts gcc "$BUILD"
    programs gcc "$BUILD"
    add "installed library" "sh tests/install/run.sh && sh tests/install/cmake.sh"
    add "Python package" "sh tests/install/python.sh"
    add "exported symbols" "sh tests/install/symbols.sh"
    add "public headers" "sh tests/install/headers.sh"
    add "manual pages" "sh tests/install/manual.sh"
    add "what documents name" "sh tests/install/documents.sh"
    add "figures of the pictures" "sh tests/install/pictures.sh"
    add "columns of the sources" "sh tests/format.sh"
    add "layers" "sh tests/layers.sh"
    add "layers, what they find" "sh tests/layers.sh --self-test"
    ;;
rest)
    long
    sanitized
    if pkg-config --exists PETSc mpi-c; then
        build petsc BUILD="$BUILD/petsc" PETSC=1 WERROR=1 all
        scripts petsc "$BUILD/petsc"
        add "layers, with PETSc" "BUILD=$BUILD/petsc sh tests/layers.sh"
    else
        missing "build petsc" "PETSc; tools/install-deps petsc"
    fi
    if command -v clang >/dev/null; then
        add "installed library, with clang" "sh tests/install/run.sh"
        add "public headers, with clang" "sh tests/install/headers.sh"
    fi
    memcheck="valgrind -q --error-exitcode=99 --leak-check=full"
    command -v valgrind >/dev/null || memcheck="echo there is no valgrind; exit 77;"
    for t in $(sources); do
        # A processor type that valgrind knows, whatever the real one is.
        if tagged "$t" valgrind; then add "valgrind ${t%.c}" "OPENBLAS_CORETYPE=Haswell $memcheck $BUILD/${t%.c}"; fi
    done
    add "packed tree" "sh tests/install/dist.sh"
    add "format of the sources" "sh tests/format.sh --style"
    add "fuzzed readers" "sh tests/fuzz/run.sh"
    ;;
asan)
    sanitized
    ;;
esac
cut -f 1 "$logs/list" >>"$logs/planned"

xargs -d '\n' -n 1 -P "$jobs" sh tests/run.sh one <"$logs/list"

skipped=$(grep -c '^skip' "$logs/results")
passed=$(grep -c '^ok' "$logs/results")
failed=$(($(wc -l <"$logs/planned") - skipped - passed)) # what vanished has failed
if [ "$failed" -gt 0 ]; then grep '^FAIL' "$logs/results"; fi
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
