#!/bin/sh
# report.sh: one page that needs nothing else, with every section the files give. check: asan
. tests/cli/common

L=$DATA/lumped_n2.json
mkdir runs work
for depth in 2 5; do
    expect 0 simulate $L --protocol ramp_hold --depth-mm $depth --hold-s 60 --sample-Hz 100 --air-s 1 --noise-N 0.004 \
        --seed $depth --out runs/hold$depth.csv
done
expect 0 simulate $L --protocol static --depth-mm 9 --sample-Hz 50 --air-s 1 --noise-N 0.004 --seed 9 --out "runs/a<b>&c.csv"

# Recordings and a model: the report computes the rest.
expect 0 report runs $L --title 'A < B' --out page.html
[ -s out ] && fail "wrote to stdout in spite of --out"
in_page page.html
for text in '"title": "A < B"' 'a<b>&c.csv' '"free air"' '"height_mm": 24' '"name": "recordings_static"' '"name": "fit_log"'; do
    grep -qF "$text" shown || fail "the page lacks $text"
done
grep -q '"calibrate"\|"network"' shown && fail "a network out of nothing"
crc=$(gzip -c runs/hold2.csv | tail -c 8 | od -An -tx1 | awk '{ print $4 $3 $2 $1 }')
grep -qi "\"crc32\": \"$crc\"" shown || fail "CRC-32 of hold2.csv is not $crc"
expect 0 report runs $L
cp out stdout.html && in_page stdout.html

# The rows of a table stand in the order of the key beside its figure, whatever the files are called.
mkdir named
for depth in 4 6 8; do
    expect 0 simulate $L --protocol ramp_hold --depth-mm $depth --hold-s 5 --sample-Hz 20 --air-s 1 --noise-N 0.004 --seed $depth --out named/run$((13 - depth)).csv
done
cp runs/a* named/run6.csv
expect 0 report named $L --out named.html
in_page named.html
rows=$(sed -n '/^  "recordings"/,/^  \],*/p' shown | grep -o 'run[0-9]*\.csv' | tr '\n' ' ')
[ "$rows" = "run6.csv run9.csv run7.csv run5.csv " ] || fail "rows in the order $rows"
key=$(sed -n '/"recordings_linear"/,/"recordings_log"/p' shown | grep -o '"[468] mm"' | tr -d '\n')
[ "$key" = '"4 mm""6 mm""8 mm"' ] || fail "the key has the order $key"

