#!/usr/bin/env python3
"""Explains cases as they are and in other words (units, order, names, clock, files, headers): the answer must be the same.

    metamorphic.py --command PALPATE --cases DIR --truth FILE.json [--cases DIR --truth FILE.json ...] --out DIR
                   [--seed N] [--draws N] [--only CASE] [--do NAME,...] [--most-rows N] [--jobs N] [--keep]

Cases and truth are those of run.sh or worlds/run.sh. Each draw takes a case and one or two transformations at random. Where no model is
given `palpate characterize` makes one, which must be the same in the other units; explain then begins from it in these units. Verdict
and names must be the same, and parameters within 1e-4.

A case whose answer hangs on the last bits says nothing about units. It is left aside, and counted, where the same recordings with all forces times
1 + 1e-9 have another answer, or where an effect that is named has less than 30 nats of evidence. Exit code 0 if no answer
differs and at most half of the draws were left aside."""
import argparse
import concurrent.futures
import json
import math
import os
import random
import shutil
import subprocess
import sys

CLOSE = 1e-4     # of a parameter
CLEAR = 30.0     # nats
LASTING = ("damage_softening", "permanent_set", "session_ageing")    # they need headers: which run is when, and of which specimen
# Powers of force, length and time in a parameter, where the end of its name does not say it.
POWERS = {"_N": (1, 0, 0), "_mm": (0, 1, 0), "_s": (0, 0, 1), "_N_s": (1, 0, -1), "_mm_N": (-1, 1, 0), "_kg": (1, -1, 2), "_Hz": (0, 0, -1),
          "_Ns": (1, 0, 1), "per_s": (0, 0, -1), "per_hour": (0, 0, -1)}


class Run:
    """A recording: header lines, the row of names, rows of numbers."""

    def __init__(self, path):
        self.name = os.path.basename(path)
        with open(path, encoding="utf-8") as f:
            lines = f.read().splitlines()
        self.header = [x for x in lines if x.startswith("#")]
        self.columns, *rows = [x for x in lines if not x.startswith("#")]
        self.rows = [[float(x) for x in row.split(",")] for row in rows]

    def write(self, folder):
        with open(os.path.join(folder, self.name), "w", encoding="utf-8") as f:
            f.write("\n".join(self.header + [self.columns] + [",".join(repr(x) for x in row) for row in self.rows]) + "\n")


class Case:
    """Runs, a model that is given or None, what characterize is told, and the units: so many SI units in force, length, time."""

    def __init__(self, folder, truth):
        self.truth = truth
        self.runs = [Run(os.path.join(folder, f)) for f in sorted(os.listdir(folder)) if f.startswith("run_") and f.endswith(".csv")]
        self.model, self.options = None, truth.get("characterize", "").split()
        if "world" not in truth:
            with open(os.path.join(folder, "model.json"), encoding="utf-8") as f:
                self.model = json.load(f)
        self.units = [1.0, 1.0, 1.0]

    def effects(self):
        one = self.truth.get("effect")
        return [e["id"] for e in self.truth.get("effects", [one] if one else [])]


def scaled(model, units):
    """A model's numbers in these units."""
    force, length, time = units
    new = json.loads(json.dumps(model))
    new.pop("covariance", None)
    for key in ("height_mm", "radius_mm"):
        if key in new["specimen"]:
            new["specimen"][key] *= length
    law = new["stiffness"]
    for key in [k for k in law if k.endswith("_N")]:
        law[key] = [force * x for x in law[key]] if isinstance(law[key], list) else force * law[key]
    for a in new["arms"]:
        a["stiffness_N"] *= force
        a["viscosity_Ns"] *= force * time
    return new


def flat(x, path=""):
    """Every number and word of a model."""
    if isinstance(x, dict):
        return [y for k in sorted(x) for y in flat(x[k], path + "/" + k)]
    if isinstance(x, list):
        return [y for i, v in enumerate(x) for y in flat(v, "%s/%d" % (path, i))]
    return [(path, x)]


