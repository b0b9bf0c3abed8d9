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

page() { # file: well formed, self-contained
    grep -q '^<!DOCTYPE html>' "$1" && grep -q '</html>' "$1" || fail "$1 is no page"
    grep -o '\(src\|href\)="[^"#][^"]*"' "$1" | grep -v -e '^href="#' -e '^src="data:image/svg+xml,' | grep -q . && fail "$1 refers to another file"
    grep -iq '<script\|@import\|<link\|onload=\|javascript:\|<foreignobject' "$1" && fail "$1 is not self-contained"
    grep -q 'a<b>' "$1" && fail "$1: a name is not escaped"
    grep -o ' id="[^"]*"' "$1" | sort | uniq -d | grep -q . && fail "$1: an id is there twice"
}

# Recordings and a model: the report computes the rest.
expect 0 report runs $L --title 'A < B' --out page.html
[ -s out ] && fail "wrote to stdout in spite of --out"
page page.html
for text in '<h1>A &lt; B</h1>' 'What was measured' 'Recorded curves' 'Stiffness law' 'Provenance' 'a&lt;b&gt;&amp;c.csv' \
    'free air' '24 mm high'; do
    grep -qF "$text" page.html || fail "the page lacks \"$text\""
done
grep -q 'Network calibration' page.html && fail "a network out of nothing"
crc=$(gzip -c runs/hold2.csv | tail -c 8 | od -An -tx1 | awk '{ print $4 $3 $2 $1 }')
grep -qi "$crc" page.html || fail "CRC-32 of hold2.csv is not $crc"
expect 0 report runs $L
page out

# The rows of a table stand in the order of the key beside its figure, whatever the files are called.
mkdir named
for depth in 4 6 8; do
    expect 0 simulate $L --protocol ramp_hold --depth-mm $depth --hold-s 5 --sample-Hz 20 --air-s 1 --noise-N 0.004 --seed $depth --out named/run$((13 - depth)).csv
done
cp runs/a* named/run6.csv
expect 0 report named $L --out named.html
rows=$(sed -n '/What was measured/,/<\/table>/p' named.html | grep -o 'run[0-9]*\.csv' | tr '\n' ' ')
[ "$rows" = "run6.csv run9.csv run7.csv run5.csv " ] || fail "rows in the order $rows"
if command -v gnuplot >/dev/null; then
    key=$(sed -n '/Recorded curves/,/<\/figure>/p' named.html | grep -o '>[468] mm<' | uniq | tr -d '\n')
    [ "$key" = ">4 mm<>6 mm<>8 mm<" ] || fail "the key has the order $key"
fi

# With results of characterize and calibrate, and a simulation.
expect 0 characterize runs/*.csv --arms 2 --degree 3 --out work/lumped.json --plot work
expect 0 calibrate work/lumped.json --nodes 3 --depth-mm 2,5 --hold-s 20 --degree 3 --out work/network.json --plot work
grep -q '"calibrate": 1' work/calibrate.json || fail "no calibrate.json"
expect 0 simulate work/network.json --protocol ramp_hold --depth-mm 5 --hold-s 60 --sample-Hz 20 --band --out work/simulated.csv
expect 0 report runs work --out all.html
page all.html
for text in 'Fits and residuals' 'Parameters' '95 % interval' 'Network calibration' '3 × 3 × 3 nodes' \
    'Simulation against recordings' '<td class="t">hold5.csv</td>' 'palpate characterize runs/' 'palpate calibrate work/'; do
    grep -qF "$text" all.html || fail "the page lacks \"$text\""
done
if command -v gnuplot >/dev/null; then
    # Over time: the network's band, named once in the key; against depth: the model on the ramp and hold.
    sed -n '/Simulation against/,/Provenance/p' all.html >simulations
    grep -q '95 % band' simulations || fail "no band about the network's force"
    grep -q 'Force against depth, loops included' all.html || fail "no force against depth"
    # A ramp that is not held may be far from static.
    grep -q 'Ramps without a dwell' all.html && ! grep -q '>Static press[ :][^<]*raw' all.html || fail "a ramp is called static"
    [ "$(grep -c '<figure>' all.html)" -ge 19 ] || fail "only $(grep -c '<figure>' all.html) figures"
fi
[ "$(wc -c <all.html)" -lt 4000000 ] || fail "a page of $(wc -c <all.html) bytes: curves are not thinned"

# What cannot be read: named outright it fails, in a folder it is warned of and listed.
echo '{"a": 1}' >work/strange.json
echo 'no run' >work/broken.csv
echo '<svg onload="alert(1)"><SCRIPT>alert(2)</SCRIPT><a href="javascript:alert(3)"/><script>alert(4)</script></svg>' >work/evil.svg
echo '<svg width="9">' >work/cut.svg
expect 0 report work --out more.html
[ "$(grep -c 'warning: work/' err)" -eq 3 ] || fail "not three warnings: $(cat err)"
grep -q '<figcaption>evil.svg</figcaption>' more.html || fail "a foreign figure is not there as an image"
grep -q 'strange.json' more.html || fail "a file that was not used is not listed"
page more.html
expect 1 report work/broken.csv --out no.html; says "palpate report: work/broken.csv"
expect 1 report work/strange.json; says "no JSON that palpate writes"
expect 1 report nowhere; says "palpate report: nowhere"
mkdir empty
expect 1 report empty; says "holds nothing that palpate writes"
expect 2 report; says "name a folder or files"
expect 1 report runs --out nowhere/page.html; says "nowhere/page.html"
[ -e no.html ] && fail "a page in spite of failure"
ls . work | grep -q tmp && fail "a temporary file was left behind"

mkdir path
expect 0 report runs $L --out page.html
PATH_WAS=$PATH
PATH=$SCRATCH/path "$PALPATE" report runs $L --out plain.html >out 2>err
code=$?
PATH=$PATH_WAS
[ $code -eq 0 ] || fail "without gnuplot: exit code $code"
says "warning: gnuplot is not installed"

# A warning that names parameters says what they are; a run's name stands whole in what characterize prints.
long=the_press_of_the_first_monday_with_a_long_name_1.csv
"$PALPATE" simulate $DATA/lumped_n1.json --protocol ramp_hold --depth-mm 3 --hold-s 2 --sample-Hz 20 --noise-N 0.05 --air-s 1 --out $long
mkdir few
expect 0 characterize $long --arms 2 --degree 3 --plot few
grep -q "^  $long  *[0-9]" out || fail "the run's name is cut: $(grep monday out)"
[ "$(grep -c 'not determined by these data' err)" = 1 ] || fail "not one warning of all parameters: $(cat err)"
expect 0 report few --out few.html
grep -q 'coefficients of a polynomial stiffness law K(e)' few.html || fail "c1 is not said to be what it is"

# The page begins with what explain found, each effect with its numbers.
mkdir found
cat >found/explain.json <<'J'
{"palpate": {"explain": 1}, "verdict": "explained",
 "effects": [{"id": "sensor_lag", "parameters": {"time_s": 0.05}, "intervals": {"time_s": [0.045, 0.055]}, "class": ["sensor_lag"]}],
 "gap": {"noise_level_N": 0.002, "heldout_before_N": 0.014, "heldout_after_N": 0.002, "closed": 1, "unexplained_N": 0}}
J
expect 0 report found --out found.html
sed -n '/class="verdict explained"/,/class="cards"/p' found.html >first
grep -q 'Here: time 0.0500 s (0.0450 to 0.0550)' first || fail "the page does not begin with what is missing: $(cat first)"
grep -q 'href="#explain"' first && grep -q 'id="explain"' found.html || fail "the first box does not lead to the section"
done_testing
