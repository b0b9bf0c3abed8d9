#!/bin/sh
# explain_rig.sh: the virtual indenter with an effect switched on, recorded through its firmware, a plain model fitted to
# that, and explained: the effect is named and its parameters are the rig's; where another would do as well, the
# experiments that are asked for next are run on the same rig and tell them apart.
. tests/cli/common

"$PALPATE" rig --until-s 0.1 --firmware host >/dev/null 2>err || { cat err; echo "there is no host firmware"; exit 77; }

# A phantom that has recovered soon, so that rests are short.
model() { # EFFECT PARAMETERS
    cat <<J
{"palpate": {"model": 1}, "kind": "lumped", "specimen": {"kind": "cylinder", "height_mm": 24, "radius_mm": 12},
 "stiffness": {"kind": "polynomial", "coefficients_N": [8, 2, 30]},
 "arms": [{"stiffness_N": 2.5, "viscosity_Ns": 1}],
 "effects": [{"id": "$1", "parameters": {$2}}]}
J
}

cat >protocol.json <<'J'
{"palpate": {"protocol": 1}, "order": "given", "hold_s": 3, "air_s": 0.5, "after_s": 2, "rest_s": 40,
 "runs": [
    {"kind": "free", "name": "air", "depth_mm": 4, "rate_mm_s": 8, "hold_s": 1},
    {"kind": "static", "depth_mm": 6, "rate_mm_s": 1},
    {"kind": "ramp_hold", "depth_mm": 3, "rate_mm_s": 10},
    {"kind": "ramp_hold", "depth_mm": 6, "rate_mm_s": 3},
    {"kind": "cyclic", "depth_mm": 5, "rate_mm_s": 4, "cycles": 3},
    {"kind": "ramp_hold", "depth_mm": 3, "rate_mm_s": 10, "name": "again"}]}
J

# found EFFECT KEY: the value that the explained model has; nothing where it lacks the effect.
found() { sed -n "s/.*\"$1\", \"parameters\": {.*\"$2\": *\([-+.0-9eE]*\).*/\1/p" explained.json; }

every=20 # samples
# Each session has other noise, so the 5 % of sessions in which chance alone is named must be fewer here.
alarm=0.0001
explain() { # RUNS...
    expect 0 explain --model plain.json "$@" --every $every --false-alarm $alarm --out explained.json --result result.json --next next.json
    cp out "said_$name"
}

verdict() { sed -n 's/^ *"verdict": "\([a-z]*\)".*/\1/p' result.json; }

# session NAME EFFECT PARAMETERS: recorded, characterized with the one arm that the phantom has, explained.
session() {
    name=$1
    model "$2" "$3" >rig.json
    rm -f next.json
    expect 0 acquire --port rig:rig.json --firmware host --protocol protocol.json --out "$1"
    expect 0 characterize "$1"/*.csv --arms 1 --degree 3 --out plain.json
    explain "$1"/*.csv
}

# ---- an instrument, and a material ----
session lag sensor_lag '"time_s": 0.02'
near "time of the lag" "$(found sensor_lag time_s)" 0.02 0.1
[ "$(verdict)" = explained ] || fail "lag: $(cat said_lag)"

every=40
session beta strain_dependent_arm '"stiffness_per_strain": 3, "time_per_strain": 1'
near "growth of the arm" "$(found strain_dependent_arm stiffness_per_strain)" 3 0.1
near "growth of its time" "$(found strain_dependent_arm time_per_strain)" 1 0.1
[ "$(verdict)" = explained ] || fail "beta: $(cat said_beta)"

# ---- an arm of 6 s, of which holds of 3 s show too little: the next experiments run by themselves ----
alarm=0.005 # a smaller one wants more experiments until it takes two effects apart
session arm relaxation_arm '"stiffness_N": 0.5, "time_s": 6'
expect 1 acquire --port rig:rig.json --firmware host --protocol protocol.json --out none --until-explained none.json
[ ! -e none ] || fail "it moved although the model is not there"
expect 0 acquire --port rig:rig.json --firmware host --protocol protocol.json --out until --until-explained plain.json --every $every --false-alarm $alarm --json
grep -q '"verdict": "explained"' out || fail "not explained: $(cat err)"
cp until/explained.json until/explain.json .
near "stiffness of the arm" "$(found relaxation_arm stiffness_N)" 0.5 0.1
near "time of the arm" "$(found relaxation_arm time_s)" 6 0.1
# Without time for an experiment it says what is left.
case $(verdict) in
ambiguous)
    expect 3 acquire --port rig:rig.json --firmware host --protocol protocol.json --out short --until-explained plain.json --every $every --false-alarm $alarm --budget-s 0.1
    grep -q 'several effects fit' err || fail "no word of the causes: $(cat err)" ;;
esac

# ---- the rig as it is: nothing to explain ----
expect 0 explain --model rig.json arm/*.csv --every $every --false-alarm $alarm --result result.json
[ "$(verdict)" = agrees ] || fail "the rig's own model: $(cat out)"
done_testing
