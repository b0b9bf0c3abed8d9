"""test_browser.py: the page of palpate panel in a browser: a run, its stop, faults, loaded anew in the middle, the key Esc, a fit."""
import json
import os
import sys

from browser import Browser
from panel_client import Panel

STATE = "document.querySelector('#state').dataset.state"
NOTES = "document.querySelector('#notes').innerText"


def fill(b, **fields):
    for key, value in fields.items():
        b.run(f"(() => {{ const i = document.querySelector('#f_{key}'); i.value = {value!r}; i.dispatchEvent(new Event('input')); }})()")


def drawn(b, canvas):
    """Pixels of the curve's blue."""
    return b.run(f"""(() => {{ const c = document.querySelector('#{canvas}'), d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
        let n = 0; for (let i = 0; i < d.length; i += 4) n += d[i] < 40 && d[i + 1] > 60 && d[i + 1] < 140 && d[i + 2] > 130; return n; }})()""")


# What explain leaves behind: an effect, and the experiment that tells it from another.
os.makedirs("seen/fits")
NEXT = {"kind": "ramp_hold", "depth_mm": 4.25, "ramp_s": 0.5, "hold_s": 30}
with open("seen/fits/explain.json", "w") as f:
    json.dump({"verdict": "explained", "effects": [{"id": "sensor_lag"}], "next_experiment": {"runs": [NEXT], "time_s": 40}}, f)
with open("seen/fits/next.json", "w") as f:
    json.dump({"palpate": {"protocol": 1}, "about": "tells one from another", "runs": [NEXT]}, f)

