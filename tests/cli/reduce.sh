#!/bin/sh
# reduce.sh: reduced models by the command: snapshots and held-out runs, the file, simulate, bad input. check: asan
. tests/cli/common

sed -e 's/\[3, 3, 3\]/[5, 5, 5]/' -e 's/"arms": \[\]/"arms": [{"stiffness_N": 0.14, "viscosity_Ns": 1.9}]/' \
    $DATA/network_27.json >net.json
press() { # file depth rate hold: down, held
    awk -v d="$2" -v r="$3" -v h="$4" 'BEGIN {
        print "# palpate.experiment: 1\n# protocol.kind: \"ramp_hold\"\ntime_s,depth_mm,force_N\n0,0,0"
        for (i = 1; i <= 12; i++) printf "%.9g,%.9g,0\n", d / r * i / 12, d * i / 12
        for (i = 1; i <= 8; i++) printf "%.9g,%.9g,0\n", d / r + h * i / 8, d }' >"$1"
}
press p1.csv 4 4 4; press p2.csv 5 20 2; press p3.csv 3 1 3; press p4.csv 4.5 9 3; press p5.csv 3.5 2 2

# Plate: the error on a run held out, and the same by simulate.
expect 0 reduce net.json --runs p1.csv,p2.csv p3.csv p4.csv --elements 300 --out reduced.json --json
[ "$(value out held_out_runs)" = 1 ] || fail "one run of four is held out"
[ "$(value out snapshot_runs)" = 3 ] || fail "snapshots are of three runs of four"
[ "$(value out unknowns)" = 243 ] || [ "$(value out unknowns)" = 225 ] || fail "unknowns: $(value out unknowns)"
awk -v m="$(value out modes)" -v e="$(value out elements)" -v all="$(value out network_elements)" \
    'BEGIN { exit !(m >= 2 && m < 40 && e > m && 5 * e < all) }' || fail "its size: $(cat out)"
bound=$(value out bound)
awk -v b="$bound" 'BEGIN { exit !(b > 0 && b < 0.01) }' || fail "bound $bound"
grep -q '"run": "p4.csv"' out || fail "the run held out is not named"
ls reduced.bin >/dev/null || fail "no reduced.bin"
expect 0 simulate net.json --like p5.csv --out full.csv
expect 0 simulate reduced.json --like p5.csv --out small.csv
grep '^[0-9]' full.csv >a; grep '^[0-9]' small.csv >b
paste -d, a b | awk -F, -v bound="$bound" '{ d = $3 - $6; if (d < 0) d = -d; if (d > worst) worst = d
    if ($3 > peak) peak = $3; if ($1 != $4 || $2 != $5) exit 1 } END { exit !(NR == 21 && peak > 1 && worst < bound * peak) }' ||
    fail "simulate: reduced and full differ by more than the bound"
expect 0 simulate reduced.json --protocol ramp_hold --depth-mm 4 --ramp-s 1 --hold-s 1 --json
peak=$(value out peak_force_N)
expect 0 simulate net.json --protocol ramp_hold --depth-mm 4 --ramp-s 1 --hold-s 1 --json
near "peak by protocol" "$peak" "$(value out peak_force_N)" 0.005

# The same answer with two threads, and a text.
expect 0 reduce net.json p1.csv p2.csv p3.csv p4.csv --elements 300 --jobs 2 --out again.json
grep -q "held out: p4.csv: largest error" out || fail "text: $(cat out)"
cmp -s reduced.bin again.bin || fail "two threads give other bits"

# A recorded depth has noise: the network follows the path without it, as in the fits.
noisy() { # file sd: 4 mm in 2 s, then held for 4 s, 400 samples
    awk -v sd="$2" 'BEGIN {
        print "# palpate.experiment: 1\n# protocol.kind: \"ramp_hold\"\ntime_s,depth_mm,force_N"
        for (i = 0; i < 400; i++) {
            for (sum = j = 0; j < 12; j++) { seed = (seed * 1103 + 12345) % 65536; sum += seed / 65536 }
            t = 0.015 * i; printf "%.9g,%.9g,0\n", t, (t < 2 ? 2 * t : 4) + sd * (sum - 6) } }' >"$1"
}
noisy still.csv 0; noisy noisy.csv 0.05
expect 0 reduce net.json p1.csv p2.csv still.csv --samples 400 --modes 10 --elements 300 --json
peak=$(value out peak_N)
expect 0 reduce net.json p1.csv p2.csv noisy.csv --samples 400 --modes 10 --elements 300 --json
near "peak with a noisy depth" "$(value out peak_N)" "$peak" 0.01

