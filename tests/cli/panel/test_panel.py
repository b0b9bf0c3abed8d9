"""test_panel.py: palpate panel as a browser sees it, without one. Nothing waits for a time: only for what is shown."""
import http.client
import json
import os
import re
import socket
import sys
import threading
import time

from panel_client import Panel, protocol, ramp


def rows(name):
    """Header and rows of a recording that must be whole."""
    text = open(name).read()
    assert text.endswith("\n"), f"{name} ends within a row"
    header = dict(re.findall(r"^# ([a-zA-Z_.]+): (.*?) *$", text, re.M))
    data = [line.rstrip() for line in text.splitlines() if re.match(r"[-0-9]", line)]
    assert all(len(line.split(",")) == 3 for line in data), f"{name} has a broken row"
    assert header["end.fault"] == '"interrupted"' or int(header["end.samples"]) == len(data), f"{name}: {header}"
    return header, data


def who_may_ask(p):
    here = f"127.0.0.1:{p.port}"
    for method, path in (("GET", "/"), ("GET", "/live"), ("POST", "/stop"), ("POST", "/emergency"), ("POST", "/do?what=home")):
        for headers, token in (({}, False), ({"X-Palpate-Token": "0" * 32}, False), ({"X-Palpate-Token": p.token[:-1]}, False),
                               ({"Host": "evil.example"}, True), ({"Host": f"evil.example:{p.port}"}, True),
                               ({"Host": f"127.0.0.1:{p.port}0"}, True), ({"Origin": "http://evil.example"}, True),
                               ({"Origin": "null"}, True), ({"Origin": f"https://{here}"}, True),
                               ({"Host": "evil.example:9000", "Origin": "http://evil.example:9000"}, True),
                               ({"Host": "localhost.evil.example"}, True), ({"Host": "localhost:"}, True), ({"Host": "localhost:9000x"}, True),
                               ({"Host": f"127.0.0.1.evil.example:{p.port}"}, True), ({"Host": ""}, True),
                               ({"Host": "localhost:9000", "Origin": f"http://localhost:{p.port}"}, True),
                               ({"Origin": f"http://localhost:{p.port + 1}"}, True)):
            status, _, text = p.ask(method, path, "" if method == "POST" else None, headers, token)
            assert status == 403, f"{method} {path} with {headers}: {status}"
            assert p.token not in text
    assert p.state()["state"] == "idle", "a request that was refused did something"
    status, headers, text = p.ask("GET", f"/?token={p.token}", token=False)
    assert status == 200 and "<title>palpate panel</title>" in text and "frame-ancestors 'none'" in headers["Content-Security-Policy"]
    assert not re.search(r"(src|href)\s*=\s*[\"']?(https?:)?//", text), "the page fetches something"
    # by ssh -L the browser knows this machine by another port, and names it in Host and Origin alike
    for host in (here, f"localhost:{p.port}", "localhost:9000", "127.0.0.1:1", "localhost"):
        assert p.ask("GET", "/live", headers={"Host": host, "Origin": f"http://{host}"})[0] == 200
    assert p.ask("GET", "/nothing")[0] == 404
    assert p.ask("GET", "/stop")[0] == 404, "an order by GET"
    assert p.ask("POST", "/plan", "x" * (1 << 21))[0] == 413
    assert p.ask("DELETE", "/live")[0] == 405
    # of this machine alone: 127.0.0.2 is another address of it
    try:
        socket.create_connection(("127.0.0.2", p.port), timeout=60).close()
        raise AssertionError("listens beyond 127.0.0.1")
    except ConnectionRefusedError:
        pass


