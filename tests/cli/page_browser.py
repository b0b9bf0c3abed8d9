"""page_browser.py: the pages of the folder in a browser; called by page_browser.sh."""
import json
import os
import re
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "panel"))
from browser import Browser

# Of each figure: its name, the curves' numbers of points, places where texts lie over each other or beyond the drawing, and whether it can be saved.
FIGURES = """[...document.querySelectorAll("figure[data-name]")].map(figure => {
  const svg = figure.querySelector("svg"), frame = svg.getBoundingClientRect(), bad = [];
  const texts = [...svg.querySelectorAll("text")].map(t => [t.textContent, t.getBoundingClientRect()]);
  texts.forEach(([name, a], i) => {
    if (a.left < frame.left - 1 || a.right > frame.right + 1 || a.top < frame.top - 1 || a.bottom > frame.bottom + 1) bad.push(name + " is beyond the drawing");
    for (const [other, b] of texts.slice(i + 1))
      if (Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 3) bad.push(name + " over " + other);
  });
  const saved = new DOMParser().parseFromString(new XMLSerializer().serializeToString(svg), "image/svg+xml");
  return { name: figure.dataset.name, caption: figure.querySelector("figcaption b").textContent, title: svg.querySelector("title").textContent, bad,
    points: [...svg.querySelectorAll("path.curve")].map(p => (p.getAttribute("d").match(/[ML]/g) ?? []).length), good: !saved.querySelector("parsererror") };
})"""
TABLES = """[...document.querySelectorAll("table")].map(t => ({ caption: t.caption && t.caption.textContent,
  rows: [...t.tBodies[0].rows].map(r => [...r.cells].map(c => c.textContent)) }))"""


def points(series, panel):
    """How many points of a series are drawn: of a band there and back."""
    values = zip(series["x"], series.get("y", series.get("low")))
    n = sum(y is not None and (x > 0 or not panel["x_log"]) and (y > 0 or not panel["y_log"]) for x, y in values)
    return 2 * n if series["style"] == "band" else n


def check_figures(shown, result):
    own = [f for r in [result, *[x["result"] for x in result.get("results", [])]] for f in r.get("figures", [])]
    assert own or result["palpate"].get("explain"), "no figures in the JSON"
    for figure in own:
        found = [f for f in shown if f["name"] == figure["name"] and f["title"] == figure["title"]]
        assert len(found) == 1, f"{figure['name']}: there {len(found)} times"
        wanted = [points(s, p) for p in figure["panels"] for s in p["series"]]
        assert found[0]["points"] == wanted, f"{figure['name']}: {found[0]['points']} points, not {wanted}"
    for figure in shown:
        assert figure["points"] and all(figure["points"]), f"{figure['name']}: a curve is empty: {figure['points']}"
        assert figure["caption"] == figure["title"] and figure["good"], figure["name"]


def near(text, value, unit=1):
    assert abs(float(text) - unit * value) <= 0.02 * abs(unit * value) + 1e-12, f"{text} is shown for {unit * value}"


def table(tables, caption):
    found = [t for t in tables if t["caption"] == caption]
    assert len(found) == 1, f"{len(found)} tables {caption}: {[t['caption'] for t in tables]}"
    return found[0]["rows"]


def check_explain(b, result, tables):
    assert b.run("document.querySelector('.verdict b').textContent") == result["sentences"][0]
    assert b.run(f"document.querySelector('.verdict').classList.contains({json.dumps(result['verdict'])})")
    said = b.run("[...document.querySelectorAll('.verdict p')].map(p => p.textContent)")
    assert all(s in said for s in result["sentences"][1:]), said
    assert [e["id"] for e in result["effects"]] == ["sensor_lag"], "the lag was not found"
    near(*next((r[1], result["effects"][0]["parameters"]["time_s"]) for t in tables for r in t["rows"] if r[-1] == "time_s"))
    text = b.run("document.body.innerText")
    assert result["next_sentence"] in text and result["catalogue"]["sensor_lag"]["means"] in text
    bars = [len(step["rejected"]) + (step["taken"] is not None) for step in result["steps"]]
    assert b.run("document.querySelectorAll('.candidates td.bars').length") == sum(bars), "a bar for each candidate of each step"
    for one in result["profile"]["experiments"]:
        assert any(r[0] == os.path.basename(one["experiment"]) for t in tables for r in t["rows"]), one["experiment"]


