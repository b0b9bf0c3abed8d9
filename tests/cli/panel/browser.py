"""browser.py: a headless Chromium, driven over a pipe by the Chrome DevTools protocol."""
import json
import os
import select
import shutil
import subprocess
import time

PATIENCE_S = 600


def found():
    return shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


class Browser:
    def __init__(self, url, profile):
        to_read, self.to = os.pipe()
        self.back, to_write = os.pipe()

        def place():  # where Chromium looks for the pipe
            a, b = os.dup(to_read), os.dup(to_write)
            os.dup2(a, 3)
            os.dup2(b, 4)

        self.process = subprocess.Popen(
            [found(), "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run", "--window-size=1300,1100",
             f"--user-data-dir={profile}", "--remote-debugging-pipe", "about:blank"],
            preexec_fn=place, close_fds=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_read)
        os.close(to_write)
        self.n, self.text, self.session = 0, b"", None
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        self.call("Page.enable")
        self.call("Page.navigate", url=url)

    def call(self, method, **parameters):
        self.n += 1
        message = {"id": self.n, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.to, json.dumps(message).encode() + b"\0")
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            while b"\0" in self.text:
                one, self.text = self.text.split(b"\0", 1)
                got = json.loads(one)
                if got.get("id") == self.n:
                    assert "error" not in got, f"{method}: {got['error']}"
                    return got["result"]
            if select.select([self.back], [], [], 1)[0]:
                some = os.read(self.back, 1 << 20)
                assert some, "the browser has ended"
                self.text += some
        raise AssertionError(f"the browser does not answer {method}")

    def run(self, script):
        """The value of an expression in the page."""
        got = self.call("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in got, got["exceptionDetails"]
        return got["result"].get("value")

    def until(self, script, what=None):
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            try:
                got = self.run(script)
            except AssertionError as e:  # between two pages
                if "context" not in str(e) and "is not defined" not in str(e) and "null" not in str(e):
                    raise
                got = None
            if got:
                return got
            time.sleep(0.05)
        raise AssertionError(f"never {what or script}: {self.run('document.body.innerText')}")

    def click(self, selector):
        self.until(f"!document.querySelector({json.dumps(selector)}).disabled", f"{selector} enabled")
        self.run(f"document.querySelector({json.dumps(selector)}).click()")

    def key(self, key):
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key, code=key)

    def close(self):
        self.process.kill()
        self.process.wait()