def bad_orders(p):
    for path, text in (("/do", "no such order"), ("/do?what=fly", "no such order"), ("/jog", "by_mm"), ("/jog?by_mm=1&rate_mm_s=99", "rate_mm_s"),
                       ("/jog?by_mm=nan&rate_mm_s=1", "by_mm")):
        assert text in p.post(path, wanted=400)["error"], path
    for body, text in (("", "malformed JSON"), ("{", "malformed JSON"), ("[]", "lacks"), (protocol(), "needs \"runs\""),
                       (protocol({"kind": "static"}), "needs depth_mm"), (protocol(ramp(40, 1)), "does not fit a specimen"),
                       (protocol(ramp(2, -1)), "hold_s must be a number from 0")):
        for path in ("/plan", "/start"):
            error = p.post(path, body, wanted=400)["error"]
            assert text in error and "\n" not in error, f"{path} {body}: {error}"
    assert os.listdir("runs") == [], "a protocol that was refused was kept"
    p.post("/jog?by_mm=1&rate_mm_s=1")
    p.idle()
    assert "not homed" in p.notes[-1]["text"], p.notes


def make_ready(p):
    """All of it is shown live: homing, taring and the search without a gap, with force and place."""
    first = p.live(0)["points"]
    assert first["next"] > 0 and len(first["force_N"]) > 0
    s = p.do("prepare")
    assert s["state"] == "ready" and s["homed"] and abs(s["contact_mm"] - 2) < 0.05, s
    shown = p.live(first["next"])["points"]
    times, step = shown["time_s"], (shown["next"] - first["next"]) // 4000 + 1
    assert times[-1] - times[0] > 3 and all(0 < b - a < 0.01 * step + 1e-6 for a, b in zip(times, times[1:])), (step, times[0], times[-1])
    assert min(shown["place_mm"]) < 0.1 and max(shown["place_mm"]) > 2 and max(shown["force_N"][-300:]) > 0.005
    p.post("/jog?by_mm=0.5&rate_mm_s=2")
    at = p.idle()["place_mm"]
    assert abs(at - s["place_mm"] - 0.5) < 0.05, (at, s)
    assert p.do("release")["state"] == "idle"
    p.post("/jog?by_mm=1&rate_mm_s=2")
    assert p.idle()["place_mm"] > s["contact_mm"]
    p.do("tare")
    assert "the plate is in the specimen" in p.notes[-1]["text"], p.notes
    p.post("/jog?by_mm=-1&rate_mm_s=2")
    p.idle()
    assert p.do("hold")["state"] == "ready"


def one_run(p):
    """Recorded whole, with its protocol beside it."""
    plan = p.post("/plan", protocol(ramp(2, 1)))
    assert [r["name"] for r in plan["runs"]] == ["ramp_hold_2mm"] and plan["runs"][0]["path"][-1][1] == -1
    p.post("/start", protocol(ramp(2, 1)))
    p.idle()
    header, data = rows("runs/ramp_hold_2mm.csv")
    assert header["end.fault"] == "null" and header["end.lost_samples"] == "0" and header["protocol.file"] == '"runs/protocol.json"', header
    times = [float(line.split(",")[0]) for line in data]
    assert all(abs(t - 0.001 * i) < 1e-9 for i, t in enumerate(times)), "what is shown is thinned, what is recorded is not"
    assert json.load(open("runs/protocol.json")) == protocol(ramp(2, 1))
    assert any("ramp_hold_2mm.csv: " in n["text"] and not n["bad"] for n in p.notes), p.notes
    assert sorted(os.listdir("runs")) == ["protocol.json", "ramp_hold_2mm.csv"]


def listed(p):
    """The folder's runs with their figures; a curve thinned; names lead nowhere else."""
    run, = p.get("/runs")["runs"]
    header, data = rows("runs/ramp_hold_2mm.csv")
    assert run["name"] == "ramp_hold_2mm.csv" and run["fault"] is None and run["fit"] is None, run
    assert run["samples"] == len(data) and run["peak_N"] == float(header["end.peak_N"]), run
    curve = p.get("/curve?run=ramp_hold_2mm.csv")
    assert len(curve["time_s"]) == len(curve["force_N"]) <= 4002 and abs(max(curve["force_N"]) - run["peak_N"]) < 1e-3
    for name in ("", "none.csv", "../runs/ramp_hold_2mm.csv", "%2e%2e%2fruns%2framp_hold_2mm.csv", "protocol.json", ".csv"):
        assert p.ask("GET", f"/curve?run={name}")[0] in (400, 404), name
    for name in ("explain.json", "../protocol.json", "..%2fprotocol.json"):
        assert p.ask("GET", f"/made?name={name}")[0] == 404, name
    for limit in ("0", "nan", "-1", "x"):
        assert "next_s" in p.post(f"/job?what=explain&next_s={limit}", "ramp_hold_2mm.csv", wanted=400)["error"], limit
    for runs in ("", "none.csv", "../runs/ramp_hold_2mm.csv"):
        assert "choose runs" in p.post("/job?what=fit", runs, wanted=409)["error"]


