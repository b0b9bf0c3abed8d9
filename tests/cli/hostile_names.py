"""hostile_names.py PALPATE LUMPED NETWORK RUN STEP: every command on files with names that are no names, of which it
takes one in STEP.

Of each command: the exit code, no file called PW, which the names' commands would make, stderr and stdout of plain
UTF-8 without control characters, and outputs that are JSON, experiments and pages.
"""
import ast
import html.parser
import json
import os
import shutil
import subprocess
import sys
import xml.etree.ElementTree as xml
import zipfile

PALPATE, LUMPED, NETWORK, RUN = (os.path.abspath(a) for a in sys.argv[1:5])
STEP = int(sys.argv[5])
ACQUIRED = (1, 10, 15, 19)  # a press takes a second
BIN = os.path.abspath("bin")
LONGEST = 255 - len(b".simulated.csv")
NAMES = {
    "apostrophe": b"it's", "leading apostrophe": b"'; touch PW; '", "quote": b'a"b', "backtick": b"`touch PW`",
    "substitution": b"$(touch PW)", "variable": b"${IFS}$HOME", "semicolon": b"a; touch PW", "pipe": b"a| touch PW",
    "and": b"a && touch PW &", "redirection": b"a >PW <PW", "newline": b"q\nsystem \"touch PW\"\n",
    "newline and apostrophe": b"q'\n!touch PW\n'", "carriage return": b"a\rb", "tab": b"a\tb", "bell": b"\x1b]0;x\x07",
    "escape": b"\x1b[2Ja\x1b[31m", "delete": b"a\x7fb\x08", "short option": b"-rf", "long option": b"--help",
    "Latin-1": b"Gr\xf6\xdfe", "UTF-8": "Größe 高さ".encode(), "cut UTF-8": b"a\xe9\xab", "overlong": b"a\xc0\xaf",
    "C1 control": b"a\xc2\x9b2Jb", "direction": "a\u202egpj".encode(), "tag": b"<img src=x onerror=alert(1)>",
    "entity": b"&lt;b&gt;", "format": b"%s%n%100d", "backslash": b"a\\nb\\", "blank": b" *?[a] ~ ", "bar": b"|~a||",
    "comment": b"# a: 1", "comma": b"a,b", "longest": b"x" * LONGEST,
}


