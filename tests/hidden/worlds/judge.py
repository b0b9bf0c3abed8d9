#!/usr/bin/env python3
"""Holds the answers of `palpate characterize` and `palpate explain` against the truth of laboratories that are not ours.

    judge.py DIR [--report-only] [--print-table]
    judge.py DIR --manifest characterize|explain|oracle [OPTION...]     for palpate batch, with these options more
    judge.py --self-test

DIR is the --out of run.sh: DIR/characterize/ has the models, DIR/explain/ the answers, DIR/oracle/ (if there) those where only the true
effect and a relaxation arm were candidates. Exit code 0 if all were asked for and every bar is met; with --report-only always."""
import argparse
import os
import statistics
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from score import answers, inside, load, manifest, share, show, wilson  # noqa: E402

SEEN = 20.0     # nats from which an effect must be found
SAME = 0.9      # cosine from which another effect is as good an answer
APART = ("one_recording", "one_speed", "no_unloading")  # where little can be told apart
TIMES = ("relaxation_arm", "power_law_relaxation", "poroelastic")
# What every case has: a contact, zero and gain of each run's own, and a law that is not the given one.
GRANTED = ("contact_offset", "contact_scatter", "zero_scatter", "gain_scatter", "stiffness_law")
INSTRUMENT = ("adhesion", "contact_offset", "toe_region", "plate_slip", "frame_compliance", "plate_inertia", "coulomb_friction",
              "sensor_lag", "sensor_bias", "sensor_drift", "sensor_gain", "force_saturation", "mains_hum", "drive_ripple")
WAVES = ("mains_hum", "drive_ripple")  # their periods tell them at any speed


def like(truth, given):
    """Whether the effect that was given is the true one, or as good an answer."""
    true, cosine = truth["effect"]["id"], truth["cosine"].get(given["id"], 0)
    alike = true in (given.get("class") or [])
    return given["id"] == true or cosine >= SAME or alike and (cosine >= SAME - 0.1 or given["id"] in TIMES and true in TIMES)


class Case:
    def __init__(self, truth, result, oracle=None, arms=None):
        self.truth, self.result, self.oracle = truth, result, oracle
        self.name, self.world = truth["case"], truth["world"]
        self.verdict = result.get("verdict", "none") if result else "none"
        self.named = result["effects"] if result else []
        self.effect, self.outside = truth["effect"], truth["outside"]
        few = arms is not None and arms < truth["arms"]     # the model that was given lacks an arm indeed
        self.granted = GRANTED + (TIMES if few else ())
        self.pair = truth.get("second")     # a second effect, with nats and cosine of its own
        self.answer = next((e for e in self.named if self.effect and like(self.truth, e)), None)
        self.other = next((e for e in self.named if self.pair and e is not self.answer and like(self.pair, e)), None)
        self.extra = [e["id"] for e in self.named if e is not self.answer and e is not self.other and e["id"] not in self.granted]

    def seen(self):
        return bool(self.effect) and self.truth["nats"] >= SEEN

    def wrong(self):
        """What is wrong with the answer, in words; empty if nothing."""
        if self.verdict == "none":
            return "no answer"
        if self.world in APART:
            accused = [x for x in self.extra if x in INSTRUMENT]
            if self.world == "one_speed" and self.answer and self.effect["id"] in INSTRUMENT and self.effect["id"] not in WAVES:
                accused.append(self.answer["id"])
            return "an instrument is accused" if accused else ""
        if self.outside:
            return "named as of the catalogue" if self.extra else ""
        if not self.effect:
            return "a null is accused" if self.extra else ""
        missed = self.seen() and not self.answer or self.pair and not self.other
        return ", ".join(["missed"] * bool(missed) + ["something extra"] * bool(self.extra))


def outcome(cases, of, failed):
    list_ = [c for c in cases if of(c)]
    return len(list_), sum(1 for c in list_ if failed(c) or c.verdict == "none")


def intervals(cases):
    """Of effects that were named by their own name: parameters within their intervals, and how many."""
    hits = n = 0
    for c in cases:
        if not c.answer or c.answer["id"] != c.effect["id"]:
            continue
        for key, value in c.effect["parameters"].items():
            interval = (c.answer.get("intervals") or {}).get(key)
            if interval and None not in interval:
                n += 1
                hits += inside(key, value, interval)
    return n, hits


def closed(result):
    return ((result or {}).get("gap") or {}).get("closed") or 0.0


