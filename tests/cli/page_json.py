"""page_json.py PAGE [RESULT.json ...]: prints the JSON in a page of results, with two blanks of indent. Fails if the page is not whole, asks for
anything beyond itself, has markup in its JSON, or if the JSON is not that of each file, but for the command and the figures."""
import json
import re
import sys

with open(sys.argv[1], encoding="utf-8") as f:
    text = f.read()
head, found, rest = text.partition('<script type="application/json" id="result">')
inside, end, script = rest.partition("</script>")
assert text.startswith("<!DOCTYPE html>") and found and end and script.rstrip().endswith("</script>"), "no whole page"
assert text.count("<script") == text.count("</script>") == 2, "more scripts than the page's two"
assert not re.search("[<>&]", inside), "markup in the JSON"
assert not re.search(r"""(src|href)=["'](?!data:,)|@import|<link(?! rel="icon")|\burl\(|\bfetch\(|XMLHttpRequest|\beval\(|innerHTML""", head + script), "not self-contained"
assert "<noscript>" in head, "nothing is said without a script"
result = json.loads(inside)


def bare(value):
    return {k: v for k, v in value.items() if k not in ("command", "figures")}


for path in sys.argv[2:]:
    with open(path, encoding="utf-8") as f:
        assert bare(json.load(f)) == bare(result), f"the page has another result than {path}"
print(json.dumps(result, indent=2, ensure_ascii=False))