def check_characterize(result, tables, others):
    rows = table(tables, "The model: one law, one set of arms")
    # the knots of a spline are in a figure
    listed = [e for e in result["estimates"] if result["law"]["kind"] != "spline" or not re.match(r"c\d", e["name"])]
    assert [r[0] for r in rows] == [e["name"] for e in listed]
    for row, e in zip(rows, listed):
        if e["determined"]:
            assert abs(float(row[1]) - e["value"]) <= 0.03 * (e["high"] - e["low"]), f"{row} is shown for {e}"
    rows = table(tables, "Residuals of the model")
    for row, run in zip(rows, result["runs"], strict=True):
        assert row[0] == os.path.basename(run["file"])
        near(row[1], run["rms_N"], 1000)
    named = [f["name"] for f in others]
    for name in ["stiffness_law", *(["static_polynomials"] if result["static"] else []),
                 *(["spectrum"] if result["spectrum"] else []), *(["specimens"] if result["specimens"] else [])]:
        assert named.count(name) == 1, f"{name} is there {named.count(name)} times"


def check_calibrate(result, tables, others):
    for row, depth in zip(table(tables, "Network against its target, ramp and hold"), result["depths"], strict=True):
        near(row[0], depth["depth_mm"])
        near(row[1], depth["peak_N"])
    named = [f["name"] for f in others]
    assert "static_convergence" in named and "relaxation_convergence" in named, named


def check_words(text):
    for word in "NaN", "undefined", "Infinity", "[object", "null":
        assert word not in text.replace("null threshold", ""), f"{word}: {text[max(0, text.index(word) - 100):][:200]}"


def hollow(value, numbers=True, lists=True):
    """The same without any number, or with all lists empty."""
    if isinstance(value, dict):
        return {k: v if k == "palpate" else hollow(v, numbers, lists) for k, v in value.items()}
    if isinstance(value, list):
        return [hollow(v, numbers, lists) for v in value] if lists else []
    return None if not numbers and isinstance(value, (int, float)) and not isinstance(value, bool) else value


CHECKS = {"explain": lambda b, r, t, f: check_explain(b, r, t), "characterize": lambda b, r, t, f: check_characterize(r, t, f),
          "calibrate": lambda b, r, t, f: check_calibrate(r, t, f)}

b = Browser("about:blank", os.path.abspath("profile"))
try:
    b.call("Page.addScriptToEvaluateOnNewDocument", source="window.errors = []; addEventListener('error', e => errors.push(e.message))")
    for page in ["explain", "characterize", "calibrate", "sine", "specimens", "report"]:
        for width in 1300, 400:
            print(f"{page} at {width} px")
            b.call("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=False)
            b.call("Page.navigate", url=f"file://{os.getcwd()}/{page}.html")
            b.until(f"location.pathname.endsWith('/{page}.html') && innerWidth === {width} && document.querySelector('#page h1') && document.readyState === 'complete'")
            assert b.run("errors") == [], b.run("errors")
            assert b.run("document.images.length") == 0, "a name became an element"
            wide = b.run("document.documentElement.scrollWidth")
            assert wide <= width, f"the page is {wide} px wide"
            result, shown, tables = (b.run(s) for s in ("JSON.parse(document.getElementById('result').textContent)", FIGURES, TABLES))
            assert [f["bad"] for f in shown if f["bad"]] == [], [(f["name"], f["bad"]) for f in shown if f["bad"]]
            check_figures(shown, result)
            check_words(b.run("document.body.innerText"))
            for one in [x["result"] for x in result.get("results", [])] or [result]:
                next(check for kind, check in CHECKS.items() if kind in one["palpate"])(b, one, tables, shown)
    links = b.run("[...document.querySelectorAll('nav a')].map(a => a.getAttribute('href').slice(1)).filter(id => !document.getElementById(id))")
    assert links == [] and b.run("document.querySelectorAll('nav a').length") == 9, links
    for file in result["files"]:
        assert any(row[0] == os.path.basename(file["file"]) and row[3] == file["crc32"] for t in tables for row in t["rows"] if len(row) == 6), file
    for page in ["explain", "characterize", "calibrate", "report"]:
        with open(page + ".html", encoding="utf-8") as f:
            head, _, rest = f.read().partition('id="result">')
            text, _, tail = rest.partition("</script>")
        whole = json.loads(text)
        for what, other in ("no number", hollow(whole, numbers=False)), ("empty lists", hollow(whole, lists=False)), ("nothing", {"palpate": whole["palpate"]}):
            print(f"{page} with {what}")
            with open("hollow.html", "w", encoding="utf-8") as f:
                f.write(head + 'id="result">' + json.dumps(other).replace("<", "\\u003c") + "</script>" + tail)
            b.call("Page.navigate", url="about:blank")
            b.call("Page.navigate", url=f"file://{os.getcwd()}/hollow.html")
            b.until("location.pathname.endsWith('/hollow.html') && document.readyState === 'complete'")
            assert b.run("errors") == [] and b.run("document.querySelectorAll('h1').length") == 1, b.run("errors")
            check_words(b.run("document.body.innerText"))
finally:
    b.close()