def bars(cases):
    """Each bar: what, in words what came of it, what is wanted, whether it is met (None: nothing to judge)."""
    main = [c for c in cases if c.world not in APART and not c.pair]
    pairs_ = [c for c in cases if c.pair]
    apart = [c for c in cases if c.world in APART]
    rows = []
    for what, list_, of, failed in (
            ("right effect or its class", main, Case.seen, lambda c: not c.answer),
            ("nothing extra", main, Case.seen, lambda c: c.extra),
            ("nulls not accused", main, lambda c: not c.effect and not c.outside, lambda c: c.extra),
            ("outside the catalogue not named as of it", main, lambda c: c.outside, lambda c: c.extra),
            ("little to tell apart: no instrument accused", apart, lambda c: True, Case.wrong)):
        n, wrong = outcome(list_, of, failed)
        rows.append((what, share(n - wrong, n), "95 %", wrong <= 0.05 * n if n else None))
    n, wrong = outcome(pairs_, lambda c: True, Case.wrong)
    rows.append(("pairs: both effects, nothing extra", share(n - wrong, n), "85 %", wrong <= 0.15 * n if n else None))
    n, hits = intervals(main)
    rows.append(("parameters within their intervals", share(hits, n), "92 to 98 %",
                 0.92 <= hits / n and wilson(hits, n)[0] <= 0.98 if n else None))
    pairs = [(closed(c.result), closed(c.oracle)) for c in main if c.seen() and c.oracle]
    ours, best = (statistics.median(p[k] for p in pairs) if pairs else 0 for k in (0, 1))
    words = "median %.3f, oracle's %.3f (%d cases)" % (ours, best, len(pairs))
    return rows + [("share of the gap closed", words, "0.95 of the oracle's", ours >= 0.95 * best if pairs else None)]


def table_of_worlds(cases, markdown):
    """Worst first."""
    rows = []
    for world in sorted({c.world for c in cases}):
        of = [c for c in cases if c.world == world]
        parts = [(lambda c: not c.effect and not c.outside), (lambda c: c.effect and not c.pair), (lambda c: c.pair), (lambda c: c.outside)]
        right = ["%d/%d" % (sum(bool(p(c)) and not c.wrong() for c in of), sum(bool(p(c)) for c in of)) for p in parts]
        said = ["%d" % sum(c.verdict == v for c in of) for v in
                ("agrees", "explained", "ambiguous", "suspected", "unexplained", "none")]
        rows.append((sum(not c.wrong() for c in of) / len(of), [world, *right, *said]))
    rows.sort(key=lambda r: r[0])
    show("Right answers and verdicts by laboratory, worst first", ["laboratory", "nulls", "effects", "pairs", "outside", "agrees", "explained",
         "ambiguous", "suspected", "unexplained", "no answer"], [r for _, r in rows], markdown)


def in_words(c):
    if c.outside:
        return "%s (%.0f nats)" % (c.outside, c.truth["nats"])
    if not c.effect:
        return "nothing, %d arms" % c.truth["arms"]
    both = [c.truth] + ([c.pair] if c.pair else [])
    return " and ".join("%s %s (%.0f nats)" % (t["effect"]["id"], "/".join("%.3g" % v for v in t["effect"]["parameters"].values()), t["nats"])
                        for t in both)


def table_of_wrong(cases):
    worst = {w: sum(bool(c.wrong()) for c in cases if c.world == w) for w in {c.world for c in cases}}
    print("Wrong, worst laboratory first")
    for c in sorted(cases, key=lambda c: (-worst[c.world], c.world, c.name)):
        if c.wrong():
            named = ", ".join("%s (%s)" % (e["id"], ", ".join("%s %.3g" % (k, v) for k, v in e["parameters"].items() if v is not None))
                              for e in c.named)
            print("    %-17s %s %s; true: %s; named: %s [%s]" % (c.world, c.name, c.wrong(), in_words(c), named or "nothing", c.verdict))
    print()


def other_counts(cases):
    main = [c for c in cases if c.world not in APART]
    for what, of in (("nulls", lambda c: not c.effect and not c.outside), ("effects", Case.seen), ("outside", lambda c: c.outside)):
        list_ = [c for c in main if of(c)]
        print("Verdicts, %s: %s" % (what, ", ".join("%s %d" % (v, sum(c.verdict == v for c in list_))
                                                    for v in ("agrees", "explained", "ambiguous", "unexplained", "none"))))
    print()


def in_turns(truths):
    """One case of each laboratory and kind after the other, so that what an interrupted run has says something of all."""
    turn, turns = {}, []
    for t in truths:
        key = (t["world"], bool(t["effect"]), bool(t["outside"]), bool(t.get("second")))
        turn[key] = turn.get(key, 0) + 1
        turns.append((turn[key], len(turns), t))
    return [t for _, _, t in sorted(turns, key=lambda x: x[:2])]


