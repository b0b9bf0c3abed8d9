#!/bin/sh
# next.sh: how many further runs tell hidden effects apart that a short session leaves ambiguous: designed ones
# (acquire --until-explained), those of a fixed list in its order, and random ones. On the virtual indenter.
#   tests/hidden/next.sh [CASES [SEED]]      default 20 1; PALPATE names the command, OUT keeps the files
set -eu
cd "$(dirname "$0")/../.."
cases=${1:-20} seed=${2:-1}
PALPATE=${PALPATE:-$PWD/build/palpate}
export OPENBLAS_NUM_THREADS=1
out=${OUT:-$(mktemp -d)}
[ -n "${OUT:-}" ] || trap 'rm -rf "$out"' EXIT
mkdir -p "$out"
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

cat >"$out/first.json" <<'J'
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

acquire() { "$PALPATE" acquire --port rig:"$dir/rig.json" --firmware host --seed "$k" "$@" >/dev/null 2>"$dir/err"; }
verdict() { sed -n 's/^ *"verdict": "\([a-z_]*\)".*/\1/p' "$1"; }
named() { sed -n '/"effects": \[/,/^  \]/s/^ *"id": "\([a-z_]*\)".*/\1/p' "$1" | tr '\n' ' '; }
explain() { # FOLDER
    "$PALPATE" explain --model "$dir/plain.json" "$1"/*.csv --every 8 --result "$1/explain.json" >/dev/null 2>"$dir/err" || return 1
}

printf '%-5s %-24s %-10s %-14s %s\n' case truth way verdict "runs named"
k=0
while [ $k -lt "$cases" ]; do
    k=$((k + 1))
    dir=$out/case_$k
    mkdir -p "$dir"
    set -- $(draw $k)
    truth=$1
    shift
    cat >"$dir/rig.json" <<J
{"palpate": {"model": 1}, "kind": "lumped", "specimen": {"kind": "cylinder", "height_mm": 24, "radius_mm": 12},
 "stiffness": {"kind": "polynomial", "coefficients_N": [8, 2, 30]}, "arms": [{"stiffness_N": 2.5, "viscosity_Ns": 1}],
 "effects": [{"id": "$truth", "parameters": {$*}}]}
J
    [ -d "$dir/first" ] || acquire --protocol "$out/first.json" --out "$dir/first"
    "$PALPATE" characterize "$dir"/first/*.csv --arms 1 --degree 3 --out "$dir/plain.json" >/dev/null 2>"$dir/err"
    explain "$dir/first"
    if [ "$(verdict "$dir/first/explain.json")" != ambiguous ]; then
        printf '%-5s %-24s %-10s %-14s %s\n' $k "$truth" first "$(verdict "$dir/first/explain.json")" "0 $(named "$dir/first/explain.json")"
        continue
    fi
    acquire --protocol "$out/first.json" --out "$dir/designed" --force --until-explained "$dir/plain.json" --every 8 \
        --budget-s 600 || true
    printf '%-5s %-24s %-10s %-14s %s\n' $k "$truth" designed "$(verdict "$dir/designed/explain.json")" \
        "$(ls "$dir"/designed | grep -c '^next.*csv') $(named "$dir/designed/explain.json")"
    for way in ${WAYS-listed random}; do
        rm -rf "${dir:?}/$way"
        cp -r "$dir/first" "$dir/$way"
        n=0
        while [ $n -lt $most ] && [ "$(verdict "$dir/$way/explain.json")" = ambiguous ]; do
            n=$((n + 1))
            if [ $way = listed ]; then listed $n; else random $k $n; fi >"$dir/run.json"
            acquire --protocol "$dir/run.json" --out "$dir/$way/next$n" && mv "$dir/$way/next$n"/*.csv "$dir/$way/next$n.csv"
            rmdir "$dir/$way/next$n"
            explain "$dir/$way" || break
        done
        printf '%-5s %-24s %-10s %-14s %s\n' $k "$truth" $way "$(verdict "$dir/$way/explain.json")" "$n $(named "$dir/$way/explain.json")"
    done
done
