#!/bin/sh
# panel_browser.sh: the page of palpate panel in a headless Chromium, against the virtual indenter. check: all
. tests/cli/common

expect 1 panel --port /dev/none --out x
if grep -q "without libmicrohttpd" err; then
    echo "this palpate has no page: install libmicrohttpd-dev and build it again"; exit 77
fi
command -v python3 >/dev/null || { echo "there is no python3"; exit 77; }
command -v chromium >/dev/null || command -v chromium-browser >/dev/null || command -v google-chrome >/dev/null ||
    { echo "there is no chromium"; exit 77; }
export PALPATE
PYTHONDONTWRITEBYTECODE=1 timeout 1500 python3 "$ROOT/tests/cli/panel/test_browser.py" || fail "test_browser.py: $(cat panel.err)"
done_testing
