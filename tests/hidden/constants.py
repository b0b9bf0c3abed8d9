#!/usr/bin/env python3
"""Halves and doubles each constant of the likelihood (doc/likelihood.md), and counts the answers that change on a fixed set of cases.

    constants.py [--out DIR] [--only NAME,...] [--cases NNN,...] [--list] [--report-only]

The sources are copied to DIR/source, changed there, and built by make. Cases are some of worlds/ (set testers, SEED); where a
laboratory samples fast, one row in so many is kept. Each variant of the command makes a model (characterize) and
explains it; an answer is the verdict and the names of the effects. What DIR has is not computed again. One process at a time.
Exit code 1 if a constant's text is not found exactly once, a variant does not compile, or the unchanged build has no answer."""
import argparse
import filecmp
import glob
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
TREE = os.path.dirname(os.path.dirname(HERE))
SEED = 22
CASES = "001 022 013 034 031 032 028".split()
KEPT = {"servo": 4, "stepper": 3, "sinusoids": 2, "triangles": 4, "hand_held": 2, "slow_clock": 1, "force_control": 2,
        "quasi_linear": 4, "fractional": 3}     # one row in so many
SECONDS = 600   # of a command; beyond it has no answer

# Name, file, the text of its definition, that with half of it and with twice as much (None: not possible). Not here are the four
# processes of the correlated noise (the filter is written out for four), and what these cases do not reach: blocks and air, a
# single run, more than 8000 samples.
CONSTANTS = [
    ("false alarms", "lib/explain/explain_data.c", "log(1.0 / false_alarm", "log(2.0 / false_alarm", "log(0.5 / false_alarm"),
    ("prior odds", "lib/explain/infer_trial.c", "log(fmax(1.0, n))", "log(fmax(1.0, 2.0 * n))", "log(fmax(1.0, 0.5 * n))"),
    ("sd of a strength", "lib/explain/infer_prior.c", "column > 0.0 ? sqrt(", "column > 0.0 ? 0.5 * sqrt(", "column > 0.0 ? 2.0 * sqrt("),
    ("sd of a logarithm", "lib/explain/infer_fit.c", "WIDE = 3.0;", "WIDE = 1.5;", "WIDE = 6.0;"),
    ("range of times", "lib/explain/explain_fit.c", ("0.03 * data->step : 0.0", "20.0 * size"), ("0.06 * data->step : 0.0", "10.0 * size"),
     ("0.015 * data->step : 0.0", "40.0 * size")),
    ("shown", "lib/explain/infer_trial.c", "return share > 0.5;", "return share > 0.75;", "return share > 0.0;"),
    ("knots", "lib/explain/infer_internal.h", "INFER_COARSE = 16,", "INFER_COARSE = 8,", None),
    ("lengths", "lib/explain/infer_prior.c", "{0.5, 0.125}", "{0.25, 0.0625}", "{1.0, 0.25}"),
    ("nodes", "include/palpate/free_term.h", "PALP_FREE_NODES = 12,", "PALP_FREE_NODES = 6,", "PALP_FREE_NODES = 24,"),
    ("shortest time", "lib/explain/infer_fit.c", "shortest = 4.0 *", "shortest = 2.0 *", "shortest = 8.0 *"),
    ("least freedom", "lib/explain/infer_tails.c", "LEAST = 1.0,", "LEAST = 0.5,", "LEAST = 2.0,"),
    ("most freedom", "lib/explain/infer_tails.c", "MOST = 1000.0;", "MOST = 500.0;", "MOST = 2000.0;"),
    ("encoder's samples", "lib/explain/infer_steps.c", "BEFORE = 4, AFTER = 3", "BEFORE = 2, AFTER = 1", "BEFORE = 7, AFTER = 7"),
    ("finest step", "lib/explain/infer_steps.c", "FINEST = 1e-5,", "FINEST = 5e-6,", "FINEST = 2e-5,"),
    ("begun again", "lib/explain/infer_sizes.c", "small = 3.0 *", "small = 1.5 *", "small = 6.0 *"),
    ("converged trials", "lib/explain/infer_search.c", "SETTLED = 8,", "SETTLED = 4,", "SETTLED = 16,"),
    ("finalists", "lib/explain/infer_search.c", "FINALISTS = 3 };", "FINALISTS = 2 };", "FINALISTS = 6 };"),
    ("pairs evaluated", "lib/explain/infer_pairs.c", "BEST = 10,", "BEST = 5,", "BEST = 20,"),
    ("pairs fitted", "lib/explain/infer_pairs.c", "FINALISTS = 3 };", "FINALISTS = 2 };", "FINALISTS = 6 };"),
    ("promising anew", "lib/explain/infer_anew.c", "PROMISING = 8,", "PROMISING = 4,", "PROMISING = 16,"),
    ("rounds without one", "lib/explain/infer_anew.c", "ROUNDS = 3,", "ROUNDS = 2,", "ROUNDS = 6,"),
    ("first steps", "lib/explain/infer_trial.c", "EVALUATIONS = 3 }", "EVALUATIONS = 2 }", "EVALUATIONS = 6 }"),
    ("end of a fit", "lib/explain/infer_improve.c", (".stop_absolute = 0.02", ".stop_expected = 0.02"),
     (".stop_absolute = 0.01", ".stop_expected = 0.01"), (".stop_absolute = 0.04", ".stop_expected = 0.04")),
    ("bond's grid", "lib/explain/infer_scan.c", "PLACES = 16, OTHERS = 12 }", "PLACES = 8, OTHERS = 6 }", "PLACES = 32, OTHERS = 24 }"),
    ("bond's grid ends", "lib/explain/infer_scan.c", "NEGLIGIBLE = 7.0;", "NEGLIGIBLE = 3.5;", "NEGLIGIBLE = 14.0;"),
    ("first discrepancy", "lib/explain/infer_prior.c", "fmax(white, 0.01 * data->peak)", "fmax(white, 0.005 * data->peak)",
     "fmax(white, 0.02 * data->peak)"),
    ("first bend", "lib/explain/infer_prior.c", ".bend = 0.1}", ".bend = 0.05}", ".bend = 0.2}"),
    ("first slow noise", "lib/explain/infer_fit.c", "slow[a] = 0.3 * white", "slow[a] = 0.15 * white", "slow[a] = 0.6 * white"),
    ("least noise", "lib/explain/infer_learn.c", "fmax(0.01 * data->run[0].white", "fmax(0.005 * data->run[0].white", "fmax(0.02 * data->run[0].white"),
    ("free bends", "lib/explain/infer_material.c", "FREE = 10.0;", "FREE = 5.0;", "FREE = 20.0;"),
    ("arms tried", "lib/explain/infer_material.c", "TRIED = 3 }", "TRIED = 2 }", "TRIED = 6 }"),
    ("second search", "lib/explain/infer_material.c", "SHARE = 0.01;", "SHARE = 0.005;", "SHARE = 0.02;"),
    ("exact", "lib/explain/explain_data.h", "EXPLAIN_EXACT 1e-6", "EXPLAIN_EXACT 5e-7", "EXPLAIN_EXACT 2e-6"),
    ("enough parts", "lib/explain/infer_recordings.c", "ENOUGH = 300.0", "ENOUGH = 150.0", "ENOUGH = 600.0"),
    ("spike", "lib/explain/explain_data.c", "SPIKE_SIGMA = 8.0;", "SPIKE_SIGMA = 4.0;", "SPIKE_SIGMA = 16.0;"),
    ("line stands out", "lib/explain/explain_lines.c", "OUTSTANDING = 3, OUTSTANDING_ALIAS = 10 }", "OUTSTANDING = 2, OUTSTANDING_ALIAS = 5 }",
     "OUTSTANDING = 6, OUTSTANDING_ALIAS = 20 }"),
    ("way back", "lib/explain/infer_columns.c", "turned = 0.01 *", "turned = 0.005 *", "turned = 0.02 *"),
    ("pressed", "lib/explain/explain_shown.c", "PRESSED = 0.05;", "PRESSED = 0.025;", "PRESSED = 0.1;"),
]


