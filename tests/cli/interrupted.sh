#!/bin/sh
# interrupted.sh: signals, links, permissions, little memory and full disks: nothing half written, and the reason said.
. tests/cli/common
command -v python3 >/dev/null || { echo "there is no python3"; exit 77; }

L=$DATA/lumped_n1.json M=$DATA/network_27.json
"$PALPATE" simulate "$L" --protocol ramp_hold --depth-mm 4 --hold-s 5 --sample-Hz 50 --air-s 1 --noise-N 0.004 |
    grep -v '^# model.file' >run.csv
python3 - "$PALPATE" "$L" "$M" <<'END' || fail "signals"
import json, os, signal, subprocess, sys, time
palpate, lumped, network = sys.argv[1:]


def caught(pid):
    with open("/proc/%s/status" % pid) as f:
        mask = next(int(line.split()[1], 16) for line in f if line.startswith("SigCgt"))
    return mask >> signal.SIGINT - 1 & 1


# Stopped while a file is being written, a command leaves nothing of it; it ends as one that no handler caught.
def ends(number):
    process = subprocess.Popen([palpate, "simulate", network, "--nodes", "9", "--protocol", "static", "--depth-mm", "3",
                                "--dt-ms", "0.1", "--vtu", "frames"], stdout=subprocess.DEVNULL)
    temporary = []
    while not temporary and process.poll() is None:
        process.send_signal(signal.SIGSTOP)
        mark = ".%d." % process.pid
        temporary = [f for f in (os.listdir("frames") if os.path.isdir("frames") else []) if mark in f]
        if temporary:
            process.send_signal(number)
        process.send_signal(signal.SIGCONT)
        time.sleep(0.001)
    assert temporary, "no file was ever being written"
    assert process.wait() == -number, "exit code %d after signal %d" % (process.returncode, number)
    left = [f for f in os.listdir("frames") if f.endswith(".tmp")]
    assert not left, "signal %d leaves %s" % (number, left)


for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
    ends(number)

# The folder in which benchmark fits goes too.
os.makedirs("set/runs")
os.mkdir("temporary")
os.link("run.csv", "set/runs/run.csv")
with open("set/benchmark.json", "w") as f:
    json.dump({"palpate": {"benchmark": 1}, "palpate_with": [{"name": "palpate", "arguments": []}], "programs": [],
               "splits": [{"name": "all", "leaves_out": "none", "fit": ["runs/run.csv"], "predict": ["runs/run.csv"]}]}, f)
process = subprocess.Popen([palpate, "benchmark", "set"], env={**os.environ, "TMPDIR": os.path.abspath("temporary")}, start_new_session=True,
                           stdout=subprocess.DEVNULL)
while not any(os.listdir(os.path.join("temporary", f)) for f in os.listdir("temporary")):
    assert process.poll() is None, "benchmark made no folder"
os.killpg(process.pid, signal.SIGINT)
assert process.wait() == -signal.SIGINT, "exit code %d of a stopped benchmark" % process.returncode
assert not os.listdir("temporary"), "benchmark leaves %s" % os.listdir("temporary")

# acquire hands a signal on to the explain that it started, and ends.
process = subprocess.Popen([palpate, "acquire", "--port", "rig:" + lumped, "--firmware", "host", "--static", "--depth-mm", "0.5", "--rate-mm-s", "4",
                            "--until-explained", lumped, "--out", "until"], stderr=subprocess.DEVNULL)
child = []
while not child:
    assert process.poll() is None, "acquire has not waited for explain"
    with open("/proc/%d/task/%d/children" % (process.pid, process.pid)) as f:
        child = [p for p in f.read().split() if b"\0explain\0" in open("/proc/%s/cmdline" % p, "rb").read()]
while not caught(child[0]):
    time.sleep(0.001)
process.send_signal(signal.SIGTERM)
assert process.wait() in (1, 3), "exit code %d of acquire whose search was stopped" % process.returncode

# The first SIGINT ends the search of explain: the result is whole and says so.
with open("stopped.json", "w") as out, open("err", "w") as err:
    process = subprocess.Popen([palpate, "explain", "--model", lumped, "run.csv", "--json"], stdout=out, stderr=err)
    while process.poll() is None and not caught(process.pid):
        time.sleep(0.001)
    process.send_signal(signal.SIGINT)
    assert process.wait() == 3, "exit code %d of a stopped search" % process.returncode
with open("stopped.json") as f:
    result = json.load(f)
assert result["stopped"] is True and result["gap"]["noise_level_N"] > 0, "the result does not say that it was stopped"
assert "stopping" in open("err").read(), "the terminal does not say that it stops"

