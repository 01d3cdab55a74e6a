"""From a click on STOP in Chromium to zero torque at the emulated motor, 50 times holding and tracking."""

import time

import numpy as np

from benchmarks.live_server import open_page
from benchmarks.rigs.activities import idle, tracking
from benchmarks.rigs.emulated import CENTRED, armed, emulated_rig
from benchmarks.rigs.operator import Operator

COUNT = 50
LOAD = 5.0  # N m on the link, so that holding takes torque too


def main() -> None:
    """Print the delays."""
    with (
        emulated_rig() as (server, emulator),
        open_page(server.port) as page,
        Operator(server.port) as operator,
    ):
        emulator.control({"do": "load", "value": LOAD})
        armed(operator)
        for name, activity in (("holding", idle), ("tracking", tracking)):
            delays = []
            for _ in range(COUNT):
                if operator.state not in ("armed", "running"):
                    operator.ask("reset")
                    operator.wait(lambda: not operator.snapshot["rig"]["cannot_arm"], "readiness to arm")
                    operator.ask("arm")
                    operator.wait_for("armed")
                operator.ask("go_to", position=0.0, speed=0.6)
                operator.wait(lambda: operator.snapshot["rig"]["motion"] in CENTRED, "centre")
                activity(operator)
                time.sleep(0.3)
                emulator.control({"do": "watch"})
                page.click("text=STOP")
                operator.wait_for("stopped")
                delays.append(emulator.control({"do": "peaks"})["safe_after_s"])
            found = 1e3 * np.array(delays)
            print(
                f"STOP click to zero torque, {name:9} p50 {np.median(found):6.1f} ms   worst {found.max():6.1f} ms   of {COUNT}"
            )
