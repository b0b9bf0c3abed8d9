#!/usr/bin/env python3
"""Holds the free terms of `palpate explain --sparse` against the truth of the set outside (run.sh --set outside).

    judge_free.py DIR        the --out of run.sh

The truth closes the gap on runs left out down to the noise of the generator; a case whose gap is less than a twentieth of that noise
has nothing to close."""
import argparse
import os
import statistics

from judge import asked  # which finds score
from score import load, share

CLASSES = {
    "hysteresis of the load cell": ("dissipative",), "backlash": ("dissipative",), "curing within a run": ("of the age",),
    "gain of the position": ("elastic", "of the place"), "slip at the grip": ("dissipative",),
    "a frame that rings": ("dissipative",), "warm-up of each run": ("of the clock",), "room over the session": ("of the session",),
    "damping of power 0.4": ("dissipative",), "a side wall": ("dissipative",)}
SHAPE = 0.25    # of an exponent or a time: so near it is the generator's own


def closed(truth, result):
    """Share of what the truth would close that is closed on runs left out; None: there is nothing to close."""
    free, left = result.get("free_term"), result["gap"]["heldout_after_N"]     # what law and effects close is not a term's
    before = free["heldout_before_N"] if free else left
    after = free["heldout_after_N"] if free else left
    open_ = before - truth["noise_N"]
    return (before - after) / open_ if open_ > 0.05 * truth["noise_N"] else None


def formula_right(form, term):
    parts = (term.get("formula") or {}).get("parts") or []
    return len(parts) == 1 and parts[0]["form"] == form["form"] and abs(parts[0]["shape"] / form["shape"] - 1) < SHAPE


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("folder", metavar="DIR")
    o = p.parse_args()
    shares, nulls, classes, formulas = [], [], [], []
    for truth, result, _ in asked(o.folder, load(os.path.join(o.folder, "truth.json"))["cases"]):
        terms = ((result or {}).get("free_term") or {}).get("terms") or []
        if not truth["outside"]:
            nulls.append(result is not None and not terms)
            print("%-9s %-13s nothing%s" % (truth["case"], truth["world"], "" if nulls[-1] else ": WRONG"))
            continue
        part = closed(truth, result) if result else 0
        shares += [] if part is None else [part]
        first = max(terms, key=lambda t: t["rms_N"], default=None)
        classes.append(first is not None and first["class"] in CLASSES[truth["outside"]])
        if "form" in truth:
            formulas.append(any(formula_right(truth["form"], t) for t in terms))
        print("%-9s %-13s %-27s %5.0f nats  %-15s closes %5s  %s" % (
            truth["case"], truth["world"], truth["outside"], truth["nats"], ", ".join(e["id"] for e in (result or {}).get("effects", [])),
            "-" if part is None else "%.2f" % part,
            "; ".join("%s %s %s" % (t["depends_on"], t["class"], (t.get("formula") or {}).get("text", "")) for t in terms) or "no term"))
    if shares:
        print("\nshare closed of what the truth would close: median %.2f, least %.2f, 0.8 and more in %s" % (
            statistics.median(shares), min(shares), share(sum(s >= 0.8 for s in shares), len(shares))))
    print("class right: %s; nulls without a term: %s; formula right: %s" % (
        share(sum(classes), len(classes)), share(sum(nulls), len(nulls)), share(sum(formulas), len(formulas))))


if __name__ == "__main__":
    main()