def as_list(x):
    return [x] if isinstance(x, str) else list(x)


def change(text, old, new, where):
    for a, b in zip(as_list(old), as_list(new)):
        if text.count(a) != 1:
            sys.exit("constants.py: %s has %r %d times, not once" % (where, a, text.count(a)))
        text = text.replace(a, b)
    return text


def read(path):
    with open(path, encoding="utf-8") as f:
        return f.read()


def write(path, text):
    with open(path + ".new", "w", encoding="utf-8") as f:
        f.write(text)
    os.rename(path + ".new", path)


def run(command, **options):
    return subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)


def sources():
    """What the command and the cases are made of, by name."""
    names = run(["git", "-C", TREE, "ls-files", "-z"]).stdout.split("\0")
    return [f for f in names if f and os.path.isfile(os.path.join(TREE, f))]


def check_sources(out):
    """A folder belongs to the sources with which it began."""
    sums, kept = hashlib.sha256(), os.path.join(out, "sources")
    for f in sources():
        if f.startswith(("lib/", "include/", "tools/", "tests/hidden/")) and f.endswith((".c", ".h")):
            sums.update(f.encode() + read(os.path.join(TREE, f)).encode())
    if os.path.exists(kept) and read(kept) != sums.hexdigest():
        sys.exit("constants.py: the sources are not those that %s began with; use another folder" % out)
    write(kept, sums.hexdigest())


