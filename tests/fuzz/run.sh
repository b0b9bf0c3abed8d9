#!/bin/sh
# run.sh: a bounded run of libFuzzer on the decoder of the indenter's protocol, from the golden frames; the same each time.
#   tests/fuzz/run.sh [RUNS]     default 400000; for long hunts e.g. 100000000
set -eu
cd "$(dirname "$0")/../.."
runs=${1:-400000}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
command -v clang >/dev/null || { echo "there is no clang"; exit 77; }
echo 'int LLVMFuzzerTestOneInput(const char *d, long n); int LLVMFuzzerTestOneInput(const char *d, long n) { return n < 0 && *d; }' >"$work/none.c"
clang -fsanitize=fuzzer,address,undefined -o "$work/none" "$work/none.c" 2>/dev/null ||
    { echo "clang has no libFuzzer"; exit 77; }

mkdir "$work/seeds" "$work/found"
grep -v -e '^#' -e = tests/data/wire/golden.txt | while read -r frame; do
    octal=
    for byte in $frame; do octal="$octal\\0$(printf %03o "0x$byte")"; done
    printf %b "$octal" >"$work/seeds/$(echo "$frame" | cut -c 4-5)"
done
clang -std=c99 -g -O1 -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=all -Iinclude -o "$work/fuzz_wire" \
    tests/fuzz/fuzz_wire.c tests/lib/wire_make.c lib/wire/wire.c
if ! "$work/fuzz_wire" -runs="$runs" -seed=1 -max_len=600 -artifact_prefix="$work/" "$work/found" "$work/seeds" \
    >"$work/log" 2>&1; then
    cat "$work/log"
    cp "$work"/crash-* "${SCRATCH:-.}" 2>/dev/null && echo "the input is kept in ${SCRATCH:-.}"
    exit 1
fi
grep -e '#.*DONE' -e '^Done' "$work/log"
