#!/bin/sh
# explain_measured.sh: two specimens of a rubber as others measured them: a model's own faults are not taken for what
# differs from run to run, so the refit leaves little more than the fit of palpate characterize, which weighs all
# samples alike. Then what is right to say of the other sets (doc/explain-cases.md). check: once
. tests/cli/common

expect 0 import "$ROOT"/data/measured/ecoflex/*.csv --out ecoflex
for material in EF10_0T EF30_0T EF30_50T; do
    set -- ecoflex/${material}_A2.csv ecoflex/${material}_B2.csv
    expect 0 characterize "$@" --arms 0 --law mooney_rivlin5 --out model.json
    for run; do
        expect 0 simulate model.json --like "$run" --out like.csv
        grep '^[-0-9]' like.csv | cut -d , -f 3 >force
        grep '^[-0-9]' "$run" | cut -d , -f 3 | paste -d , - force
    done | awk -F , '{ sum += ($1 - $2) ^ 2 } END { print sqrt(sum / NR) }' >characterized
    expect 0 explain --model model.json "$@" --every 4 --result result.json
    awk -v a="$(value result.json before_N)" -v b="$(cat characterized)" 'BEGIN { exit !(a > 0 && a < 1.3 * b) }' ||
        fail "$material: the refit leaves $(value result.json before_N) N, characterize $(cat characterized) N"
done

# says RUNS... : the verdict of explain on them by model.json is one of $verdicts. No $accused is named, unless its class, which these runs
# cannot tell apart, has an effect of the material too.
accused='sensor_|adhesion'
says() {
    expect 0 explain --model model.json "$@" --result result.json
    got=$(sed -n 's/^ *"verdict": "\([a-z]*\)".*/\1/p' result.json)
    case " $verdicts " in *" $got "*) ;; *) fail "$1: $got, not $verdicts: $(cat out)" ;; esac
    sed -n '/^  "effects"/,/^  []}]/p' result.json | awk -F '"' -v accused="^($accused)" '/"id":/ { named = $4 } /"class":/ { class = 1; tissue = 0 }
        class && /^ *"[a-z_]*",?$/ { tissue = tissue || $2 !~ accused }
        class && /]/ { class = 0; if (named ~ accused && !tissue) bad = 1 } END { exit bad }' || fail "$1: told $(cat out)"
}

# One recording convicts no instrument. The site's ramp of four samples and its long hold leave three times the noise: no agreement.
verdicts="suspected unexplained"
expect 0 import "$ROOT"/data/measured/mach1/*.csv --specimen-height-mm 3 --out mach1
# The likelihood's polynomial, which two arms do not follow there, stays above zero: a model is written.
expect 0 characterize mach1/hayes_02_*.csv --arms 2 --law polynomial --out likely.json
expect 0 characterize mach1/hayes_02_*.csv --arms 2 --law polynomial --out model.json
says mach1/hayes_02_*.csv --every 20 --candidates relaxation_arm,poroelastic,strain_dependent_arm,sensor_drift
expect 0 characterize mach1/static_00*.csv --degree 2 --out model.json
says mach1/static_00*.csv --every 100 --candidates relaxation_arm,strain_dependent_arm,sensor_drift
# The same is said after a change of the last digits of the model, with another kernel of the linear algebra, if it has several.
told() { grep '^  [a-z_]*: ' out | sed 's/:.*//'; }
first=$(told)
sed -E 's/([0-9]\.[0-9]{8})[0-9]*/\1/g' model.json >near.json
export OPENBLAS_CORETYPE=Nehalem
expect 0 explain --model near.json mach1/static_00*.csv --every 100 \
    --candidates relaxation_arm,strain_dependent_arm,sensor_drift
unset OPENBLAS_CORETYPE
[ "$(told)" = "$first" ] || fail "a model with fewer digits: told $(cat out), not $first"
expect 0 import "$ROOT"/data/measured/afm/AFM_*.txt --specimen-height-mm 0.05 --out afm
expect 0 characterize afm/*.csv --out model.json
accused=sensor_ # the tip is pulled by 0.11 uN before it lets go: adhesion is there
says afm/*.csv --candidates relaxation_arm,adhesion,sensor_drift

# A muscle at four speeds, means over preparations: relaxation over four decades, which more arms than one follow. The sensor does not lag.
expect 0 import "$ROOT"/data/measured/titin/*.csv --units depth=stretch,force=kPa --specimen-height-mm 2 --specimen-area-mm2 0.5 --out titin
expect 0 characterize titin/*.csv --arms 1 --out model.json
grep -q 'the residual is .* of the peak .* palpate explain to find' err || fail "no word of a model that does not follow the runs: $(cat err)"
expect 0 explain --model model.json titin/*.csv --candidates relaxation_arm,sensor_lag --result result.json
[ "$(told | sort -u)" = '  relaxation_arm' ] || fail "titin, one arm: $(cat out)"
# The elastic force drives its arms (Fung). Found with the law, they leave nothing to explain; residuals are those of these arms.
expect 0 characterize titin/*.csv --out model.json --json
grep -q '"quasi_linear": true' model.json || fail "titin: the strain drives the arms"
awk '$1 == "\"rms_noise\":" { sub(",", "", $2); if ($2 > 5) bad = 1; n++ } END { exit bad || n < 4 }' out || fail "titin: $(grep rms_noise out)"
expect 0 explain --model model.json titin/*.csv --candidates relaxation_arm,sensor_lag --result result.json
[ -z "$(told)" ] || fail "titin: $(cat out)"
awk -v a="$(value result.json after_N)" 'BEGIN { exit !(a > 0 && a < 2.5e-4) }' ||
    fail "titin: more than the noise is left: $(cat out)"
done_testing
