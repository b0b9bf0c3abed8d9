#!/usr/bin/env python3
"""left_out.py: how well palpate characterize predicts a run that it has not seen.
    left_out.py DIR [--all] [OPTION...]      DIR: --out of run.sh; --all: where something is missing too;
                                             options of characterize, e.g. --law spline
    left_out.py RUN.csv... [OPTION...]      the same of these runs, in % of the largest force of the run that is left out
Of each case where nothing is missing the first and the middle run are left out in turn. What simulate --like misses them by,
with the best zero and gain, is given in noise levels: one line a run, then the median and the largest. PALPATE is the command."""
import glob
import json
import os
import statistics
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
PALPATE = os.path.abspath(os.environ.get("PALPATE", os.path.join(HERE, "../../../build/palpate")))


def forces(path):
    lines = [line for line in open(path) if not line.startswith("#")]
    at = [name.startswith("force_N") for name in lines[0].strip().split(",")].index(True)
    return [float(line.split(",")[at]) for line in lines[1:]]


def missed(measured, predicted):
    """rms of measured - zero - gain predicted."""
    line = statistics.linear_regression(predicted, measured)
    return statistics.fmean((y - line.intercept - line.slope * x) ** 2 for x, y in zip(predicted, measured, strict=True)) ** 0.5


def predict(runs, left, options, scratch):
    model, out = os.path.join(scratch, "model.json"), os.path.join(scratch, "out.csv")
    fit = subprocess.run([PALPATE, "characterize", *(r for r in runs if r != left), *options, "--out", model, "--force"],
                         capture_output=True, text=True)
    if fit.returncode in (0, 3):  # 3: not converged, but written
        subprocess.run([PALPATE, "simulate", model, "--like", left, "--out", out, "--force"], capture_output=True, check=True)
        return forces(out)
    sys.exit(f"left_out.py: {left}: {fit.stderr.splitlines()[-1]}")


def both(name, runs, options, scratch, level):
    """What is missed of the first run and of the middle one, each predicted from the others; level of forces is the unit."""
    found = []
    for left in (runs[0], runs[len(runs) // 2]):
        measured = forces(left)
        found.append(missed(measured, predict(runs, left, options, scratch)) / level(measured))
        print(f"{name}  {os.path.basename(left)}  {found[-1]:.3g}", flush=True)
    return found


def main(arguments):
    files = [a for a in arguments if a.endswith(".csv")]
    all_ = []
    with tempfile.TemporaryDirectory() as scratch:
        if files:
            options = [a for a in arguments if a not in files]
            all_ = both("", files, options, scratch, lambda force: max(map(abs, force)) / 100)
        else:
            options = [a for a in arguments[1:] if a != "--all"]
            truth = json.load(open(os.path.join(arguments[0], "truth.json")))
            for case in truth["cases"] if isinstance(truth, dict) else truth:
                if "--all" in arguments or (not case["effect"] and not case["outside"]):
                    runs = sorted(glob.glob(os.path.join(arguments[0], "cases", case["case"], "run_*.csv")))
                    own = case["characterize"].split() + options
                    all_ += both(f"{case['case']}  {case['world']:14}", runs, own, scratch, lambda _, n=case["noise_N"]: n)
    print(f"{len(all_)} runs: median {statistics.median(all_):.3g}, largest {max(all_):.3g}")


if __name__ == "__main__":
    main(sys.argv[1:])