def near(a, b, scale):
    return abs(a - b) <= CLOSE * scale


def models_differ(a, b):
    """In words; empty if not. Of a law the largest coefficient is the scale, as small ones may cancel."""
    one, two = flat(a), flat(b)
    if [p for p, _ in one] != [p for p, _ in two]:
        return "models of another form: %s, %s" % (json.dumps(a["stiffness"]), json.dumps(b["stiffness"]))
    for (path, x), (_, y) in zip(one, two):
        group = [abs(v) for p, v in one if p.rsplit("/", 1)[0] == path.rsplit("/", 1)[0] and isinstance(v, (int, float))]
        if isinstance(x, (int, float)) and not near(x, y, max(group) if "/coefficients" in path else abs(x)) or isinstance(x, str) and x != y:
            return "%s of the model is %r, not %r" % (path, y, x)
    return ""


def powers(effect, key):
    if effect["id"] == "power_law_relaxation" and key == "stiffness_N":     # force * time^exponent
        return (1, 0, effect["parameters"]["exponent"])
    ends = [e for e in POWERS if key.endswith(e)]
    return POWERS[max(ends, key=len)] if ends else (0, 0, 0)


def answers_differ(a, b, units):
    """In words; empty if not. units: those of b, a in SI."""
    if a["verdict"] != b["verdict"]:
        return "verdict %s, not %s (%s; %s)" % (b["verdict"], a["verdict"], names(b), names(a))
    if names(a) != names(b):
        return "named %s, not %s" % (names(b), names(a))
    for one in a["effects"]:
        two = next(e for e in b["effects"] if e["id"] == one["id"])
        for key, x in one["parameters"].items():
            y = two["parameters"][key]
            for unit, power in zip(units, powers(one, key)):
                y /= unit ** power
            if not (near(x, y, 2 * math.pi) if key.endswith("_rad") else near(x, y, abs(x))):
                return "%s of %s is %.9g, not %.9g" % (key, one["id"], y, x)
    return ""


def names(answer):
    return ", ".join(sorted(e["id"] for e in answer["effects"])) or "nothing"


# ---- transformations: each changes a case and returns what it did in words ----

def scale_by(case, which, factor):
    case.units[which] *= factor
    column = {0: "force_N", 1: "depth_mm", 2: "time_s"}[which]
    for r in case.runs:
        at = r.columns.split(",").index(column)
        for row in r.rows:
            row[at] *= factor
        r.header = [header_scaled(x, which, factor) for x in r.header]
    if which == 1 and "--specimen-height-mm" in case.options:
        at = case.options.index("--specimen-height-mm") + 1
        case.options[at] = repr(float(case.options[at]) * factor)
    return "%s x %.3g" % (("force", "length", "time")[which], factor)


def header_scaled(line, which, factor):
    key, value = line[1:].split(":", 1)
    key = key.strip()
    power = {"_mm_s": (0, 1, -1)}.get(key[-5:], next((p for e, p in POWERS.items() if key.endswith(e) and len(e) < 4), (0, 0, 0)))[which]
    return "# %s: %r" % (key, float(value) * factor ** power) if power else line


def force(case, draw):
    return scale_by(case, 0, 10 ** draw.uniform(-9, 3))


def length(case, draw):
    return scale_by(case, 1, 10 ** draw.uniform(-4, 1))


def time(case, draw):
    return scale_by(case, 2, 10 ** draw.uniform(-3, 3))


def order(case, draw):
    draw.shuffle(case.runs)
    return "order " + " ".join(r.name[4:6] for r in case.runs)


def rename(case, draw):
    for r, i in zip(case.runs, draw.sample(range(100, 1000), len(case.runs))):
        r.name = draw.choice(("a%d b.csv", "%d.csv", "Z-%d.txt")) % i
    return "names " + ", ".join(r.name for r in case.runs)


def clock(case, draw):
    del draw
    at = case.runs[0].columns.split(",").index("time_s")
    for r in case.runs:
        for row in r.rows:
            row[at] += 1.7e9
    return "clock + 1.7e9 s"


