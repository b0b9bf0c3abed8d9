#!/usr/bin/env python3
"""picture.py PAGE.html|FIGURES.json OUT.svg [NAME ...]: figures side by side as one SVG, drawn by a headless chromium: those of these names on a
page of results, or all of a list of figures (doc/schema/figure.json)."""
import json
import os
import re
import subprocess
import sys
import tempfile

PAGE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "page", "page.")


def page_of(figures):
    """As tools/shared/page.c writes it."""
    html, css, js = (open(PAGE + kind, encoding="utf-8").read() for kind in ("html", "css", "js"))
    result = json.dumps({"palpate": {"report": 1}, "figures": figures}).replace("<", "\\u003c")
    return f'{html}<style>{css}</style><script type="application/json" id="result">{result}</script><script>{js}</script>'


def main():
    source, out, *names = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        path, width = os.path.abspath(source), 700
        if source.endswith(".json"):
            with open(source, encoding="utf-8") as f:
                figures = json.load(f)
            path, width = os.path.join(folder, "page.html"), 380
            with open(path, "w", encoding="utf-8") as f:
                f.write(page_of(figures))
        dom = subprocess.run(["chromium", "--headless", "--no-sandbox", "--disable-gpu", f"--window-size={width},1000", f"--user-data-dir={folder}/profile",
                              "--dump-dom", "file://" + path], check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout
    found = re.findall(r'<figure data-name="(\w+)"><svg (.*?)</svg><figcaption', dom, re.S)
    shown = [svg for name, svg in found if name in names or not names]
    assert shown, f"{source} has no figure {names}: {[name for name, _ in found]}"
    sizes = [[float(v) for v in re.search(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', svg).groups()] for svg in shown]
    with open(out, "w", encoding="utf-8") as f:
        wide, high = sum(s[0] for s in sizes), max(s[1] for s in sizes)
        f.write(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {wide:g} {high:g}" width="{wide:g}" height="{high:g}">\n')
        for k, (svg, (w, h)) in enumerate(zip(shown, sizes)):
            f.write(f'<svg x="{sum(s[0] for s in sizes[:k]):g}" width="{w:g}" height="{h:g}" {svg}</svg>\n')
        f.write("</svg>\n")


main()
