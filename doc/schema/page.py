#!/usr/bin/env python3
"""page.py: doc/json.md from the schemas beside this file: python3 doc/schema/page.py >doc/json.md"""
import json
import os

HERE = os.path.dirname(os.path.abspath(__file__))
ORDER = ["experiment", "model", "reduced", "characterize", "calibrate", "explain", "figure", "simulate", "inclusion", "reduce", "export", "acquire", "firmware",
         "protocol", "calibration", "machine", "calibrate_device", "actuator", "batch", "benchmark", "benchmark_result"]
HEAD = """# Files and results in JSON

Every JSON that palpate reads or writes, key by key. The same for programs: `schema/*.json`, one JSON Schema each, of which this page is
made (`python3 doc/schema/page.py`); `tests/cli/json.sh` checks what the commands write against them.

- A unit is the end of a key's name: `_mm`, `_N`, `_s`, `_Ns` (N s), `_Pa`, `_percent`. A share, a strain and a correlation have none.
- `null` stands for a number that is not known or not finite.
- A key marked **needed** is always there in what is written, and must be there in what is read; the others may be missing. No other keys are
  written. In a file that is read an unknown key is an error; only an experiment may have any.
- `x[]` is each item of a list, `x.y` the key y of x.
- `"palpate": {"model": 1}` and the like say what a file is. The number goes up when a file of the old form can no longer be read.
"""


def load(name):
    with open(os.path.join(HERE, name), encoding="utf-8") as f:
        return json.load(f)


def resolve(schema, file):
    """The schema that a reference stands for, and the file it is in."""
    while "$ref" in schema:
        name, _, place = schema["$ref"].partition("#")
        file = name or file
        own, schema = schema, load(file)
        for part in place.split("/")[1:]:
            schema = schema[part]
        if not place:
            return {"type": "object", "description": own.get("description", "As in " + file + ".")}, file
        schema = {**schema, **{k: v for k, v in own.items() if k != "$ref"}}
    return schema, file


def branches(schema, file):
    """What a value may be: the forms of oneOf that say more than which keys are needed."""
    forms = [resolve(f, file) for f in schema.get("oneOf", [])]
    return [f for f in forms if set(f[0]) - {"required"}]


def type_of(schema, file):
    forms = branches(schema, file)
    if forms:
        return " or ".join(dict.fromkeys(type_of(*f) for f in forms))
    if "enum" in schema:
        return "an effect" if "relaxation_arm" in schema["enum"] else ", ".join("`%s`" % v for v in schema["enum"])
    if "const" in schema:
        return "`%s`" % schema["const"]
    types = schema.get("type", "any")
    words = " or ".join(types) if isinstance(types, list) else types
    if types == "array" and "type" in resolve(schema["items"], file)[0]:
        words = "list of " + type_of(*resolve(schema["items"], file))
    return words


def rows(schema, file, path=""):
    """(path, needed, type, description) of all keys below a schema, in order."""
    for form in branches(schema, file):
        yield from rows(*form, path)
    if isinstance(schema.get("items"), dict):
        yield from rows(*resolve(schema["items"], file), path + "[]")
    for key, value in schema.get("properties", {}).items():
        value, where = resolve(value, file)
        name = path + "." + key if path else key
        yield name, key in schema.get("required", []), type_of(value, where), value.get("description", "")
        yield from rows(value, where, name)


def main():
    print(HEAD, end="")
    for name in ORDER:
        schema = load(name + ".json")
        print("\n## %s\n\n%s Schema: [%s.json](schema/%s.json).\n\n| key | | type | what |\n| --- | --- | --- | --- |" %
              (schema["title"], schema["description"], name, name))
        seen = set()
        for path, needed, kind, text in rows(schema, name + ".json"):
            if (path, text) not in seen:
                print("| `%s` |%s| %s | %s |" % (path, " **needed** " if needed else " ", kind, text.replace("|", "\\|")))
            seen.add((path, text))


if __name__ == "__main__":
    main()