def split(case, draw):
    """Under load: what is cut in the air may be two presses."""
    i = draw.randrange(len(case.runs))
    r, n = case.runs[i], len(case.runs[i].rows)
    at = r.columns.split(",").index("force_N")
    most = max(row[at] for row in r.rows)
    cut = draw.choice([k for k in range(16, n - 16) if min(row[at] for row in r.rows[k - 4:k + 4]) > 0.3 * most])
    rest = Run.__new__(Run)
    rest.header, rest.columns, rest.rows, rest.name = list(r.header), r.columns, r.rows[cut:], r.name[:-4] + "_rest.csv"
    r.rows = r.rows[:cut]
    case.runs.insert(i + 1, rest)
    return "%s cut at row %d of %d" % (r.name, cut, n)


def bare(case, draw):
    del draw
    height = next((x.split(":")[1].strip() for r in case.runs for x in r.header if x.startswith("# specimen.height_mm")), None)
    if case.model is None and height and "--specimen-height-mm" not in case.options:
        case.options += ["--specimen-height-mm", height]
    for r in case.runs:
        r.header = [x for x in r.header if x.startswith("# palpate.experiment")]
    return "no headers"


ALL = {f.__name__: f for f in (force, length, time, order, rename, clock, split, bare)}


def fits(case, name):
    """Whether the transformation leaves the answer what it is: a clock of 1.7e9 s holds no steps much below a millisecond, and some effects need headers."""
    if name == "clock":
        rows = case.runs[0].rows
        return rows[-1][0] - rows[0][0] > 2e-3 * len(rows)
    if name in ("bare", "split"):
        return not set(case.effects()) & set(LASTING) and case.truth.get("world") != "specimens"
    return True


# ---- runs of the command ----

def command(words, folder, log):
    with open(os.path.join(folder, log), "w", encoding="utf-8") as f:
        return subprocess.run(words, cwd=folder, stdout=f, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, check=False).returncode


def last_words(folder, log):
    with open(os.path.join(folder, log), encoding="utf-8") as f:
        return (f.read().strip().splitlines() or ["no words"])[-1]


def load(folder, name):
    with open(os.path.join(folder, name), encoding="utf-8") as f:
        return json.load(f)


def written(case, folder):
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    for r in case.runs:
        r.write(folder)


def characterize(palpate, case, folder):
    """A model, or in words why there is none."""
    code = command([palpate, "characterize", *[r.name for r in case.runs], *case.options, "--out", "made.json", "--force"], folder, "made.log")
    return load(folder, "made.json") if code == 0 else last_words(folder, "made.log")


def explain(palpate, case, model, folder, candidates):
    """An answer, or in words why there is none."""
    with open(os.path.join(folder, "model.json"), "w", encoding="utf-8") as f:
        json.dump(model, f)
    tried = ["--candidates", ",".join(candidates)] if candidates else []
    code = command([palpate, "explain", "--model", "model.json", *[r.name for r in case.runs], "--result", "result.json", "--force", *tried],
                   folder, "explain.log")
    return load(folder, "result.json") if code == 0 else last_words(folder, "explain.log")


def without_mains(answer):
    """The mains are of 40 to 70 Hz on every clock."""
    known = {e["id"] for part in ("effects", "rejected", "not_identifiable") for e in answer[part]}
    known |= {e["taken"] for e in answer["steps"] if e["taken"]} | {c for e in answer["effects"] for c in e["class"]}
    return sorted(known - {"mains_hum", "stiffness_law", "specimen_stiffness"})


