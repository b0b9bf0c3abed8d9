#!/bin/sh
# measured.sh DIR [ROW]: imports, characterizes and explains the measured data of others (data/measured), the rows of
# doc/explain-cases.md, or those whose name has ROW in it: name, verdict, rms before and after, the same of runs left
# out, noise level; then the candidates that come first. DIR/characterize/ and DIR/explain/ keep all that was said; the
# same line again goes on where it was killed.
#     data/explain/measured.sh measured hayes_02
set -eu
here=$(cd "$(dirname "$0")/../measured" && pwd)
palpate=$(realpath "${PALPATE:-$here/../../build/palpate}")
mkdir -p "${1:?a folder}"
cd "$1"

import() { [ -d "$1" ] || "$palpate" import --out "$@" >>import.txt 2>&1; } # FOLDER FILES... OPTIONS...
import mach1 "$here"/mach1/*.csv --specimen-height-mm 3
import ecoflex "$here"/ecoflex/*.csv
import afm "$here"/afm/AFM_*.txt --specimen-height-mm 0.05
import titin "$here"/titin/*.csv --units depth=stretch,force=kPa --specimen-height-mm 2 --specimen-area-mm2 0.5

python3 - "${2-}" <<'P'
import glob, json, sys
rows = [("hayes_0%d_%d" % (site, arms), 20, "--arms %d --law polynomial" % arms, "mach1/hayes_0%d_*.csv" % site)
        for site in (2, 5, 8) for arms in (1, 2)]
rows += [("hayes_all_%d" % arms, 20, "--arms %d --law polynomial" % arms, "mach1/hayes_0[258]_*.csv") for arms in (1, 2, 3)]
rows += [("static_00", 100, "--degree 2", "mach1/static_00*.csv")]
rows += [(grade, 4, "--arms 0 --law mooney_rivlin5", "ecoflex/%s_[AB]*.csv" % grade) for grade in ("EF10_0T", "EF30_0T", "EF30_50T")]
rows += [("%s_%d" % (of, arms), 1, "--arms %d" % arms, of + "/*.csv") for arms in (1, 2) for of in ("afm", "titin")]
for step in ("characterize", "explain"):
    jobs = [{"name": name, "arguments": [step, *sorted(glob.glob(runs)), *(
        [*options.split(), "--out", name + ".json"] if step == "characterize" else ["--model", name + ".json", "--every", str(every), "--json"])]}
        for name, every, options, runs in rows if sys.argv[1] in name]
    json.dump({"palpate": {"batch": 1}, "jobs": jobs}, open(step + ".json", "w"))
P
for step in characterize explain; do "$palpate" batch $step.json --out $step; done
python3 - <<'P'
import json
for job in json.load(open("explain.json"))["jobs"]:
    e = json.load(open("explain/%s.out" % job["name"]))
    g = e["gap"]
    print("%-15s %-11s %.2g %.2g, left out %.2g %.2g, noise level %.2g;" % (job["name"], e["verdict"], *(g[k] for k in (
        "before_N", "after_N", "heldout_before_N", "heldout_after_N", "noise_level_N"))),
        ", ".join("%s %s" % (f["id"], f["parameters"]) for f in e["effects"]) or "nothing", "|",
        ", ".join(s["id"] for s in sorted(e["rejected"], key=lambda s: -s["score"])[:4]))
P