p = Panel("--contact-mm", "2", "--limit-force-N", "2", out="seen")
b = Browser(p.url, os.path.abspath("profile"))
try:
    print("the form: its picture and what is wrong with it")
    b.until(f"{STATE} === 'idle'")
    b.until("planGood")
    assert drawn(b, "picture") > 100
    fill(b, depth_mm="-1")
    b.until("document.querySelector('#plan').className.includes('bad')")
    assert "depth_mm" in b.run("document.querySelector('#plan').textContent") and b.run("document.querySelector('#start').disabled")
    fill(b, depth_mm="2", ramp_s="0.5", hold_s="1000", air_s="0.2", after_s="0.1")
    b.until("planGood")

    print("a run, loaded anew in the middle")
    b.click("#start")
    b.until("now && now.run && now.run.elapsed_s > 1")
    b.run("window.old = true")
    b.call("Page.reload")
    b.until("!window.old && now && now.run && data.time_s.length > 50", "the page again")
    assert b.run("document.querySelector('#f_hold_s').value") == "1000", "the form is lost"
    b.until("Number(document.querySelector('#force').textContent) > 0.5 && Math.abs(Number(document.querySelector('#depth').textContent) - 2) < 0.05")
    assert drawn(b, "over_time") > 100 and drawn(b, "over_depth") > 50

    print("its stop")
    b.click("#stop")
    b.until(f"{STATE} === 'ready' && !now.busy")
    assert p.state()["state"] == "ready" and "stopped" in b.run(NOTES)
    b.until("document.querySelector('#runs').innerText.includes('ramp_hold_2mm')")

    print("a fault, and clearing it")
    fill(b, depth_mm="5", hold_s="1")
    b.until("planGood")
    b.click("#start")
    b.until(f"{STATE} === 'fault' && !now.busy")
    assert not b.run("document.querySelector('#fault').hidden") and "force" in b.run("document.querySelector('#fault').innerText")
    b.click("[data-do=clear]")
    b.until(f"{STATE} !== 'fault' && document.querySelector('#fault').hidden")

    print("the key Esc")
    fill(b, depth_mm="2", hold_s="1000")
    b.until("planGood")
    b.click("#start")
    b.until("now && now.run && now.run.elapsed_s > 1")
    b.key("Escape")
    b.until(f"{STATE} === 'fault' && now.fault === 'emergency_stop'")
    b.click("[data-do=clear]")
    b.until(f"{STATE} !== 'fault'")

    print("every kind of stimulus")
    for kind in b.run("Object.keys(kinds)"):
        b.run(f"(() => {{ const k = document.querySelector('#kind'); k.value = {kind!r}; k.dispatchEvent(new Event('change')); }})()")
        b.until("planGood || document.querySelector('#plan').className.includes('bad')")
        assert b.run("planGood"), f"{kind}: {b.run('document.querySelector(`#plan`).textContent')}"

    print("the deepest place of a force")
    b.run("(() => { const k = document.querySelector('#kind'); k.value = 'creep'; k.dispatchEvent(new Event('change')); })()")
    fill(b, deepest_mm="4")
    b.until("document.querySelector('#protocol').value.includes('\"deepest_mm\": 4') && planGood")
    fill(b, deepest_mm="")
    b.until("!document.querySelector('#protocol').value.includes('deepest_mm') && planGood")

    print("the next experiment of explain, by one click")
    b.until("document.querySelector('#found').innerText.includes('sensor_lag')")
    b.click("#found button")
    b.until("document.querySelector('#protocol').value.includes('4.25') && planGood")
    assert json.loads(b.run("document.querySelector('#protocol').value"))["runs"] == [NEXT]
    assert "ramp_hold_4.25mm" in b.run("document.querySelector('#plan').textContent")

    print("a fit of what was recorded")
    b.until("runs.length === 3")
    b.run("mark('ramp_hold_2mm.csv', true)")
    b.click("[data-job=fit]")
    b.until("runs.some(r => r.name === 'ramp_hold_2mm.csv' && r.fit) && document.querySelector('#runs').innerText.includes('K(0)')")
    b.click("[data-job=report]")
    b.until(f"{NOTES}.includes('The report is written')")
    assert p.ask("GET", "/made?name=report.html")[0] == 200

    print("a series: explain asks for an experiment, which is run, and explained with the others")
    with open("seen/fits/next.json", "w") as f:
        json.dump({"palpate": {"protocol": 1}, "runs": [{"kind": "ramp_hold", "depth_mm": 1, "ramp_s": 0.5, "hold_s": 0.2, "rest_s": 0}]}, f)
    # Calculations are not done: the first one finds two causes, the second one.
    b.run("""(() => { const real = ask, next = { runs: [{ kind: 'ramp_hold', depth_mm: 1 }], time_s: 5 };
        window.jobs = [];
        ask = async (method, path, body, signal) => {
          if (path.startsWith('/job')) { jobs.push([path, body]); return {}; }
          if (path === '/made?name=explain.json')
            return jobs.length < 2 ? { verdict: 'ambiguous', effects: [], next_experiment: next } : { verdict: 'explained', effects: [] };
          const got = await real(method, path, body, signal);
          if (path.startsWith('/live')) Object.assign(got.job, { done: got.job.done + jobs.length, good: true });
          return got;
        }; })()""")
    b.run("(() => { document.querySelector('#budget').value = '1'; })()")
    b.click("#until")
    b.until(f"{NOTES}.includes('The series has ended: explained')")
    assert b.run("jobs") == [["/job?what=explain&next_s=60", "ramp_hold_2mm.csv"], ["/job?what=explain&next_s=55", "ramp_hold_2mm.csv,ramp_hold_1mm.csv"]]
    assert os.path.exists("seen/ramp_hold_1mm.csv")
    print("it is stopped while the experiment is read: nothing moves")
    b.run("""(() => { const before = ask; jobs.length = 0; window.started = 0;
        ask = async (method, path, body, signal) => {
          started += path === '/start';
          const got = await before(method, path, body, signal);
          if (path === '/made?name=next.json') document.querySelector('#stop').onclick();
          return got;
        }; })()""")
    b.click("#until")
    b.until(f"{NOTES}.includes('was not recorded whole')")
    assert b.run("started") == 0 and b.run("document.querySelector('#until').innerText").startswith("Explain")
    b.run("jobs.length = 0")
    b.run("(() => { document.querySelector('#budget').value = '0.05'; })()")
    b.click("#until")
    b.until(f"{NOTES}.includes('no further experiment fits the time')")

    print("the panel ends: what it showed is dimmed, and nothing can be ordered")
    dimmed = "Number(getComputedStyle(document.querySelector('.readouts')).opacity) < 0.5"
    assert not b.run(dimmed) and b.run(f"{STATE} === 'ready'")
    assert p.end() == 0
    b.until(dimmed)
    assert b.run("document.querySelector('#state').innerText") == "not known" and not b.run("document.querySelector('#lost').hidden")
    assert b.run("[...document.querySelectorAll('[data-do], [data-jog], #stop, #start')].every(b => b.disabled)")
    b.click("#emergency")
    b.until(f"{NOTES}.includes('press the indenter')")
finally:
    b.close()
    sys.stdout.flush()
    p.process.kill()