def one(o, folder, truth, seed):
    """What was done, what came of it: "same", "aside: ..." or "DIFFERS: ..."."""
    draw = random.Random(seed)
    case = Case(folder, truth)
    rows = sum(len(r.rows) for r in case.runs)
    possible = [n for n in (o.do or list(ALL)) if fits(case, n)]
    chosen = draw.sample(possible, min(len(possible), draw.choice((1, 2))))
    label = "%s %s (%s, %d rows)" % (seed, os.path.basename(folder), truth.get("world", truth.get("group")), rows)
    base = os.path.join(o.out, seed.replace("/", "_"))
    written(case, os.path.join(base, "plain"))
    model = case.model or characterize(o.command, case, os.path.join(base, "plain"))
    first = model if isinstance(model, str) else explain(o.command, case, model, os.path.join(base, "plain"), None)
    mains = None
    if "time" in chosen and not isinstance(first, str):
        mains = without_mains(first)
        first = explain(o.command, case, model, os.path.join(base, "plain"), mains)
    done = "; ".join(ALL[n](case, draw) for n in chosen)
    written(case, os.path.join(base, "other"))
    outcome = compared(o, case, model, first, os.path.join(base, "other"), mains)
    if outcome != "same":
        reason = hangs(o, Case(folder, truth), model, first, os.path.join(base, "bits"), mains)
        outcome = ("aside: %s; %s" % (reason, outcome)) if reason else "DIFFERS: " + outcome
    elif not o.keep:
        shutil.rmtree(base)
    return "%-50s %s: %s -> %s" % (label, done, "refused" if isinstance(first, str) else first["verdict"] + ", " + names(first), outcome)


def compared(o, case, model, first, folder, mains):
    again = None
    if case.model is None:
        again = characterize(o.command, case, folder)
        if isinstance(again, str) or isinstance(model, str):
            return "same" if isinstance(again, str) and isinstance(model, str) else "characterize: %s" % (again if isinstance(again, str) else model)
        differ = models_differ(scaled(model, case.units), scaled(again, (1, 1, 1)))
        if differ:
            return "characterize: " + differ
    second = explain(o.command, case, scaled(model, case.units), folder, mains)
    if isinstance(first, str) or isinstance(second, str):
        return "same" if isinstance(first, str) and isinstance(second, str) else "explain: %s" % (second if isinstance(second, str) else first)
    return answers_differ(first, second, case.units) or "same"


def hangs(o, case, model, first, folder, mains):
    """In words, why the answer says nothing; empty if it does."""
    if not isinstance(first, str):
        weak = [e["id"] for e in first["effects"] if e["evidence"] < CLEAR]
        if weak:
            return "little evidence of " + ", ".join(weak)
    scale_by(case, 0, 1 + 1e-9)
    written(case, folder)
    differs = compared(o, case, model, first, folder, mains)
    return "" if differs == "same" else "hangs on the last bits"


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--command", required=True)
    p.add_argument("--cases", action="append", required=True)
    p.add_argument("--truth", action="append", required=True)
    p.add_argument("--out", required=True)
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--draws", type=int, default=10)
    p.add_argument("--do", type=lambda x: x.split(","))
    p.add_argument("--only")
    p.add_argument("--most-rows", type=int, default=0)
    p.add_argument("--jobs", type=int, default=1)
    p.add_argument("--keep", action="store_true", help="the folders of answers that do not differ, too")
    o = p.parse_args()
    o.command = os.path.abspath(o.command)
    pool = []
    for folder, truth in zip(o.cases, o.truth):
        with open(truth, encoding="utf-8") as f:
            pool += [(os.path.join(folder, t["case"]), t) for t in json.load(f)["cases"]
                     if (not o.only or t["case"] == o.only) and (not o.most_rows or t["rows"] <= o.most_rows)]
    draw = random.Random(o.seed)
    work = [(*pool[draw.randrange(len(pool))], "%d/%d" % (o.seed, i)) for i in range(o.draws)]
    print("seed %d: %d draws of %d cases" % (o.seed, o.draws, len(pool)), flush=True)
    differ = aside = 0
    with concurrent.futures.ThreadPoolExecutor(o.jobs) as threads:
        for line in threads.map(lambda w: one(o, *w), work):
            print(line, flush=True)
            differ += "-> DIFFERS" in line
            aside += "-> aside" in line
    print("%d of %d differ, %d left aside" % (differ, o.draws, aside))
    sys.exit(1 if differ or 2 * aside > o.draws else 0)


if __name__ == "__main__":
    main()
