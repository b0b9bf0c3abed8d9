#!/usr/bin/env python3
"""Holds the answers of `palpate explain` against the truth of the hidden cases.

    score.py DIR [--report-only] [--slack N] [--print-table]
    score.py DIR --manifest explain|oracle [OPTION...]    for palpate batch, with these options of explain

DIR is the --out of run.sh: DIR/explain/ has the answers, DIR/oracle/ (if there) those where only the true effects
were candidates. An effect counts for the bars where at least 3 noise levels (rms) of it are left after the plain
model's numbers are refitted. Exit code 0 if every bar is met (--slack N: with N fewer wrong); with
--report-only always."""
import argparse
import collections
import csv
import json
import math
import os
import statistics
import sys

SEEN = 3.0      # noise levels
SAME = 0.8      # cosine from which an answer within a class is not called wrong
GEOMETRY = "network_geometry"   # what is missing where particles are given to a lumped model
GROUPS = ("single", "two", "thesis_protocol", "network", "null", "outside")
VERDICTS = ("agrees", "explained", "ambiguous", "unexplained")
IDS = ("relaxation_arm", "power_law_relaxation", "strain_dependent_arm", "rate_stiffening",
       "damage_softening", "permanent_set", "poroelastic", "contact_offset", "toe_region", "adhesion",
       "plate_slip", "session_ageing", "frame_compliance", "plate_inertia", "coulomb_friction", "sensor_lag",
       "sensor_bias", "sensor_drift", "sensor_gain", "force_saturation", "mains_hum", "drive_ripple")


def wilson(hits, n, z=1.96):
    if n == 0:
        return 0.0, 1.0
    p, d = hits / n, 1 + z * z / n
    middle = (p + z * z / (2 * n)) / d
    half = z / d * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
    return max(0.0, middle - half), min(1.0, middle + half)


def share(hits, n):
    low, high = wilson(hits, n)
    rate = 100 * hits / n if n else 0
    return "%d of %d = %.1f %% (95 %%: %.1f to %.1f)" % (hits, n, rate, 100 * low, 100 * high)


def load(path):
    try:
        with open(path) as f:
            return json.load(f)
    except (OSError, ValueError):
        return None


def answers(folder, step):
    """Of a batch: name to (result, None if the job failed; seconds) of the jobs that have ended."""
    path = os.path.join(folder, step)
    try:
        with open(os.path.join(path, "table.csv"), newline="") as f:
            rows = list(csv.DictReader(f))
    except OSError:
        return {}
    return {r["name"]: (load(os.path.join(path, r["name"] + ".out")) if r["status"] == "0" else None, float(r["seconds"]))
            for r in rows if r["status"]}


def manifest(folder, jobs):
    """Prints that of case, command, options: its runs are those of the case's folder, {} in an option is that folder."""
    list_ = []
    for case, command, *options in jobs:
        here = "cases/" + case
        runs = sorted(f for f in os.listdir(os.path.join(folder, here)) if f.startswith("run_"))
        list_.append({"name": case, "arguments": [command, *("%s/%s" % (here, f) for f in runs), *(o.format(here) for o in options)]})
    print(json.dumps({"palpate": {"batch": 1}, "jobs": list_}, indent=1))


class Named:
    """One effect of an answer."""

    def __init__(self, given):
        self.id = given["id"]
        self.parameters = given.get("parameters", {})
        self.intervals = given.get("intervals", {})
        self.alike = set(given.get("class") or []) | {self.id}


