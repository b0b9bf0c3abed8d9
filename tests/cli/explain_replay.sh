#!/bin/sh
# explain_replay.sh: the model that explain writes, simulated along the runs, leaves what explain said, and needs gains
# that average 1. Each run has a zero, a gain and a contact of its own, as explain gives it.
. tests/cli/common

rows() { grep '^[-+0-9]' "$1"; }
lower() { awk -F, -v by="$3" '/^[-+0-9]/ { printf "%s,%.12g,%s\n", $1, $2 - by, $3; next } { print }' "$1" >"$2"; }

# follow MODEL RUN CONTACT OUT: forces along the run, its surface so many mm deeper
follow() {
    lower "$2" like.csv "$3"
    rm -f along.csv
    expect 0 simulate "$1" --like like.csv --out along.csv
    rows along.csv | cut -d, -f3 >"$4"
}

# own RUN HERE DEEPER: zero, gain, step of the contact (mm), squares left and samples by least squares
own() {
    rows "$1" | cut -d, -f3 | paste -d, - "$2" "$3" | awk -F, '
        { x[0] = 1; x[1] = $2; x[2] = ($3 - $2) / 0.001; x[3] = $1; n++
          for (i = 0; i < 4; i++) for (j = 0; j < 4; j++) a[i, j] += x[i] * x[j] }
        END { for (k = 0; k < 3; k++) for (i = 0; i < 4; i++) if (i != k) {
                  f = a[i, k] / a[k, k]
                  for (j = 0; j < 4; j++) a[i, j] -= f * a[k, j] }
              g = a[1, 3] / a[1, 1]
              print a[0, 3] / a[0, 0], g, a[2, 3] / a[2, 2] / g, a[3, 3], n }'
}

# in_free FILE KEY: the number of that key in the free terms
in_free() { sed -n '/"free_term"/,$p' "$1" >free && value free "$2"; }

# replay NAME RUN...: of NAME.json and NAME.out, its free terms too
replay() {
    name=$1
    shift
    : >own
    for run in "$@"; do
        contact=0
        for round in 1 2 3; do
            follow $name.json "$run" "$contact" here
            follow $name.json "$run" "$(awk -v c="$contact" 'BEGIN { print c + 0.001 }')" deeper
            set_of=$(own "$run" here deeper)
            contact=$(echo "$contact $set_of" | awk '{ print $1 + $4 }')
        done
        echo "$set_of" >>own
    done
    near "$name: gains of the replay" "$(awk '{ g += $2 } END { print g / NR }' own)" 1 0.01
    near "$name: what the replay leaves" "$(awk '{ s += $4; n += $5 } END { print sqrt(s / n) }' own)" \
        "$(if grep -q '"free_term"' $name.out; then in_free $name.out after_N; else value $name.out after_N; fi)" 0.05
}

# model COEFFICIENTS EFFECTS >FILE
model() {
    cat <<J
{"palpate": {"model": 1}, "kind": "lumped", "specimen": {"height_mm": 24},
 "stiffness": {"kind": "polynomial", "coefficients_N": [$1]},
 "arms": [{"stiffness_N": 2.1, "viscosity_Ns": 12}], "effects": [$2], "formulation": "history"}
J
}

# runs NAME [N]: presses, then zeros, gains and contacts of their own, and a zero that settles alike by N newtons
runs() {
    n=0
    settles=${2-0}
    for press in "4 1 0.03 1.03 0.05" "6 2 -0.01 0.98 -0.04" "7 0.5 0.02 1.01 0.02" "5 1 -0.03 0.97 -0.06"; do
        set -- "$1" $press
        n=$((n + 1))
        expect 0 simulate true.json --protocol ramp_hold --depth-mm $2 --ramp-s $3 --hold-s 20 --sample-Hz 20 \
            --air-s 3 --noise-N 0.004 --seed $n --out plain.csv
        awk -F, -v z=$4 -v g=$5 -v c=$6 -v s=$settles '
            /^[-0-9]/ { printf "%s,%.9g,%.9g\n", $1, $2 + c, z + g * $3 + s * exp(-$1 / 2); next } { print }' \
            plain.csv >$1$n.csv
        rm plain.csv
    done
}