def build(out, name, file, old, new):
    """The command with the changed text. The copied source gets back first what an interrupted build has changed."""
    source, to = os.path.join(out, "source"), os.path.join(out, "commands", name, "palpate")
    if os.path.exists(to):
        return to
    for f in sources() if not os.path.isdir(os.path.join(source, "build")) else {c[1] for c in CONSTANTS}:
        copy = os.path.join(source, f)
        os.makedirs(os.path.dirname(copy), exist_ok=True)
        if not os.path.exists(copy) or not filecmp.cmp(os.path.join(TREE, f), copy, shallow=False):
            shutil.copy(os.path.join(TREE, f), copy)
    if file:
        write(os.path.join(source, file), change(read(os.path.join(TREE, file)), old, new, file))
    made = run(["make", "-C", source, "BUILD=build", "CFLAGS=-O3", "build/palpate"])
    if made.returncode:
        sys.exit("constants.py: %s does not compile:\n%s" % (name, made.stdout[-2000:]))
    os.makedirs(os.path.dirname(to), exist_ok=True)
    shutil.copy(os.path.join(source, "build", "palpate"), to + ".new")
    os.rename(to + ".new", to)
    return to


def make_cases(out):
    """Writes the cases, some rows left out; returns their truth by name."""
    truth, worlds = os.path.join(out, "truth.json"), os.path.join(HERE, "worlds")
    if not os.path.exists(truth):
        files = sorted(glob.glob(os.path.join(worlds, "*.c"))) + [os.path.join(HERE, f) for f in ("random.c", "path.c", "kinds.c")]
        compiler = os.environ.get("CC", "cc")
        for step in ([compiler, "-std=c99", "-O2", "-ffp-contract=off", *files, "-lm", "-o", os.path.join(out, "worlds")],
                     [os.path.join(out, "worlds"), "testers", SEED, os.path.join(out, "all"), truth + ".new"]):
            made = run(step)
            if made.returncode:
                sys.exit("constants.py: the generator: " + made.stdout)
        os.rename(truth + ".new", truth)
    cases = {t["case"][-3:]: t for t in json.loads(read(truth))["cases"]}
    for name, t in cases.items():
        to = os.path.join(out, "cases", name)
        if os.path.isdir(to):
            continue
        os.makedirs(to)
        for path in glob.glob(os.path.join(out, "all", "case_" + name, "run_*.csv")):
            lines = read(path).splitlines()
            first = next(i for i, x in enumerate(lines) if not x.startswith("#")) + 1
            write(os.path.join(to, os.path.basename(path)), "\n".join(lines[:first] + lines[first::KEPT[t["world"]]]) + "\n")
    return cases


def explain(out, command, variant, case, truth):
    """The answer to a case: verdict, names, parameters with intervals."""
    to = os.path.join(out, "answers", variant, case + ".json")
    if not os.path.exists(to):
        os.makedirs(os.path.dirname(to), exist_ok=True)
        runs = sorted(glob.glob(os.path.join(out, "cases", case, "run_*.csv")))
        environment = dict(os.environ, OPENBLAS_NUM_THREADS="1", OMP_THREAD_LIMIT="1", LC_ALL="C")
        with tempfile.TemporaryDirectory() as scratch:
            model, answer = os.path.join(scratch, "model.json"), {"verdict": "none", "effects": []}
            for words in (["characterize", *truth["characterize"].split(), "--out", model],
                          ["explain", "--model", model, "--jobs", "1", "--out", os.path.join(scratch, "explained.json")]):
                try:
                    done = subprocess.run([command, words[0], *runs, *words[1:], "--json", "--force"], stdout=subprocess.PIPE,
                                          stderr=subprocess.DEVNULL, env=environment, timeout=SECONDS)
                except subprocess.TimeoutExpired:
                    break
                if done.returncode:
                    break
                answer = json.loads(done.stdout) if words[0] == "explain" else answer
        kept = {"verdict": answer["verdict"],
                "effects": [{k: e.get(k) for k in ("id", "parameters", "intervals", "evidence")} for e in answer["effects"]]}
        write(to, json.dumps(kept))
    return json.loads(read(to))


