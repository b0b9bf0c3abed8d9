"""json_check.py SCHEMAS KIND=FILE ...: files against their JSON Schemas, and the schemas against the files.

Every file must be valid. Every key that it has and the schema calls needed is taken out, and to every object a key is added: the schema must
refuse both. The effects are those of doc/effects.md. Prints the keys of the schemas that no file has.
"""
import copy
import json
import re
import sys

import jsonschema

sys.dont_write_bytecode = True
folder = sys.argv[1]
sys.path.insert(0, folder)
import page

bad = []


def read(kind, path):
    with open(path, encoding="utf-8") as f:
        if kind != "experiment":
            return json.load(f)
        lines = [line[2:].partition(": ") for line in f if line.startswith("# ")]
        return {key: json.loads(value) for key, _, value in lines}


def checker(schema, kind):
    base = "file://" + folder + "/" + kind + ".json"
    return jsonschema.Draft202012Validator(schema, resolver=jsonschema.RefResolver(base, schema))


def places(value, items, path=()):
    """Each object in a value, of each list the first so many items."""
    if isinstance(value, dict):
        yield path
        for key, inner in value.items():
            yield from places(inner, items, path + (key,))
    elif isinstance(value, list):
        for i, inner in enumerate(value[:items]):
            yield from places(inner, items, path + (i,))


def at(value, path):
    for step in path:
        value = value[step]
    return value


def name_of(path):
    name = ""
    for step in path:
        name += "[]" if isinstance(step, int) else ("." if name else "") + step
    return name


def change(validator, value, path, what, edit):
    other = copy.deepcopy(value)
    edit(at(other, path))
    if validator.is_valid(other):
        bad.append("%s: the schema takes it with %s" % (name_of(path) or "the file", what))


def check(kind, path, needed, seen, free):
    value, validator = read(kind, path), checker(page.load(kind + ".json"), kind)
    for error in validator.iter_errors(value):
        deepest = error
        while deepest.context:
            deepest = max(deepest.context, key=lambda e: len(e.absolute_path))
        bad.append("%s: %s: %s" % (path, "/".join(map(str, deepest.absolute_path)), deepest.message[:300]))
    for place in places(value, None):
        seen.update(name_of(place + (key,)) for key in at(value, place))
    for place in places(value, 1):
        if name_of(place) in free:  # numbers by names that another page lists
            continue
        change(validator, value, place, "an unknown key", lambda o: o.update(unknown_key=1))
        for key in at(value, place):
            whole = name_of(place + (key,))
            if whole in needed:
                change(validator, value, place, "no " + key, lambda o, k=key: o.pop(k))


def main():
    seen, needed, free = {}, {}, {}
    for argument in sys.argv[2:]:
        kind, _, path = argument.partition("=")
        schema = page.load(kind + ".json")
        jsonschema.Draft202012Validator.check_schema(schema)
        if kind not in seen:
            listed = list(page.rows(schema, kind + ".json"))
            needed[kind] = {row[0] for row in listed if row[1]}
            free[kind] = {row[0] for row in listed if row[2] == "object" and row[0].endswith(("parameters", "intervals", "figures"))}
            seen[kind] = set()
        check(kind, path, needed[kind], seen[kind], free[kind])
    with open(folder + "/../effects.md", encoding="utf-8") as f:
        effects = re.findall(r"^### `(\w+)`$", f.read(), re.M)
    if page.load("model.json")["$defs"]["effect_id"]["enum"] != effects:
        bad.append("the schema's effects are not those of doc/effects.md")
    for kind in sorted(seen):
        for row in page.rows(page.load(kind + ".json"), kind + ".json"):
            if row[0] not in seen[kind]:
                print(kind, row[0])
    for line in bad:
        print("BAD", line)
    sys.exit(1 if bad else 0)


main()
