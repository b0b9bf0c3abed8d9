#!/bin/sh
# next.sh: how many further runs tell hidden effects apart that a short session leaves ambiguous: designed ones
# (acquire --until-explained), those of a fixed list in its order, and random ones. On the virtual indenter.
#   tests/hidden/next.sh [CASES [SEED]]      default 20 1; PALPATE names the command, OUT keeps the files
# A run that was killed goes on in its OUT: each step takes all cases, by palpate batch.
set -eu
cases=$(seq "${1:-20}") seed=${2:-1}
palpate=$(realpath "${PALPATE:-$(dirname "$0")/../../build/palpate}")
out=${OUT:-$(mktemp -d)}
[ -n "${OUT:-}" ] || trap 'rm -rf "$out"' EXIT
mkdir -p "$out"
cd "$out"
most=6 # further runs

# draw CASE: id and parameters of the hidden effect, strength and time over two decades that the session shows in part
draw() {
    awk -v seed="$((seed * 1000 + $1))" 'BEGIN {
        srand(seed)
        split("relaxation_arm poroelastic power_law_relaxation", id)
        k = 1 + int(3 * rand()); s = exp(log(0.3) + rand() * log(4)); t = exp(log(2) + rand() * log(10))
        if (k < 3) printf "%s \"stiffness_N\": %.4g, \"time_s\": %.4g\n", id[k], s, t
        else printf "%s \"stiffness_N\": %.4g, \"exponent\": %.4g\n", id[k], s, 0.05 + 0.3 * rand()
    }'
}

cat >first.json <<'J'
{"palpate": {"protocol": 1}, "hold_s": 3, "air_s": 0.2, "after_s": 0.5, "rest_s": 60,
 "runs": [{"kind": "ramp_hold", "depth_mm": 3, "rate_mm_s": 10}, {"kind": "ramp_hold", "depth_mm": 6, "rate_mm_s": 3},
    {"kind": "cyclic", "depth_mm": 5, "rate_mm_s": 4, "cycles": 2}]}
J

# One run of the list, or a random one within the same limits. run KIND DEPTH RATE HOLD CYCLES
run() {
    printf '{"palpate": {"protocol": 1}, "air_s": 0.1, "after_s": 0.2, "runs": [{"kind": "%s", "depth_mm": %s, "rate_mm_s": %s%s}]}\n' \
        "$1" "$2" "$3" "$(case $1 in cyclic) echo ", \"cycles\": $5" ;; ramp_hold | free) echo ", \"hold_s\": $4" ;; esac)"
}
listed() { # N: what explain listed before it designed, relative to what the session did
    case $(($1 % 8)) in
    1) run ramp_hold 6 10 18 0 ;; 2) run ramp_hold 3 10 18 0 ;; 3) run ramp_hold 6 0.3 3.6 0 ;; 4) run static 6 0.3 0 0 ;;
    5) run cyclic 6 3 0 4 ;; 6) run cyclic 3.6 8 0 10 ;; 7) run cyclic 6 3 0 2 ;; 0) run free 3.6 8 0.1 0 ;;
    esac
}
random() { # CASE N
    set -- $(awk -v seed="$((seed * 1000 + $1 * 10 + $2 + 500))" 'BEGIN {
        srand(seed); cyclic = rand() < 0.5
        printf "%s %.3g %.3g %.3g %d", cyclic ? "cyclic" : "ramp_hold", 1.5 + 4.5 * rand(), 10 / 64 ^ rand(), 60 / 64 ^ rand(), 1 + int(15 * rand())
    }')
    run "$@"
}

batch() { # STEP 'COMMAND' CASES...
    step=$1 command=$2
    shift 2
    [ $# -eq 0 ] || "$palpate" batch --template "$command" "$@" --out "$step" >/dev/null || true
}
acquire='acquire --port rig:{input}/rig.json --firmware host --seed {input} --force'
explain='explain --model {input}/plain.json --every 8 --json {input}/first/*.csv'
verdict() { sed -n 's/^ *"verdict": "\([a-z_]*\)".*/\1/p' "$1"; }
row() { # CASE WAY RUNS ANSWER
    printf '%-5s %-24s %-10s %-14s %s\n' "$1" "$(sed -n 's/.*"effects": \[{"id": "\([a-z_]*\)".*/\1/p' "$1/rig.json")" "$2" "$(verdict "$4")" \
        "$3 $(sed -n '/"effects": \[/,/^  \]/s/^ *"id": "\([a-z_]*\)".*/\1/p' "$4" | tr '\n' ' ')"
}

for k in $cases; do
    mkdir -p "$k"
    set -- $(draw "$k")
    truth=$1
    shift
    cat >"$k/rig.json" <<J
{"palpate": {"model": 1}, "kind": "lumped", "specimen": {"kind": "cylinder", "height_mm": 24, "radius_mm": 12},
 "stiffness": {"kind": "polynomial", "coefficients_N": [8, 2, 30]}, "arms": [{"stiffness_N": 2.5, "viscosity_Ns": 1}],
 "effects": [{"id": "$truth", "parameters": {$*}}]}
J
done
batch first "$acquire --protocol first.json --out {input}/first" $cases
batch plain 'characterize {input}/first/*.csv --arms 1 --degree 3 --out {input}/plain.json' $cases
batch explained "$explain" $cases
printf '%-5s %-24s %-10s %-14s %s\n' case truth way verdict "runs named"
open=
for k in $cases; do
    if [ "$(verdict "explained/$k.out")" = ambiguous ]; then open="$open $k"; else row "$k" first 0 "explained/$k.out"; fi
done
batch designed "$acquire --protocol first.json --out {input}/designed --until-explained {input}/plain.json --every 8 --budget-s 600" $open
for k in $open; do row "$k" designed "$(ls "$k/designed" | grep -c '^next.*csv')" "$k/designed/explain.json"; done
for way in ${WAYS-listed random}; do
    left=$open n=0
    while [ -n "$left" ]; do
        n=$((n + 1)) still=
        for k in $left; do
            mkdir -p "$k/$way"
            if [ "$way" = listed ]; then listed $n; else random "$k" $n; fi >"$k/$way/$n.json"
        done
        batch "$way$n" "$acquire --protocol {input}/$way/$n.json --out {input}/$way/next$n" $left
        batch "$way${n}_explained" "$explain {input}/$way/next[1-$n]/*.csv" $left
        for k in $left; do
            answer=$way${n}_explained/$k.out
            if [ "$(verdict "$answer")" = ambiguous ] && [ $n -lt $most ]; then still="$still $k"; else row "$k" "$way" $n "$answer"; fi
        done
        left=$still
    done
done
