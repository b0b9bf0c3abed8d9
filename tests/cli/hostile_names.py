"""hostile_names.py PALPATE LUMPED NETWORK RUN: every command on files with names that are no names.

Of each command: the exit code, no file called PW, which the names' commands would make, stderr and stdout of plain
UTF-8 without control characters, and outputs that are JSON, experiments and pages.
"""
import html.parser
import json
import os
import shutil
import subprocess
import sys

PALPATE, LUMPED, NETWORK, RUN = (os.path.abspath(a) for a in sys.argv[1:])
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
        for line in plain(data).splitlines():
            if line.startswith("# "):
                json.loads(line.split(": ", 1)[1])


def run(wanted, *arguments, told=None):
    """Runs a command in this folder, where PATH has what a hostile name would call."""
    done = subprocess.run([PALPATE.encode(), *arguments], stdin=subprocess.DEVNULL, capture_output=True,
                          env={**os.environ, "PATH": BIN})
    what = b" ".join(arguments)
    assert done.returncode == wanted, "%r: exit code %d: %r" % (what, done.returncode, done.stderr[-300:])
    said = plain(done.stderr)
    plain(done.stdout)
    assert not os.path.exists("PW"), "%r ran what is in a name" % what
    assert "out of range" not in said and "out of memory" not in said, said
    assert not told or (told in said and said.count("\n") == 1), "%r says %r" % (what, said)
    return done.stdout


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
    if number in ACQUIRED:
        run(0, b"acquire", b"--port", b"rig:" + lumped, b"--firmware", b"host", b"--static", b"--depth-mm", b"0.5",
            b"--rate-mm-s", b"4", b"--specimen-name", name, b"--out", of(b".j"), b"--log", of(b".k.log"))
        with open(os.path.join(of(b".j"), b"static_0.5mm.csv"), "rb") as f:
            assert b"# specimen.name: " in f.read(), "the specimen has no name"
    run(0, b"rig", b"--firmware", b"host", b"--until-s", b"0.002", b"--model", lumped, b"--log", of(b".i.log"))
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
            if file != recording:
                check(os.path.join(folder, file))


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
    for number, (kind, name) in enumerate(NAMES.items()):
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