def reported(p):
    """The report shows what explain found, where that was of the chosen runs."""
    def job(what, runs):
        done = p.live()["job"]["done"]
        p.post(f"/job?what={what}", runs)
        while p.live()["job"]["done"] == done:
            time.sleep(0.02)
        assert p.live()["job"]["good"], p.notes
    job("explain&next_s=60", "ramp_hold_2mm.csv")
    result = json.load(open("runs/fits/explain.json"))
    said = json.dumps(result["next_sentence"])[1:-1]
    job("report", "ramp_hold_2mm.csv")
    assert said in p.ask("GET", "/made?name=report.html")[2]
    result["pressed"][0]["experiment"] = "runs/another.csv"
    json.dump(result, open("runs/fits/explain.json", "w"))
    job("report", "ramp_hold_2mm.csv")
    assert said not in p.ask("GET", "/made?name=report.html")[2]


def stopped(p):
    """Pages come and go, two see the same; another order is refused, not kept for later. Stop withdraws; the next run of that name
    stands beside it."""
    p.post("/start", protocol(ramp(2, 1000), ramp(3, 1000)))
    p.until("held", lambda s: s["recording"] and s["run"]["elapsed_s"] > 0.6)
    page = p.ask("GET", f"/?token={p.token}", token=False)[0]
    a, b = p.get("/live?point=1000000000&note=0"), p.get("/live?point=1000000000&note=0")
    assert page == 200 and a["state"]["run"]["name"] == b["state"]["run"]["name"] == "ramp_hold_2mm_2" and b["notes"] == a["notes"]
    for path in ("/do?what=home", "/jog?by_mm=1&rate_mm_s=1"):
        assert "busy" in p.post(path, wanted=409)["error"]
    assert "busy" in p.post("/start", protocol(ramp(2, 1)), wanted=409)["error"]
    p.post("/stop")
    s = p.idle()
    assert s["state"] == "ready" and s["place_mm"] < s["contact_mm"], s
    header, _ = rows("runs/ramp_hold_2mm_2.csv")
    assert header["end.fault"] == '"stopped"', header
    assert not os.path.exists("runs/ramp_hold_3mm.csv")
    p.post("/stop")  # nothing to stop: nothing happens
    assert p.state()["state"] == "ready"


def unknown_leave(p):
    """A connection that has not shown the token is closed long before one that has and idles likewise."""
    known = socket.create_connection(("127.0.0.1", p.port))
    request = f"GET /live HTTP/1.1\r\nHost: 127.0.0.1:{p.port}\r\nX-Palpate-Token: {p.token}\r\n\r\n".encode()
    for again in (False, True):
        known.sendall(request)
        answer = known.makefile("rb")
        assert b" 200 " in answer.readline()
        length = [int(line.split()[1]) for line in iter(answer.readline, b"\r\n") if line.lower().startswith(b"content-length")]
        answer.read(length[0])
        if not again:
            unknown = socket.create_connection(("127.0.0.1", p.port))
            assert unknown.recv(1) == b""
    known.close()


def crowd(p, busy):
    """64 connections that send a byte now and then, for ever, and never a token; they come again when they are closed."""
    held = []
    while not busy.is_set():
        while len(held) < 64:
            held.append(socket.create_connection(("127.0.0.1", p.port)))
        for c in list(held):
            try:
                c.sendall(b"G")
            except OSError:
                held.remove(c)
        busy.wait(0.5)
    for c in held:
        c.close()


