#!/bin/sh
# run.sh: bounded runs of libFuzzer on every reader, from the files of the tests and seeds/; the same each time.
#   tests/fuzz/run.sh [RUNS [READER ...]]     default 10000 of each; for long hunts e.g. 10000000 mesh
#   tests/fuzz/run.sh seeds [READER ...]      each file once, with the compiler and objects of the sanitized build
set -eu
cd "$(dirname "$0")/../.."
runs=${1:-10000}
[ $# -eq 0 ] || shift
work=$(mktemp -d)
memory=$(mktemp -d /dev/shm/fuzz.XXXXXX 2>/dev/null) || memory=$(mktemp -d)
trap 'rm -rf "$work" "$memory"' EXIT
trap 'exit 1' HUP INT TERM
san=address,undefined
build() { ${MAKE:-make} --no-print-directory BUILD="$BUILD" "$@" "$BUILD/palpate" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }; }

if [ "$runs" = seeds ]; then
    BUILD=${BUILD:-build}/asan
    if command -v clang >/dev/null; then build SANITIZE=1 CC=clang; else build SANITIZE=1; fi # as tests/run.sh does
    compiler=$(sed 's/ -Iinclude.*//' "$BUILD/flags")
    fuzzer=
    driver=tests/fuzz/replay.c
else
    BUILD=${BUILD:-build}/fuzz
    compiler=clang
    fuzzer=fuzzer,
    driver=
    command -v clang >/dev/null || { echo "there is no clang"; exit 77; }
    echo 'int LLVMFuzzerTestOneInput(const char *d, long n); int LLVMFuzzerTestOneInput(const char *d, long n) { return n < 0 && *d; }' >"$work/none.c"
    clang -fsanitize=fuzzer,address,undefined -o "$work/none" "$work/none.c" 2>/dev/null ||
        { echo "clang has no libFuzzer"; exit 77; }

    # Comparisons of text guide the mutations, by the sanitizer's strcmp; those of numbers take half of the time.
    build SANITIZE= CFLAGS="-g -O2 -fsanitize=fuzzer-no-link,$san -fno-sanitize-coverage=trace-cmp -fno-sanitize-recover=all" \
        LDFLAGS="-fsanitize=$san" CC="${FUZZ_CC:-clang}"
fi
rm -f "$BUILD/tools.a"
find "$BUILD/obj/tools" -maxdepth 2 -name '*.o' ! -name palpate.o -exec ar qcs "$BUILD/tools.a" {} +

# seeds_of READER: the folder or files that it starts from
seeds_of() {
    ls -d tests/fuzz/seeds/"$1"/* 2>/dev/null || true
    case $1 in
    experiment) ls tests/data/bad/*.csv tests/fuzz/seeds/report/recording.csv ;;
    model) ls tests/data/bad/*.json data/models/*.json data/sedef2008/*.json ;;
    mesh) ls tests/data/mesh/*.msh ;;
    wire)
        grep -v -e '^#' -e = tests/data/wire/golden.txt | while read -r frame; do
            octal=
            for byte in $frame; do octal="$octal\\0$(printf %03o "0x$byte")"; done
            printf %b "$octal" >"$work/$(echo "$frame" | cut -c 4-5).frame"
        done
        ls "$work"/*.frame
        ;;
    esac
}

# words_of READER: the words in its sources, as libFuzzer's dictionary
words_of() {
    case $1 in
    import) sources=tools/import ;;
    protocol | calibration) sources=tools/acquire ;;
    script) sources=tools/rig ;;
    manifest) sources="tools/batch tools/benchmark" ;;
    *) sources=lib ;;
    esac
    find $sources -name '*.c' -exec grep -oh '"[A-Za-z0-9_.=:/% -]\{2,24\}"' {} + | sed 's/^"=/"/' | sort -u
}

[ $# -gt 0 ] || set -- experiment model mesh import protocol calibration script reduced report manifest wire
for reader in "$@"; do
    [ "$reader$driver" != wire ] || runs=$((40 * runs)) # no file is written for it
    TMPDIR=$work/$reader # a link: report takes a copy of what lies in /dev
    export TMPDIR
    mkdir -p "$memory/$reader/found" "$memory/$reader/seeds"
    ln -s "$memory/$reader" "$TMPDIR"
    seeds_of "$reader" | xargs -I{} cp {} "$TMPDIR/seeds"
    # shellcheck disable=SC2046
    $compiler -std=c99 -g -O2 -fsanitize=$fuzzer$san -fno-sanitize-recover=all -Iinclude -Itools -Ifirmware/core -Ifirmware/board \
        -o "$TMPDIR/fuzz" "tests/fuzz/fuzz_$reader.c" $driver $([ "$reader" != wire ] || echo tests/lib/wire_make.c) \
        "$BUILD/tools.a" "$BUILD/libindenter.a" "$BUILD/libpalpate.a" \
        $(${MAKE:-make} --no-print-directory -s libs)
    if [ "$driver" ]; then
        PATH=$work "$TMPDIR/fuzz" "$TMPDIR/seeds"/* >"$TMPDIR/log" 2>&1 || { echo "$reader:"; tail -n 60 "$TMPDIR/log"; exit 1; }
        echo "$reader: $(tail -n 1 "$TMPDIR/log")"
        continue
    fi
    words_of "$reader" >"$TMPDIR/words"
    # PATH: no spreadsheet's helper program takes part.
    if ! PATH=$work "$TMPDIR/fuzz" -runs="$runs" -seed=1 -max_len=16384 -timeout=20 -rss_limit_mb=4096 -close_fd_mask=3 \
        -artifact_prefix="$TMPDIR/" -dict="$TMPDIR/words" \
        "$TMPDIR/found" "$TMPDIR/seeds" >"$TMPDIR/log" 2>&1; then
        tail -n 60 "$TMPDIR/log"
        cp "$TMPDIR"/crash-* "$TMPDIR"/timeout-* "$TMPDIR"/oom-* "$TMPDIR"/leak-* "${SCRATCH:-.}" 2>/dev/null
        echo "$reader: the input is kept in ${SCRATCH:-.}"
        exit 1
    fi
    echo "$reader: $(sed -n 's/ *exec.*//; s/.*DONE *//p; s/^Done//p' "$TMPDIR/log" | tr '\n' ' ')"
done