class Case:
    def __init__(self, truth, answer, oracle):
        self.truth = truth
        self.name = truth["case"]
        self.group = truth["group"]
        self.effects = list(truth["effects"])
        if self.group == "network":
            self.effects.append(dict(truth["network"], id=GEOMETRY, parameters={}))
        self.result, self.seconds = answer
        self.oracle = oracle
        self.verdict = self.result.get("verdict", "none") if self.result else "none"
        self.named = [Named(e) for e in self.result["effects"]] if self.result else []
        self.match()

    def match(self):
        """Which named effect answers which true one: by its name first, then by its class. A network's
        geometry has no name in the catalogue, only what is alike to it."""
        self.answer, free = {}, list(self.named)
        for by_name in (True, False):
            for i, true in enumerate(self.effects):
                for given in free if i not in self.answer else []:
                    like = true["cosine"].get(given.id, 0) >= SAME or given.id in true["class"]
                    alike = like and (true["id"] in given.alike or true["id"] == GEOMETRY)
                    if given.id == true["id"] if by_name else alike:
                        self.answer[i] = given
                        free.remove(given)
                        break
        self.extra = free

    def seen(self, i):
        return self.effects[i]["noise_levels_left"] >= SEEN

    def unknown(self, i):
        """Says that something is missing that it does not know, of a geometry of which even the effect most
        alike leaves more than a noise level."""
        e = self.effects[i]
        cosine = max(e["cosine"].values(), default=0)
        rest = e["noise_levels_left"] * math.sqrt(max(0, 1 - cosine ** 2))
        return e["id"] == GEOMETRY and rest > 1 and self.verdict == "unexplained" and not self.named

    def right(self, i):
        return i in self.answer or self.unknown(i)

    def clear(self):
        """All that is missing can be seen; of a network's geometry there may also be too little."""
        missing = [i for i, e in enumerate(self.effects) if e["id"] != GEOMETRY or self.seen(i)]
        return bool(missing) and all(self.seen(i) for i in missing)

    def null(self):
        """Nothing is missing, or no more than a little of a network's geometry."""
        return self.group != "outside" and not any(
            self.seen(i) or e["id"] != GEOMETRY for i, e in enumerate(self.effects))

    def accused(self):
        return bool(self.extra) or self.verdict == "none"

    def closed(self, which):
        gap = (which or {}).get("gap") or {}
        return gap.get("closed")


def of_effect(cases, group, name):
    return [c for c in cases if c.group == group and c.effects[0]["id"] == name]


def table_of_confusion(cases):
    print("What was named (columns: the catalogue in its order; agr, amb, une: the verdict), by what is true")
    print("%-30s%s  agr amb une" % ("", "".join("%4d" % (i + 1) for i in range(len(IDS)))))
    rows = collections.OrderedDict()
    for i, name in enumerate(IDS):
        rows["%2d %s" % (i + 1, name)] = of_effect(cases, "single", name)
    for i, name in enumerate(IDS):
        rows["%2d %s, seed's" % (i + 1, name)] = of_effect(cases, "thesis_protocol", name)
    for group in ("two", "null", "outside"):
        rows["   " + group] = [c for c in cases if c.group == group]
    for kind in ("mild", "bent", "faulty"):
        rows["   network, " + kind] = [c for c in cases if c.truth.get("network", {}).get("kind") == kind]
    for label, list_ in rows.items():
        if list_:
            named = collections.Counter(e.id for c in list_ for e in c.named)
            verdict = collections.Counter(c.verdict for c in list_)
            said = ("%3s" % (verdict[v] or ".") for v in ("agrees", "ambiguous", "unexplained"))
            print("%-30s%s  %s" % (label, "".join("%4s" % (named[i] or ".") for i in IDS), " ".join(said)))
    print()


def show(title, header, rows, markdown):
    """header and rows: texts; the first column is to the left."""
    print(title + ("\n" if markdown else ""))
    if markdown:
        for cells in (header, ["---"] * len(header), *rows):
            print("| %s |" % " | ".join(cells))
    else:
        wide = [max(len(r[k]) for r in (header, *rows)) for k in range(len(header))]
        for cells in (header, *rows):
            rest = "".join("  %*s" % (w, c) for w, c in zip(wide[1:], cells[1:]))
            print("    %-*s%s" % (wide[0], cells[0], rest))
    print()


def table_of_power(cases, markdown):
    edges = (0, SEEN, 6, 20, math.inf)
    tally = collections.defaultdict(lambda: [[0, 0] for _ in edges[1:]])
    for c in cases:
        for i, e in enumerate(c.effects):
            b = next(k for k in range(4) if edges[k] <= e["noise_levels_left"] < edges[k + 1])
            for key in (e["id"], "all of them"):
                tally[key][b][0] += c.right(i)
                tally[key][b][1] += 1
    rows = [[key, *("%d/%d" % tuple(t) if t[1] else "." for t in tally[key])]
            for key in (*IDS, GEOMETRY, "all of them") if key in tally]
    show("Right effect or its class, by what is left of the effect in the records, in noise levels",
         ["effect", "below 3", "3 to 6", "6 to 20", "above 20"], rows, markdown)