# A ball on a free top.
slide() { # file x0 z0 x1 z1
    awk -v x0="$2" -v z0="$3" -v x1="$4" -v z1="$5" 'BEGIN {
        print "# palpate.experiment: 1\n# tool.radius_mm: 8\ntime_s,depth_mm,force_N,tool_x_mm,tool_y_mm,tool_z_mm"
        for (i = 0; i <= 20; i++) { s = i < 10 ? 0 : (i - 10) / 10; d = i < 10 ? i / 10 : 1
            printf "%.9g,0,0,%.9g,%.9g,%.9g\n", 0.05 * i, x0 + s * (x1 - x0), 32.05 - 0.9 * d, z0 + s * (z1 - z0) } }' >"$1"
}
slide s1.csv 9 9 15 9; slide s2.csv 15 12 9 12; slide s3.csv 9 15 15 15; slide s4.csv 10 9 14 15
expect 0 reduce net.json s1.csv s2.csv s3.csv s4.csv --modes 20 --static-modes 2 --elements 400 --out ball.json --json
awk -v b="$(value out held_out_worst)" 'BEGIN { exit !(b > 0 && b < 0.05) }' || fail "ball: error $(value out held_out_worst)"
expect 1 simulate ball.json --protocol static --depth-mm 2
says "has no plate"

# Wrong usage and input: one line, nothing written.
bad() { # code text arguments...
    code=$1 text=$2; shift 2
    expect "$code" "$@"
    says "palpate $1: "
    says "$text"
}
bad 2 "name a NETWORK.json" reduce
bad 2 "name runs for the snapshots" reduce net.json
bad 2 "too few to hold one out" reduce net.json p1.csv
bad 2 "raise --modes" reduce net.json p1.csv p2.csv --modes 4 --static-modes 5
bad 2 "must be from 1 to" reduce net.json p1.csv --modes 0
bad 2 "must be one of auto|plate|bottom" reduce net.json p1.csv --supports top
bad 2 "must be from 0 to" reduce net.json p1.csv p2.csv --hold-out 1
bad 1 "none.json" reduce none.json p1.csv p2.csv
bad 1 "none.csv" reduce net.json p1.csv none.csv
bad 1 "needs no reduction" reduce $DATA/lumped_n1.json p1.csv p2.csv
sed 's/tool_z_mm/tool_w_mm/' s1.csv >half.csv
bad 1 "half.csv: a tool needs the columns" reduce net.json half.csv s2.csv
grep -v radius s1.csv >ballless.csv
bad 1 "ballless.csv: a tool needs the key tool.radius_mm" reduce net.json ballless.csv s2.csv
press deep.csv 25 5 1
bad 1 "deep.csv: depth_mm reaches 25" reduce net.json deep.csv p2.csv
bad 1 "no plate moves the top" reduce net.json p1.csv s2.csv s3.csv
bad 1 "nowhere/r" reduce net.json p1.csv p2.csv --out nowhere/r.json
bad 2 "follows a depth, not a force" simulate reduced.json --protocol creep --force-N 1
bad 2 "is reduced" simulate reduced.json --protocol static --depth-mm 1 --vtu frames
bad 2 "beyond the model's height" simulate reduced.json --protocol static --depth-mm 30
sed 's/"modes": [0-9]*/"modes": 3/' reduced.json >other.json
bad 1 "other.json:" simulate other.json --protocol static --depth-mm 1
sed 's/"reduced": 1/"reduced": 2/' reduced.json >two.json
bad 1 "two.json:3: palpate.reduced" simulate two.json --protocol static --depth-mm 1
printf 'x' >>reduced.bin
bad 1 "have the wrong length" simulate reduced.json --protocol static --depth-mm 1
cp again.bin reduced.bin; printf '\377' | dd of=reduced.bin bs=1 seek=3000 conv=notrunc 2>/dev/null
bad 1 "the wrong checksum" simulate reduced.json --protocol static --depth-mm 1
rm reduced.bin
bad 1 "reduced.bin" simulate reduced.json --protocol static --depth-mm 1
ls | grep -q tmp && fail "a temporary file was left behind: $(ls | grep tmp)"
done_testing