def said(answer):
    return "%s (%s)" % (answer["verdict"], ", ".join(sorted(e["id"] for e in answer["effects"])) or "nothing")


def moved(before, after):
    """Of the effects that both name: the largest change of a parameter, in sds of its interval before."""
    most = 0.0
    for e in before["effects"]:
        other = next((x for x in after["effects"] if x["id"] == e["id"]), None)
        for key, interval in (e["intervals"] or {}).items() if other else ():
            a, b = e["parameters"].get(key), other["parameters"].get(key)
            if None in (a, b) or not interval or None in interval or not interval[1] > interval[0]:
                continue
            most = max(most, abs(b - a) * 3.92 / (interval[1] - interval[0]))
    return most


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--out", help="a folder that keeps what was computed")
    p.add_argument("--only", help="constants, by name")
    p.add_argument("--cases", default=",".join(CASES))
    p.add_argument("--list", action="store_true", help="checks that each text is found once, and ends")
    p.add_argument("--report-only", action="store_true", help="only what DIR already has")
    o = p.parse_args()
    constants = [c for c in CONSTANTS if not o.only or c[0] in o.only.split(",")]
    for name, file, old, *new in constants:
        for n in filter(None, new):
            change(read(os.path.join(TREE, file)), old, n, file)
        if o.list:
            print("%-20s %s: %s" % (name, file, "; ".join(as_list(old))))
    if o.list:
        return
    out = os.path.abspath(o.out or tempfile.mkdtemp())
    os.makedirs(out, exist_ok=True)
    check_sources(out)
    truth, cases = make_cases(out), o.cases.split(",")
    command = build(out, "unchanged", None, None, None)
    base = {c: explain(out, command, "unchanged", c, truth[c]) for c in cases}
    for c in cases:
        effect, second = (t and t["effect"]["id"] for t in (truth[c] if truth[c]["effect"] else None, truth[c].get("second")))
        print("%s %-14s %-45s %s" % (c, truth[c]["world"], truth[c]["outside"] or " and ".join(filter(None, (effect, second))) or "nothing",
                                     said(base[c])), flush=True)
    if any(b["verdict"] == "none" for b in base.values()):
        sys.exit("constants.py: a case has no answer")
    print("\n%-20s %12s %12s %12s" % ("constant", "half", "double", "largest sds"))
    count = total = 0
    for name, file, old, *new in constants:
        cells, most, differ = [], 0.0, []
        for which, text in zip(("half", "double"), new):
            variant = re.sub("[^a-z]+", "_", name) + "_" + which
            if text is None:
                cells.append("-")
                continue
            folder = os.path.join(out, "answers", variant)
            if o.report_only and not all(os.path.exists(os.path.join(folder, c + ".json")) for c in cases):
                cells.append("not run")
                continue
            changed = build(out, variant, file, old, text) if not o.report_only else None
            answers = {c: explain(out, changed, variant, c, truth[c]) for c in cases}
            of = [c for c in cases if said(answers[c]) != said(base[c])]
            cells.append("%d of %d" % (len(of), len(cases)))
            count, total = count + len(of), total + len(cases)
            most = max([most] + [moved(base[c], answers[c]) for c in cases])
            differ += ["%s, %s: %s, not %s" % (which, c, said(answers[c]), said(base[c])) for c in of]
        print("%-20s %12s %12s %12.2g" % (name, *cells, most), flush=True)
        for d in differ:
            print("    " + d, flush=True)
    print("\n%d of %d answers changed (%.1f %%)" % (count, total, 100 * count / max(1, total)))


if __name__ == "__main__":
    main()