def table_of_verdicts(cases, markdown):
    rows = []
    for group in GROUPS:
        of = [c for c in cases if c.group == group]
        verdict = collections.Counter(c.verdict for c in of)
        rows.append([group, str(len(of)), *(str(verdict[v]) for v in (*VERDICTS, "none"))])
    show("Verdicts by group", ["group", "cases", *VERDICTS, "no answer"], rows, markdown)


def inside(key, true, interval):
    low, high = interval
    if key == "phase_rad":
        true += 2 * math.pi * round(((low + high) / 2 - true) / (2 * math.pi))
    return low <= true <= high


def table_of_coverage(cases):
    """Of effects that were named rightly by their own name."""
    tally, all_ = collections.defaultdict(lambda: [0, 0]), [0, 0]
    for c in cases:
        for i, given in c.answer.items():
            true = c.effects[i]
            if given.id != true["id"]:
                continue
            for key, value in true["parameters"].items():
                interval = given.intervals.get(key)
                if isinstance(interval, (list, tuple)) and len(interval) == 2 and None not in interval:
                    hit = inside(key, value, interval)
                    for t in (tally[true["id"] + "." + key], all_):
                        t[0] += hit
                        t[1] += 1
    print("Parameters within their intervals: %s" % share(*all_))
    for key in sorted(tally):
        if tally[key][0] < tally[key][1]:
            print("    %-44s %d of %d" % (key, *tally[key]))
    print()


def in_words(case):
    """What is true of it."""
    outside = case.truth.get("outside")
    if outside:
        return "outside: %s (%.1f noise levels)" % (outside["name"], outside["noise_levels_left"])
    return ", ".join("%s %s (%.1f noise levels)" % (
        e["id"], "/".join("%.3g" % v for v in e["parameters"].values()), e["noise_levels_left"])
        for e in case.effects) or "nothing"


def table_of_wrong(cases):
    print("Wrong or missing")
    for c in cases:
        missed = any(c.seen(i) and not c.right(i) for i in range(len(c.effects)))
        if missed or c.extra or c.verdict == "none":
            print("    %s %-13s true: %-50s named: %s [%s]" % (
                c.name, c.group, in_words(c), ", ".join(n.id for n in c.named) or "nothing", c.verdict))
    print()


def bars(cases, slack):
    """Each bar: what, in words what came of it, what is wanted, whether it is met (None: not judged)."""
    clear = [c for c in cases if c.clear()]
    missed = sum(1 for c in cases for i in range(len(c.effects)) if c.seen(i) and not c.right(i))
    effects = sum(1 for c in cases for i in range(len(c.effects)) if c.seen(i))
    nulls = [c for c in cases if c.null()]
    outside = [c for c in cases if c.group == "outside"]
    extra, accused, misnamed = (sum(c.accused() for c in of) for of in (clear, nulls, outside))
    list_ = [("right effect or its class", missed, effects, 0.05),
             ("no extra effect", extra, len(clear), 0.05),
             ("nulls not accused", accused, len(nulls), 0.05),
             ("outside the catalogue not named as of it", misnamed, len(outside), 0.10)]
    rows = [(what, share(n - wrong, n), "%g %%" % (100 - 100 * allowed),
             n > 0 and wrong <= allowed * n + slack) for what, wrong, n, allowed in list_]
    return rows + [bar_closed(clear)]


def bar_closed(clear):
    what, wanted = "gap closed beside the oracle's", "ratio 0.95"
    pairs = [(c.closed(c.result), c.closed(c.oracle)) for c in clear]
    pairs = [(a if a is not None else 0.0, b) for a, b in pairs if b is not None]
    if not pairs:
        alone = [c.closed(c.result) or 0.0 for c in clear] or [0.0]
        words = "median %.3f (%d cases), no oracle's" % (statistics.median(alone), len(alone))
        return what, words, wanted, None
    ours, oracle = (statistics.median(p[k] for p in pairs) for k in (0, 1))
    words = "median %.3f, oracle %.3f, ratio %.3f (%d cases)" % (
        ours, oracle, ours / oracle if oracle else 0, len(pairs))
    return what, words, wanted, ours >= 0.95 * oracle