# With results of characterize and calibrate, and a simulation.
expect 0 characterize runs/*.csv --arms 2 --degree 3 --out work/lumped.json --result work/characterize.json
expect 0 calibrate work/lumped.json --nodes 3 --depth-mm 2,5 --hold-s 20 --degree 3 --out work/network.json --result work/calibrate.json
grep -q '"calibrate": 1' work/calibrate.json || fail "no calibrate.json"
expect 0 simulate work/network.json --protocol ramp_hold --depth-mm 5 --hold-s 60 --sample-Hz 20 --band --out work/simulated.csv
expect 0 report runs work --out all.html
in_page all.html
for text in '"characterize": 1' '"calibrate": 1' '"kind": "lattice"' '"recording": "runs/hold5.csv"' 'palpate characterize runs/' 'palpate calibrate work/'; do
    grep -qF "$text" shown || fail "the page lacks $text"
done
grep -o '"name": "[a-z_]*"' shown | sort >all_figures
for name in recordings_linear recordings_log recordings_first recordings_static fit_linear fit_log fit_first fit_depth fit_static residuals static_fit \
    stiffness relaxation_linear relaxation_log simulated_linear simulated_log; do
    [ "$(grep -c "\"$name\"" all_figures)" -eq 1 ] || fail "not one figure $name"
done
# Over time: the network's band, named once in the key.
[ "$(sed -n '/"simulated_linear"/,/"simulated_log"/p' shown | grep -c '"95 % band"')" -eq 1 ] || fail "no band about the network's force"
# A band whose upper edge is not in the file is none.
awk -F, -v OFS=, '/^time_s/ { for (i = 1; i <= NF; i++) if ($i == "force_high_N") $i = "other" } { print }' work/simulated.csv >half_a_band.csv
grep -q force_low_N half_a_band.csv || fail "the simulation has no band"
expect 0 report runs/hold5.csv half_a_band.csv --out half.html
in_page half.html
grep -q '"style": "band"' shown && fail "a band of one edge"
[ "$(wc -c <all.html)" -lt 2000000 ] || fail "a page of $(wc -c <all.html) bytes: curves are not thinned"

# What cannot be read: named outright it fails, in a folder it is warned of and listed.
echo '{"a": 1}' >work/strange.json
echo 'no run' >work/broken.csv
expect 0 report work --out more.html
[ "$(grep -c 'warning: work/' err)" -eq 2 ] || fail "not two warnings: $(cat err)"
in_page more.html
grep -q 'strange.json' shown || fail "a file that was not used is not listed"
expect 1 report work/broken.csv --out no.html; says "palpate report: work/broken.csv"
expect 1 report work/strange.json; says "not a JSON file of palpate"
expect 1 report nowhere; says "palpate report: nowhere"
mkdir empty
expect 1 report empty; says "has no recording, model or result of palpate"
expect 2 report; says "name a folder or files"
expect 1 report runs --out nowhere/page.html; says "nowhere/page.html"
[ -e no.html ] && fail "a page in spite of failure"
ls . work | grep -q tmp && fail "a temporary file was left behind"

# A warning that names parameters says what they are; a run's name stands whole in what characterize prints.
long=the_press_of_the_first_monday_with_a_long_name_1.csv
"$PALPATE" simulate $DATA/lumped_n1.json --protocol ramp_hold --depth-mm 3 --hold-s 2 --sample-Hz 20 --noise-N 0.05 --air-s 1 --out $long
mkdir few
expect 0 characterize $long --arms 2 --degree 3 --result few/result.json
grep -q "^  $long  *[0-9]" out || fail "the run's name is cut: $(grep monday out)"
[ "$(grep -c 'not identifiable from these data' err)" = 1 ] || fail "not one warning of all parameters: $(cat err)"
expect 0 report few --out few.html
grep -q 'c[0-9].* not identifiable from these data' few.html || fail "the warning is not on the page"


# Whatever a file is called, it is text on the page, and runs nothing: quotes, line ends, a terminal's codes, markup, no UTF-8.
mkdir hostile
i=0
for name in "'" '"' '$(touch PW)' '`touch PW`' '<script>alert(1)<' '&lt;' '--' "$(printf 'q\nsystem "touch PW"\n')" "$(printf 'a\tb')" "$(printf '\033[31mred')" \
    "$(printf 'Messung\344')" "$(printf 'cut\303')" '</script' "$(printf '\342\200\250')"; do
    i=$((i + 1))
    [ "${name#*/}" = "$name" ] && cp runs/hold2.csv "hostile/$name$i.csv"
done
expect 0 report hostile $L --title "$(printf '</script><b>\344')" --out hostile.html
in_page hostile.html
[ "$(grep -c '"crc32"' shown)" -eq 14 ] || fail "not every file is on the page"
for name in "'1" '$(touch PW)3' '<script>alert(1)<5' '&lt;6' 'q?system' 'a?b9' '?[31mred10' 'Messung?11'; do
    grep -qF "hostile/$name" shown || fail "$name is not on the page as text"
done
LC_ALL=C grep -q "$(printf '[\001-\010\013-\037]')" hostile.html && fail "a control character is on the page"
expect 0 characterize hostile/Messung*.csv --arms 1 --degree 2 --out latin.json --result latin_result.json --report latin.html
in_page latin.html latin_result.json
expect 0 explain --model latin.json hostile/Messung*.csv hostile/q*.csv --candidates sensor_bias --result latin_explain.json --report latin_explain.html
in_page latin_explain.html latin_explain.json
[ "$(grep -c '"experiment": "hostile/' shown)" -ge 2 ] || fail "the runs have no names: $(grep experiment shown)"
expect 0 report latin_result.json latin_explain.json hostile --out latin_all.html
in_page latin_all.html
[ -e PW ] || [ -e hostile/PW ] && fail "a file's name was run"
done_testing