class Page(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.attributes = set()

    def handle_starttag(self, tag, attrs):
        self.attributes.update(name for name, _ in attrs)


def plain(data, allowed="\n"):
    text = data.decode()
    bad = [c for c in text if (c < " " and c not in allowed) or "\x7f" <= c < "\xa0" or c in "\u202e\u2028"]
    assert not bad, "control characters %r in %r" % (bad[:4], data[:300])
    return text


def check(path):
    """The file is what its name's end says."""
    with open(path, "rb") as f:
        data = f.read()
    assert data, "%r is empty" % path
    if path.endswith(b".json"):
        json.loads(data)
    elif path.endswith(b".html"):
        page = Page()
        page.feed(plain(data, "\n\t"))
        assert "onerror" not in page.attributes, "a name became a tag"
    elif path.endswith(b".csv"):
        lines = plain(data).splitlines()
        for line in lines:
            if line.startswith("# ") and lines[0].startswith("# "):
                json.loads(line.split(": ", 1)[1])


def run(wanted, *arguments, told=None):
    """Runs a command in this folder, where PATH has what a hostile name would call."""
    done = subprocess.run([PALPATE.encode(), *arguments], stdin=subprocess.DEVNULL, capture_output=True,
                          env={**os.environ, "PATH": BIN})
    what = b" ".join(arguments)
    lacks = b"built without" in done.stderr
    codes = wanted if isinstance(wanted, tuple) else (wanted,)
    assert done.returncode in ((1,) if lacks else codes), "%r: exit code %d: %r" % (what, done.returncode, done.stderr[-300:])
    said = plain(done.stderr)
    plain(done.stdout)
    assert not os.path.exists("PW"), "%r ran what is in a name" % what
    assert "out of range" not in said and "out of memory" not in said, said
    assert not told or (told in said and said.count("\n") == 1), "%r says %r" % (what, said)
    return None if lacks else done.stdout


def newer_commands(of, name, network, recording):
    """Other programs' simulations, scenes, HDF5, maps of presses and many jobs."""
    named = name.decode(errors="ignore").encode() == name
    run(0, b"explain", b"--max-effects", b"0", b"--sparse", b"--report", of(b".s.html"), b"--next", of(b".s.json"), b"--simulated", b"--",
        of(b".simulated.csv"), recording)
    for to, reads in (b"febio", xml.fromstring), (b"sofa", xml.fromstring), (b"newton", ast.parse), (b"vega", bytes.decode):
        run(0, b"export", b"--to", to, b"--depth-mm", b"2", b"--nodes", b"3", b"--out", of(b".scene." + to), b"--", of(b".json"))
        with open(of(b".scene." + to), "rb") as f:
            reads(f.read())
    run(1 if b"," in name else 0, b"export", b"--to", b"vega", b"--runs", recording, b"--nodes", b"3", b"--out", of(b".fitted"), b"--",
        of(b".json"))
    if run(0, b"export", b"--to", b"fmu", b"--out", of(b".fmu"), b"--", of(b".json")) is not None:
        with zipfile.ZipFile(of(b".fmu").decode(errors="surrogateescape")) as fmu:
            assert not fmu.testzip()
            xml.fromstring(fmu.read("modelDescription.xml"))
    if run(0, b"import", b"--out", of(b".h5"), b"--", recording) is not None:
        run(0, b"import", b"--out", of(b".back.csv"), b"--", of(b".h5"))
    run(0, b"simulate", b"--protocol", b"static", b"--depth-mm", b"1", b"--vtu", of(b".vtu"), b"--", network)
    run(1, b"inclusion", b"--", network, *[recording] * 8, told="palpate inclusion: ")
    run(0 if len(name) < LONGEST else 1, b"batch", b"--template", b"simulate {input} --protocol static --depth-mm 1 --json", b"--out",
        of(b".batch"), b"--", of(b".json"))
    words = ["characterize", "--arms", "1", "--json", "--", recording.decode(errors="replace")]
    with open("manifest.json", "w") as f:
        json.dump({"palpate": {"batch": 1}, "jobs": [{"name": "a", "arguments": words}]}, f)
    run(0 if named else 1, b"batch", b"--out", of(b".jobs"), b"--", b"manifest.json")
    os.makedirs(of(b".set") + b"/runs")
    shutil.copy(recording, of(b".set/runs/") + of(b".csv"))
    with open(of(b".set") + b"/benchmark.json", "w") as f:
        listed = ["runs/" + words[-1]]
        json.dump({"palpate": {"benchmark": 1}, "palpate_with": [{"name": "palpate", "arguments": []}], "programs": [],
                   "splits": [{"name": "s", "leaves_out": "nothing", "fit": listed, "predict": listed}]}, f)
    run(0 if named else 1, b"benchmark", b"--out", of(b".table.csv"), b"--", of(b".set"))


def every_command(number, name):
    def of(end):
        return name + end
    lumped, network, recording, raw = of(b".json"), of(b".network.json"), of(b".csv"), of(b".txt")
    shutil.copy(LUMPED, lumped)
    shutil.copy(NETWORK, network)
    shutil.copy(RUN, recording)
    with open(RUN, "rb") as f, open(raw, "wb") as to:
        to.writelines(line for line in f if not line.startswith(b"#"))
    run(0, b"characterize", b"--arms", b"1", b"--degree", b"2", b"--out", of(b".a.json"), b"--", recording)
    json.loads(run(0, b"characterize", b"--arms", b"1", b"--degree", b"2", b"--json", b"--", recording))
    run(0, b"explain", b"--model", of(b".a.json"), b"--max-effects", b"0", b"--report", of(b".html"), b"--result",
        of(b".b.json"), b"--out", of(b".c.json"), b"--", recording)
    run(0, b"simulate", b"--like", recording, b"--out", of(b".simulated.csv"), b"--", lumped)
    json.loads(run(0, b"simulate", b"--like", recording, b"--json", b"--", lumped))
    run(0, b"import", b"--specimen-height-mm", b"24", b"--specimen-name", name, b"--out", of(b".d"), b"--", raw)
    with open(of(b".xlsx"), "wb") as f:
        f.write(b"PK\003\004 a spreadsheet")
    run(0, b"import", b"--specimen-height-mm", b"24", b"--out", of(b".l"), b"--", of(b".xlsx"))
    run(0, b"report", b"--out", of(b".e.html"), b"--", recording, lumped, of(b".b.json"), of(b".simulated.csv"))
    with open(of(b".e.html"), "rb") as f:
        assert b"Simulation against recordings" in f.read(), "the simulation is not beside its recording"
    run(0, b"calibrate", b"--nodes", b"2", b"--stage", b"static", b"--out", of(b".f.json"), b"--", lumped)
    run(0, b"export", b"--strain", b"0.1", b"--out", of(b".g.inp"), b"--", network)
    named = name.decode(errors="ignore").encode() == name  # what JSON can name
    run(0 if named and b"," not in name else 1, b"reduce", b"--runs", recording, b"--hold-out", b"0", b"--modes", b"2", b"--samples",
        b"5", b"--out", of(b".h.json"), b"--", network)
    if number == ACQUIRED[0]:
        # Each session has other noise: chance may be suspected.
        run((0, 3), b"acquire", b"--port", b"rig:" + lumped, b"--firmware", b"host", b"--static", b"--depth-mm", b"0.5",
            b"--rate-mm-s", b"4", b"--until-explained", lumped, b"--every", b"8", b"--out", of(b".u"))
    if number in ACQUIRED:
        run(0, b"acquire", b"--port", b"rig:" + lumped, b"--firmware", b"host", b"--static", b"--depth-mm", b"0.5",
            b"--rate-mm-s", b"4", b"--specimen-name", name, b"--out", of(b".j"), b"--log", of(b".k.log"))
        with open(os.path.join(of(b".j"), b"static_0.5mm.csv"), "rb") as f:
            assert b"# specimen.name: " in f.read(), "the specimen has no name"
    run(0, b"rig", b"--firmware", b"host", b"--until-s", b"0.002", b"--model", lumped, b"--log", of(b".i.log"))
    newer_commands(of, name, network, recording)
    shown = "".join(chr(c) if 32 <= c < 127 else "?" for c in name[:4]) if name.isascii() else ""
    for command in (b"characterize", b"simulate", b"calibrate", b"export", b"report", b"import", b"reduce"):
        more = {b"simulate": (b"--protocol", b"static", b"--depth-mm", b"1"), b"calibrate": (b"--nodes", b"3"),
                b"export": (b"--strain", b"0.1"), b"import": (b"--out", b"no"), b"reduce": (b"--runs", b"no.csv")}
        run(1, command, *more.get(command, ()), b"--", of(b".none"), told="palpate %s: %s" % (command.decode(), shown))
    with open(recording, "wb") as to:
        to.write(b'# palpate.experiment: 1\ntime_s,depth_mm,force_N\n0,0,x\n')
    run(1, b"characterize", b"--", recording, told=":3: ")
    for folder, _, files in os.walk(b"."):
        for file in files:
            assert not file.endswith(b".tmp"), "%r was left behind" % file
            path = os.path.join(folder, file)
            if file != recording and not (folder.endswith((b".batch", b".jobs")) and os.path.getsize(path) == 0):
                check(path)


def fake_helper():
    """What reads spreadsheets, and takes the file's name as one argument that is no option."""
    with open(RUN) as f:
        table = "".join(line for line in f if not line.startswith("#")).replace(",", "\t")
    path = os.path.join(BIN, "xlsx2csv")
    with open(path, "w") as f:
        f.write("#!%s/sh\n[ $# -eq 4 ] && [ -f \"$4\" ] || exit 1\ncase $4 in -*) exit 1; esac\necho '%s'" % (BIN, table))
    os.chmod(path, 0o755)


def main():
    bad = 0
    os.mkdir(BIN)
    fake_helper()
    for program in ("sh", "touch"):
        os.symlink(shutil.which(program), os.path.join(BIN, program))
    for number, (kind, name) in list(enumerate(NAMES.items()))[1 % STEP::STEP]:
        os.mkdir("name%d" % number)
        os.chdir("name%d" % number)
        try:
            every_command(number, name)
        except (AssertionError, ValueError, OSError) as error:
            print("FAILED: %s (%r): %s" % (kind, name[:40], error))
            bad += 1
        os.chdir("..")
    return 1 if bad else 0


sys.exit(main())