def table_of_bars(list_, markdown):
    words = {True: "met", False: "NOT MET", None: "not judged"}
    show("Bars", ["bar", "result", "wanted", ""], [[*texts, words[met]] for *texts, met in list_], markdown)


def others(cases):
    nulls = [c for c in cases if c.null()]
    outside = [c for c in cases if c.group == "outside"]
    hidden = [c for c in cases if c.group == "single" and not c.seen(0)]
    for what, of in (("all nulls", nulls), ("without the networks", [c for c in nulls if c.group == "null"])):
        print("False alarms, %s: %s accused" % (what, share(sum(c.accused() for c in of), len(of))))
    print("Outside the catalogue: unexplained: %s; with a name, and not unexplained: %d" % (
        share(sum(c.verdict == "unexplained" for c in outside), len(outside)),
        sum(bool(c.named) and c.verdict in ("explained", "ambiguous") for c in outside)))
    print("Single effects of which less than %g noise levels are left: %d; named, or their class: %d; another: %d"
          % (SEEN, len(hidden), sum(0 in c.answer for c in hidden), sum(bool(c.extra) for c in hidden)))
    bent = [(c, i) for c in cases for i, e in enumerate(c.effects) if e["id"] == GEOMETRY and c.seen(i)]
    print("Networks whose geometry leaves %g noise levels: %d; named as what is alike: %d; unexplained, no name: %d"
          % (SEEN, len(bent), sum(i in c.answer for c, i in bent), sum(c.unknown(i) for c, i in bent)))
    sizes = [len(n.alike) for c in cases for n in c.named]
    if sizes:
        by_name = [g.id == c.effects[i]["id"] for c in cases for i, g in c.answer.items()]
        print("Classes of the answers: mean size %.2f, largest %d; right by name %d, by class %d" % (
            statistics.mean(sizes), max(sizes), sum(by_name), len(by_name) - sum(by_name)))
    seconds = sorted(c.seconds for c in cases if c.seconds is not None)
    if seconds:
        print("Time of a case: median %.1f s, longest %.1f s" % (statistics.median(seconds), seconds[-1]))
    print()


def candidates(truth):
    """The true effects, and what is alike to a network's geometry that can be seen; for the oracle."""
    ids = [e["id"] for e in truth["effects"]]
    bent = truth.get("network", {"noise_levels_left": 0})
    return ids + ([max(bent["cosine"], key=bent["cosine"].get)] if bent["noise_levels_left"] >= SEEN else [])


def jobs(step, truths, options):
    for t in truths:
        ids = candidates(t) if step == "oracle" else []
        if step == "explain" or ids:
            yield (t["case"], "explain", "--model", "{}/model.json", *(["--candidates", ",".join(ids)] if ids else []), *options, "--json",
                   "--out", "{}/%s_model.json" % step, "--report", "{}/%s.html" % step, "--force")


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("folder", metavar="DIR")
    p.add_argument("--manifest", choices=("explain", "oracle"))
    p.add_argument("--report-only", action="store_true")
    p.add_argument("--print-table", action="store_true")
    p.add_argument("--slack", type=int, default=0, metavar="N")
    o, options = p.parse_known_args()
    truth = load(os.path.join(o.folder, "truth.json"))
    if not truth or options and not o.manifest:
        sys.exit("score.py: needs a folder with truth.json, and options of explain only with --manifest")
    if o.manifest:
        manifest(o.folder, jobs(o.manifest, truth["cases"], options))
        return
    given, oracle = (answers(o.folder, step) for step in ("explain", "oracle"))
    cases = [Case(t, given.get(t["case"], (None, None)), oracle.get(t["case"], (None, None))[0]) for t in truth["cases"]]
    print("%d cases of seed %s, set %s\n" % (len(cases), truth["seed"], truth["set"]))
    judged = bars(cases, o.slack)
    if not o.print_table:
        table_of_confusion(cases)
        table_of_coverage(cases)
        table_of_wrong(cases)
        others(cases)
    table_of_power(cases, o.print_table)
    table_of_verdicts(cases, o.print_table)
    table_of_bars(judged, o.print_table)
    sys.exit(0 if all(met is not False for *_, met in judged) or o.report_only else 1)


if __name__ == "__main__":
    main()