def ask_again(p):
    """As the page does where a crowded server closes the connection before it has read the request."""
    for tries in range(20):
        try:
            return p.ask("POST", "/emergency", "", patience_s=60)
        except (http.client.RemoteDisconnected, ConnectionResetError, BrokenPipeError):
            if tries == 19:
                raise


def emergency(p):
    """At once, while other requests hang, unknown connections crowd the server and a run goes on; latched until it is cleared."""
    p.post("/start", protocol(ramp(2, 1000)))
    p.until("held", lambda s: s["recording"] and s["run"]["elapsed_s"] > 0.6)
    hanging, answers = [], []
    for _ in range(80):  # each says whether it was admitted, then hangs before its body
        c = socket.create_connection(("127.0.0.1", p.port))
        c.sendall(f"POST /start HTTP/1.1\r\nHost: 127.0.0.1:{p.port}\r\nX-Palpate-Token: {p.token}\r\nExpect: 100-continue\r\n"
                  "Content-Length: 1000\r\n\r\n".encode())
        answers.append(c.makefile("rb").readline().split()[1])
        hanging.append(c)
    assert sorted(set(answers)) == [b"100", b"503"], "the places of the emergency stop are given away"
    ended = threading.Event()
    others = threading.Thread(target=crowd, args=(p, ended))
    others.start()
    try:
        for _ in range(3):
            status, _, text = ask_again(p)
            assert status == 200 and json.loads(text)["stopped"], (status, text)
    finally:
        ended.set()
        others.join()
    for c in hanging:
        c.close()
    while p.ask("GET", "/live")[0] == 503:  # until the server has noticed
        pass
    s = p.until("a fault", lambda s: s["state"] == "fault" and not s["busy"])
    assert s["fault"] == "emergency_stop" and s["advice"], s
    header, _ = rows("runs/ramp_hold_2mm_3.csv")
    assert header["end.fault"] == '"emergency_stop"', header
    said = len(p.notes)
    p.post("/start", protocol(ramp(2, 1)))
    assert p.idle()["state"] == "fault" and len(p.notes) == said + 1 and "emergency_stop" in p.notes[-1]["text"], p.notes
    assert p.do("clear")["state"] in ("ready", "idle")


def faulted(p):
    """The limit of force: the page says what it was and what to do; then it goes on."""
    p.post("/start", protocol(ramp(5, 1)))
    s = p.until("a fault", lambda s: s["state"] == "fault" and not s["busy"])
    assert s["fault"] == "over_force" and "force" in s["fault_text"] and "deep" in s["advice"], s
    assert any("over_force" in n["text"] and n["bad"] for n in p.notes), p.notes
    header, _ = rows("runs/ramp_hold_5mm.csv")
    assert header["end.fault"] == '"over_force"', header
    p.do("clear")
    p.post("/start", protocol(ramp(1, 0.5)))
    p.idle()
    assert rows("runs/ramp_hold_1mm.csv")[0]["end.fault"] == "null"


def ended(p):
    """Ctrl-C in the middle of a run: the plate withdraws, the recording says so."""
    p.post("/start", protocol(ramp(1.5, 1000)))
    p.until("recording", lambda s: s["recording"] and s["run"]["elapsed_s"] > 0.6)
    code = p.end()
    header, _ = rows("runs/ramp_hold_1.5mm.csv")
    assert code == 0 and header["end.fault"] == '"stopped"', (code, header)


def killed():
    p = Panel("--contact-mm", "1.5", out="killed")
    p.post("/start", protocol(ramp(1, 1000)))
    p.until("recording", lambda s: s["recording"] and s["run"]["samples"] > 2000)
    p.process.kill()
    p.process.wait()
    header, data = rows("killed/ramp_hold_1mm.csv")
    assert header["end.fault"] == '"interrupted"' and len(data) > 100


p = Panel("--contact-mm", "2", "--limit-force-N", "2")
try:
    for part in (who_may_ask, bad_orders, make_ready, one_run, listed, reported, stopped, unknown_leave, emergency, faulted, ended):
        print(part.__name__)
        sys.stdout.flush()
        part(p)
finally:
    p.process.kill()
killed()
