#!/bin/sh
# pictures.sh: what `make pictures` runs: makes every picture of doc/pictures/ from the product itself.
#   press.png and so on         the window of examples/poke, moved by press.poke, cut.poke and nodule.poke
#   explain.png                 the page that palpate explain writes in `make demo`
#   press.json, explain.json    the figures in the picture of that name; tests/install/pictures.sh compares them with the README
#   panel.png                   the page of palpate panel, in the middle of a run of the virtual indenter
#   static.svg, relaxation.svg  palpate calibrate on the thesis' phantom
#   table_4_2.svg and so on    tables of the thesis over depth (data/sedef2008/compare.py)
#   pipeline.svg, layers.svg    drawn by Graphviz from the .dot file of the same name
# Needs build/palpate and build/examples/poke/poke; tools/install-deps pictures installs the other tools.
set -eu
cd "$(dirname "$0")/.."
palpate=${PALPATE:-build/palpate}
poke=$(dirname "$palpate")/examples/poke/poke
out=doc/pictures
work=$(mktemp -d)
server=
trap '[ -z "$server" ] || kill $server; rm -rf "$work"' EXIT

for figure in pipeline layers; do
    dot -Tsvg "$out/$figure.dot" -o "$out/$figure.svg"
done

"$palpate" calibrate data/sedef2008/lumped_n2.json --nodes 3 --scaling none --strain-dependent --law spline --out "$work/network.json" \
    --report "$work/calibrate.html" >/dev/null
python3 tools/picture.py "$work/calibrate.html" "$out/static.svg" static_fit
python3 tools/picture.py "$work/calibrate.html" "$out/relaxation.svg" relaxation_log
PALPATE=$palpate python3 data/sedef2008/compare.py 4.2 4.3 5.7 --plot "$work" >/dev/null # and 5.8, which takes many minutes
for table in "$work"/table_*.json; do
    name=${table##*/}
    python3 tools/picture.py "$table" "$out/${name%.json}.svg"
done

# A palette of 256 colours makes a picture of the window four to twenty times smaller.
compress() { pngquant --force --strip --output "$2" 256 "$1"; }

Xvfb -displayfd 3 -screen 0 1280x800x24 -nolisten tcp >/dev/null 2>&1 3>"$work/display" &
server=$!
for second in 1 2 3 4 5 6 7 8 9 10; do [ -s "$work/display" ] && break; sleep 1; done
DISPLAY=:$(cat "$work/display") LIBGL_ALWAYS_SOFTWARE=1
export DISPLAY LIBGL_ALWAYS_SOFTWARE
# figures NAME: keeps the JSON on standard input as NAME.json, with the version and the sum of NAME.png, to which it belongs.
figures() {
    python3 -c '
import hashlib, json, sys
name, version = sys.argv[1:]
picture = hashlib.sha256(open(name + ".png", "rb").read()).hexdigest()
json.dump({"version": version, "picture_sha256": picture, "figures": json.load(sys.stdin)}, open(name + ".json", "w"), indent=2)
open(name + ".json", "a").write("\n")' "$out/$1" "$("$palpate" --version | sed 's/palpate //')"
}
window() { # NAME FRAMES [MODEL]: how many frames NAME.poke lasts
    "$poke" ${3+"$3"} --script "$out/$1.poke" --frames "$2" --size 1200x750 --screenshot "$work/$1.png" --json "$work/$1.json" >/dev/null
    compress "$work/$1.png" "$out/$1.png"
}
window press 277
figures press <"$work/press.json"
window cut 122
window nodule 320 data/models/liver_nodule.json

PALPATE=$palpate tools/demo.sh >/dev/null
chromium --headless --no-sandbox --disable-gpu --hide-scrollbars --window-size=1060,1105 --screenshot="$work/explain.png" \
    "file://$PWD/build/demo/explain.html" >/dev/null 2>&1
compress "$work/explain.png" "$out/explain.png"
python3 -c '
import json, sys
found = json.load(sys.stdin)
gap = {key[:-2] + "_mN": 1000 * value for key, value in found["gap"].items() if key.endswith("_N")}
effects = [{key: effect[key] for key in ("id", "parameters", "intervals")} for effect in found["effects"]]
json.dump({"verdict": found["verdict"], "effects": effects, "gap": gap}, sys.stdout)' <build/demo/explain.json | figures explain

"$palpate" panel --port rig --firmware host --contact-mm 2 --out "$work/runs" >"$work/address" 2>/dev/null &
server="$server $!"
while ! [ -s "$work/address" ]; do sleep 0.1; done
python3 - "$(cat "$work/address")" <<'END' # two runs, the second up to 8 s into it
import json, sys, time, urllib.request
address, token = sys.argv[1].split("/?token=")
def ask(path, body=None):
    request = urllib.request.Request(address + path, json.dumps(body).encode() if body else None, {"X-Palpate-Token": token})
    return json.load(urllib.request.urlopen(request))
runs = [{"kind": "ramp_hold", "depth_mm": 3, "ramp_s": 0.5, "hold_s": 2, "rest_s": 0}, {"kind": "cyclic", "depth_mm": 3, "rate_mm_s": 2, "cycles": 20, "rest_s": 3}]
ask("/start", {"palpate": {"protocol": 1}, "runs": runs})
while not (ask("/live?point=1000000000")["state"]["run"] or {}).get("name") == "cyclic_3mm": time.sleep(0.1)
time.sleep(8)
END
chromium --headless --no-sandbox --disable-gpu --hide-scrollbars --window-size=1300,1130 --virtual-time-budget=4000 \
    --screenshot="$work/panel.png" "$(cat "$work/address")" >/dev/null 2>&1
compress "$work/panel.png" "$out/panel.png"

find "$out" -name '*.png' -size +300k -o -name '*.svg' -size +300k | sed 's/$/: larger than 300 KB/'
ls -l "$out"/*.png "$out"/*.svg