# That of characterize by the likelihood too, whose model is the best so far.
with open("early.json", "w") as out, open("err", "w") as err:
    process = subprocess.Popen([palpate, "characterize", "run.csv", "--json"], stdout=out, stderr=err)
    while process.poll() is None and not caught(process.pid):
        time.sleep(0.001)
    process.send_signal(signal.SIGINT)
    assert process.wait() == 3, "exit code %d of a stopped fit" % process.returncode
assert "characterize: stopping" in open("err").read(), "the terminal does not say that the fit stops"
early = json.load(open("early.json"))
assert early["converged"] is False and early["estimates"], "the result does not say that the fit was stopped"
END
expect 0 report stopped.json run.csv --out stopped.html
grep -q "The search was stopped early" stopped.html || fail "the page does not say that the search was stopped"

# A link to what is not there: its target is made; a loop of links is told.
mkdir there
ln -s there/made.csv dangling.csv
ln -s "$PWD/there/deck.inp" dangling.inp
ln -s dangling.inp again.inp
ln -s there/model.json dangling.json
ln -s nowhere/deck.inp lost.inp
ln -s loop.inp loop.inp
expect 0 simulate "$L" --protocol static --depth-mm 3 --out dangling.csv
expect 0 export "$M" --strain 0.1 --out again.inp
expect 0 characterize run.csv --arms 1 --degree 2 --out dangling.json
for file in dangling.csv dangling.inp again.inp dangling.json; do [ -h $file ] || fail "$file is no link any more"; done
for file in made.csv deck.inp model.json; do [ -s there/$file ] || fail "a link's target is not made: $file"; done
expect 1 export "$M" --strain 0.1 --out lost.inp
says "lost.inp: cannot write: No such file or directory"
expect 1 export "$M" --strain 0.1 --out loop.inp
says "loop.inp: cannot write: Too many levels of symbolic links"

# A file that is replaced keeps its permissions, whatever the umask is.
chmod 640 there/deck.inp
chmod 606 there/made.csv
umask 077
expect 0 export "$M" --strain 0.2 --out again.inp
expect 0 simulate "$L" --protocol static --depth-mm 2 --out there/made.csv
expect 0 simulate "$L" --protocol static --depth-mm 2 --out there/new.csv
umask 022
modes=$(stat -c %a there/deck.inp there/made.csv there/new.csv | tr '\n' ' ')
[ "$modes" = "640 606 600 " ] || fail "permissions of replaced files: $modes"

# Memory that is too little for OpenBLAS, which would wait for it without end, and memory for a single job.
if (ulimit -v 120000) 2>/dev/null && "$PALPATE" --version >/dev/null && ldconfig -p | grep -q libopenblas; then
    for threads in 1 4; do
        (OPENBLAS_NUM_THREADS=$threads && ulimit -v 120000 && exec timeout 60 "$PALPATE" --version) >out 2>err
        [ $? -eq 1 ] || fail "too little memory is no failure, or was waited for ($threads threads)"
        says "palpate: too little memory"
    done
    (OPENBLAS_NUM_THREADS=4 && ulimit -v 400000 &&
        exec timeout 300 "$PALPATE" explain --model "$L" run.csv --max-effects 0 --jobs 8) >out 2>err ||
        fail "explain in 400 MB: $(cat err)"
    grep -q "is used: there is no memory for more" err || fail "fewer jobs are not told"
fi

# A full disk: the name and the reason, and the file that was there stays.
full() { # PATH arguments...
    path=$1; shift
    expect 1 "$@"
    grep -qF "$path: cannot write: No space left on device" err || fail "palpate $*: $(cat err)"
}
if [ -w /dev/full ]; then
    full /dev/full report run.csv --out /dev/full
    full /dev/full simulate "$L" --protocol static --depth-mm 3 --out /dev/full
    full /dev/full explain --model "$L" run.csv --max-effects 0 --report /dev/full
    full /dev/full characterize run.csv --arms 1 --degree 2 --out /dev/full
fi
if [ "$(id -u)" -eq 0 ] && mkdir small && mount -t tmpfs -o size=8k tmpfs small 2>/dev/null; then
    echo before >small/page.html
    full small/page.html report run.csv --out small/page.html
    full small/run.csv simulate "$L" --protocol ramp_hold --depth-mm 3 --sample-Hz 50 --out small/run.csv
    full small/run.feb export "$M" --to febio --depth-mm 2 --out small/run.feb
    for out in "export $L --to fmu --out small/run.fmu" "import run.csv --out small/run.h5"; do
        "$PALPATE" $out 2>err && fail "palpate $out: a full disk is no failure"
        grep -qE "small/run.(fmu|h5): cannot write: No space left on device|built without" err || fail "palpate $out: $(cat err)"
    done
    left=$(ls small | tr '\n' ' ')$(cat small/page.html)
    umount small
    [ "$left" = "page.html before" ] || fail "on a full disk: $left"
fi
ls -a . there frames | grep -q 'tmp$' && fail "a temporary file was left behind"
done_testing
