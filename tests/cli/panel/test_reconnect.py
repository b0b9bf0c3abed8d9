"""test_reconnect.py: the panel's cable is pulled and put in again. Nothing waits for a time: only for what is shown."""
import os
import signal
import sys

from panel_client import Panel

cable = int(os.environ["CABLE"])
p = Panel("--specimen-height-mm", "24", port=sys.argv[1])
ready = p.do("prepare")
assert ready["state"] == "ready" and ready["homed"], ready
for _ in range(2):
    os.kill(cable, signal.SIGUSR1)
    p.until("gone", lambda s: s["state"] == "gone")
    p.post("/jog?by_mm=1&rate_mm_s=1")  # is refused, not kept for later
    p.idle()
    assert "not connected" in p.notes[-1]["text"], p.notes
    os.kill(cable, signal.SIGUSR2)
    back = p.until("back", lambda s: s["state"] != "gone")
    back = p.until("shown", lambda s: s["homed"] and s["contact_mm"] is not None)
    assert back["state"] in ("ready", "idle") and abs(back["place_mm"] - ready["place_mm"]) < 0.05, (back, ready)
    assert abs(back["contact_mm"] - ready["contact_mm"]) < 1e-9, back
    assert any("connected again" in n["text"] for n in p.notes), p.notes
p.post("/jog?by_mm=-0.5&rate_mm_s=2")
at = p.idle()
assert abs(at["place_mm"] - ready["place_mm"] + 0.5) < 0.05, at
assert p.end() == 0