def self_test():
    """Answers whose judgement is known."""
    def case(world, effect, named, outside="", nats=100, cosine=None, arms=2, given=2, second=None):
        truth = {"case": "x", "world": world, "effect": effect and {"id": effect, "parameters": {"force_N": 1.0}}, "outside": outside,
                 "nats": nats, "cosine": cosine or {}, "arms": arms}
        if second:
            truth["second"] = {"effect": {"id": second, "parameters": {}}, "nats": 100, "cosine": {}}
        effects = [{"id": i, "parameters": {"force_N": 1.0}, "intervals": {"force_N": [0.9, 1.1]}, "class": [i]} for i in named]
        return Case(truth, {"verdict": "explained", "effects": effects, "gap": {"closed": 1.0}}, arms=given)
    wanted = [
        (case("cheap", None, []), ""), (case("cheap", None, ["sensor_lag"]), "a null is accused"),
        (case("cheap", None, ["contact_offset"]), ""), (case("cheap", None, ["relaxation_arm"]), "a null is accused"),
        (case("cheap", None, ["relaxation_arm"], given=1), ""),
        (case("cheap", "sensor_lag", ["sensor_lag"]), ""), (case("cheap", "sensor_lag", []), "missed"),
        (case("cheap", "sensor_lag", [], nats=10), ""), (case("cheap", "sensor_lag", ["mains_hum"]), "missed, something extra"),
        (case("cheap", "sensor_lag", ["plate_inertia"], cosine={"plate_inertia": 0.95}), ""),
        (case("cheap", "sensor_lag", ["sensor_lag", "adhesion"]), "something extra"),
        (case("cheap", None, ["sensor_drift"], outside="zeros that wander"), "named as of the catalogue"),
        (case("cheap", None, [], outside="zeros that wander"), ""),
        (case("one_speed", "coulomb_friction", ["coulomb_friction"]), "an instrument is accused"),
        (case("no_unloading", "sensor_lag", ["sensor_lag"]), ""), (case("no_unloading", "sensor_lag", ["adhesion"]), "an instrument is accused"),
        (case("one_recording", "sensor_lag", []), ""),
        (case("servo", "sensor_lag", ["adhesion", "sensor_lag"], second="adhesion"), ""),
        (case("servo", "sensor_lag", ["sensor_lag"], second="adhesion"), "missed"),
        (case("servo", "sensor_lag", ["sensor_lag", "mains_hum", "adhesion"], second="adhesion"), "something extra")]
    failed = [(c.effect, [e["id"] for e in c.named], c.wrong(), w) for c, w in wanted if c.wrong() != w]
    nothing = Case(dict(wanted[0][0].truth), None)
    if nothing.wrong() != "no answer" or intervals([wanted[5][0]]) != (1, 1):
        failed.append("no answer, intervals")
    by = {row[0]: row[3] for row in bars([c for c, _ in wanted])}
    if by["nulls not accused"] or by["right effect or its class"] or by["share of the gap closed"] is not None:
        failed.append("bars")
    for f in failed:
        print("judge.py: self test:", f)
    return not failed


def jobs(step, truths, made, options):
    """What characterize refused is not explained."""
    for t in in_turns(truths):
        case, model = t["case"], ("--model", "{}/model.json")
        if step == "characterize":
            yield (case, step, *t["characterize"].split(), *options, "--out", model[1], "--json", "--force")
        elif not made.get(case, [None])[0]:
            continue
        elif step == "explain":
            yield (case, step, *model, "--sparse", *options, "--out", "{}/explained.json", "--json", "--force")
        elif t["effect"] and not t.get("second") and t["nats"] >= SEEN and t["world"] not in APART:
            arm = "" if t["effect"]["id"] == "relaxation_arm" else ",relaxation_arm"    # characterize may have found fewer than there are
            yield (case, "explain", *model, "--candidates", t["effect"]["id"] + arm, *options, "--json")


def asked(folder, truths):
    """truth, answer or None, the number of arms of characterize's model or None; of the cases that were asked for."""
    made, given = answers(folder, "characterize"), answers(folder, "explain")
    for t in truths:
        model, answer = (of.get(t["case"]) for of in (made, given))
        if answer or model and not model[0]:
            file = load(os.path.join(folder, "cases", t["case"], "model.json")) if model[0] else None
            yield t, answer[0] if answer else None, len(file.get("arms", [])) if file else None


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("folder", metavar="DIR", nargs="?")
    p.add_argument("--manifest", choices=("characterize", "explain", "oracle"))
    p.add_argument("--self-test", action="store_true")
    p.add_argument("--report-only", action="store_true")
    p.add_argument("--print-table", action="store_true")
    o, options = p.parse_known_args()
    if o.self_test:
        sys.exit(0 if self_test() else 1)
    truth = load(os.path.join(o.folder, "truth.json")) if o.folder else None
    if not truth or options and not o.manifest:
        sys.exit("judge.py: needs a folder with truth.json, and options of the command only with --manifest")
    if o.manifest:
        manifest(o.folder, jobs(o.manifest, truth["cases"], answers(o.folder, "characterize"), options))
        return
    oracle = answers(o.folder, "oracle")
    cases = [Case(t, result, oracle.get(t["case"], [None])[0], arms) for t, result, arms in asked(o.folder, truth["cases"])]
    judged = bars(cases)
    print("%d of %d cases of seed %s, set %s\n" % (len(cases), len(truth["cases"]), truth["seed"], truth["set"]))
    words = {True: "met", False: "NOT MET", None: "not judged"}
    show("Bars", ["bar", "result", "wanted", ""], [[*texts, words[met]] for *texts, met in judged], o.print_table)
    table_of_worlds(cases, o.print_table)
    if not o.print_table:
        other_counts(cases)
        table_of_wrong(cases)
    met = len(cases) == len(truth["cases"]) and all(met is not False for *_, met in judged)
    sys.exit(0 if met or o.report_only else 1)


if __name__ == "__main__":
    main()
