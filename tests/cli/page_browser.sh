#!/bin/sh
# page_browser.sh: the pages of results in a headless Chromium: every figure, table and verdict is that of the JSON. check: all
. tests/cli/common
command -v python3 >/dev/null || { echo "there is no python3"; exit 77; }
command -v chromium >/dev/null || command -v chromium-browser >/dev/null || command -v google-chrome >/dev/null ||
    { echo "there is no chromium"; exit 77; }

L=$DATA/lumped_n2.json
sed 's/"arms"/"effects": [{"id": "sensor_lag", "parameters": {"time_s": 0.1}}], "arms"/' $L >lag.json
mkdir runs work
n=0
for press in "2 1" "4 0.5" "6 2" "2 1"; do
    set -- $press; n=$((n + 1))
    expect 0 simulate lag.json --protocol ramp_hold --depth-mm $1 --ramp-s $2 --hold-s 20 --sample-Hz 40 --air-s 2 --noise-N 0.004 --seed $n --out runs/hold$n.csv
done
mv runs/hold3.csv 'runs/<img src=x onerror=errors.push(3)>&amp;"'\''.csv' # what a page must not make an element of
expect 0 simulate lag.json --protocol static --depth-mm 7 --sample-Hz 20 --air-s 2 --noise-N 0.004 --seed 9 --out runs/static.csv
expect 0 characterize runs/*.csv --arms 2 --degree auto --out work/lumped.json --result work/characterize.json --report characterize.html
expect 0 explain --model $L runs/*.csv --candidates sensor_lag,sensor_bias --result work/explain.json --report explain.html
expect 0 calibrate $L --nodes 3 --depth-mm 2,4 --hold-s 20 --degree 2 --out work/network.json --result work/calibrate.json --report calibrate.html
expect 0 simulate work/network.json --like runs/hold2.csv --out work/simulated.csv
expect 0 report runs work --out report.html
{ printf '# palpate.experiment: 1\n# specimen.height_mm: 24\n# specimen.radius_mm: 12\ntime_s,depth_mm,force_N\n'
  awk 'BEGIN { for (i = 0; i < 800; i++) { t = i / 50; printf "%g,%.6f,0\n", t, (t < 2 ? 2 * (t - 1) : 2) + (t < 4 ? 0 : 0.3 * sin(6.2831853 * (t - 4))) } }'
} >path.csv
expect 0 simulate $L --like path.csv --noise-N 0.002 --out sine.csv
expect 0 characterize sine.csv --arms 1 --degree 2 --report sine.html
for factor in 0.8 1.3; do awk -F, -v OFS=, -v f=$factor '/^[0-9]/ { $3 *= f } { print }' runs/hold2.csv >other$factor.csv; done
expect 0 characterize runs/hold2.csv other*.csv --specimens file --arms 1 --degree 2 --report specimens.html
PYTHONDONTWRITEBYTECODE=1 timeout 1500 python3 "$ROOT/tests/cli/page_browser.py" || fail "page_browser.py"
done_testing