model "8.2, 3.1" "" >guess.json

# Another law, and an effect beside one that the given model has already.
model "5.2, 0.5, 90" "" >true.json
runs law
expect 0 explain --model guess.json law?.csv --result law.out --out law.json
grep -q '"verdict": "another_law"' law.out || fail "another law: $(cat out)"
replay law law?.csv

model "8.2, 3.1" '{"id": "sensor_lag", "parameters": {"time_s": 0.1}}' >true.json
runs lag
expect 0 explain --model guess.json lag?.csv --result lag.out --out lag.json
grep -q '"id": "sensor_lag"' lag.json || fail "a lag: $(cat out)"
replay lag lag?.csv
grep -q '"free_term"' law.out lag.out && fail "a free term where nothing is missing"

# What is in no catalogue: the zero of each run settles alike. The model has it as a function of the time in the run,
# and the gap on runs left out is closed.
model "8.2, 3.1" "" >true.json
runs free 0.05
expect 0 explain --model guess.json free?.csv --candidates sensor_drift,sensor_lag,coulomb_friction --result free.out --out free.json
grep -q '"verdict": "unexplained"' free.out || fail "a zero that settles: $(cat out)"
grep -q '"class": "of the clock"' free.out || fail "no term of the clock: $(cat out)"
grep -q '"model": 3' free.json || fail "the version of a model with a free term"
near "share of the gap that it closes" "$(in_free free.out closed)" 1 0.2
replay free free?.csv

# tester NAME RING BENDS CURES: presses, in all of which a frame rings by RING newtons for a change of the speed by 1 mm/s, the sensor's gain
# depends on the place by a share of BENDS, and the specimen becomes stiffer by a share of CURES a second
tester() {
    n=0
    for press in "cyclic --depth-mm 7 --rate-mm-s 6" "cyclic --depth-mm 5 --rate-mm-s 2" "cyclic --depth-mm 7 --rate-mm-s 3" \
        "ramp_hold --depth-mm 7 --ramp-s 1 --hold-s 10" "ramp_hold --depth-mm 4 --ramp-s 1 --hold-s 10"; do
        n=$((n + 1))
        expect 0 simulate true.json --protocol $press --sample-Hz 50 --air-s 1 --noise-N 0.004 --seed $n --out plain.csv
        awk -F, -v ring=$2 -v bends=$3 -v cures=$4 '
            /^[-0-9]/ { speed = samples ? ($2 - depth) / ($1 - time) : 0
                if (samples++ && (speed - was) ^ 2 > 1e-6) { at[++n] = time; by[n] = speed - was }
                was = speed; time = $1; depth = $2; more = 0
                for (i = 1; i <= n; i++) { s = $1 - at[i]; more += by[i] * exp(-s / 0.25) * sin(16 * s) }
                printf "%s,%s,%.9g\n", $1, $2, $3 * (1 + bends * sin(1.5 * $2) + cures * $1) + ring * more; next } { print }' plain.csv >$1$n.csv
        rm plain.csv
    done
}
for case in "ring 0.02 0 0 time_since_change_of_speed dissipative" "gain 0 0.05 0 place_times_force place" \
    "cure 0 0 0.01 time_in_run_times_force age"; do
    set -- $case
    tester $1 $2 $3 $4
    expect 0 explain --model guess.json $1?.csv --candidates sensor_drift,coulomb_friction,frame_compliance --result $1.out --out $1.json
    grep -q '"depends_on": "'$5'"' $1.json || fail "$1: no term: $(cat out)"
    grep -q '"class": "[a-z ]*'$6'"' $1.out || fail "$1: class: $(cat out)"
    grep -q '"id": "frame_compliance"' $1.json && fail "$1: the frame is named for what has no name: $(cat out)"
    near "$1: share of the gap that it closes" "$(in_free $1.out closed)" 1 0.2
    replay $1 $1?.csv
done
grep -q '"is not needed beside a free term"' cure.out || fail "the reason why the frame was removed: $(grep -A9 frame_compliance cure.out)"
done_testing
