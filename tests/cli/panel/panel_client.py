"""panel_client.py: a client of palpate panel, for its tests: starts it, asks it, waits for what it shows."""
import http.client
import json
import os
import re
import signal
import subprocess
import time

PATIENCE_S = 600  # far beyond what a slow machine takes; only a hang ends there


class Panel:
    def __init__(self, *options, out="runs", port="rig"):
        self.errors = open("panel.err", "w+")
        command = [os.environ["PALPATE"], "panel", "--port", port, *(["--firmware", "host"] if port == "rig" else []), "--out", out, *options]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=self.errors, text=True)
        line = self.process.stdout.readline()
        found = re.fullmatch(r"http://127\.0\.0\.1:(\d+)/\?token=([0-9a-f]{32})\n", line)
        assert found, f"no address but {line!r}: {open('panel.err').read()}"
        self.url = line.strip()
        self.port, self.token = int(found[1]), found[2]
        self.notes = []
        self.note = 0

    def ask(self, method, path, body=None, headers=None, token=True, patience_s=PATIENCE_S):
        """Status, headers and text of one request on a connection of its own."""
        c = http.client.HTTPConnection("127.0.0.1", self.port, timeout=patience_s)
        given = dict({"X-Palpate-Token": self.token} if token else {}, **(headers or {}))
        c.request(method, path, body=body if body is None or isinstance(body, str) else json.dumps(body), headers=given)
        r = c.getresponse()
        text = r.read().decode()
        c.close()
        return r.status, r.headers, text

    def get(self, path):
        status, _, text = self.ask("GET", path)
        assert status == 200, f"GET {path}: {status} {text}"
        return json.loads(text)

    def post(self, path, body=None, wanted=200):
        status, _, text = self.ask("POST", path, body or "")
        assert status == wanted, f"POST {path}: {status} {text}"
        return json.loads(text)

    def live(self, point=1 << 40):
        got = self.get(f"/live?point={point}&note={self.note}")
        self.notes += got["notes"]["list"]
        self.note = got["notes"]["next"]
        return got

    def state(self):
        return self.live()["state"]

    def until(self, what, is_so):
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            state = self.state()
            if is_so(state):
                return state
            assert self.process.poll() is None, f"ended: {open('panel.err').read()}"
            time.sleep(0.02)
        raise AssertionError(f"never {what}: {state}; {self.notes}")

    def idle(self):
        return self.until("idle", lambda s: not s["busy"])

    def do(self, what):
        self.post(f"/do?what={what}")
        return self.idle()

    def end(self):
        """As Ctrl-C does; the exit code."""
        self.process.send_signal(signal.SIGINT)
        return self.process.wait(PATIENCE_S)


def protocol(*runs, **shared):
    return {"palpate": {"protocol": 1}, **shared, "runs": list(runs)}


def ramp(depth_mm, hold_s, **more):
    return {"kind": "ramp_hold", "depth_mm": depth_mm, "ramp_s": 0.2, "hold_s": hold_s, "air_s": 0.2, "after_s": 0.1,
            "rest_s": 0, **more}
