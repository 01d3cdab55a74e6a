"""The loop on an emulated CAN bus for a minute, page open: lateness, execution, late answers, missed cycles; 500 Hz and 1 kHz."""

import json
import time

from benchmarks.live_server import open_page
from benchmarks.rigs.activities import tracking
from benchmarks.rigs.emulated import armed, emulated_rig
from benchmarks.rigs.operator import Operator

DURATION_S = 60.0


def measure(rate_hz: int) -> None:
    """Print one minute's figures while the rig tracks a sine."""
    with emulated_rig(rate_hz, probed=True) as (server, _), Operator(server.port) as operator:
        armed(operator)
        tracking(operator)
        with open_page(server.port):
            time.sleep(5.0)  # what opening the page leaves to do
            before, processor = operator.snapshot["rig"]["bus"], server.processor_seconds()
            server.post("/probe/start")
            time.sleep(DURATION_S)
            report = json.loads(server.post("/probe/report"))
            after, spent = operator.snapshot["rig"]["bus"], server.processor_seconds()
        cycles = after["cycles"] - before["cycles"]
        late, missed = (after[name] - before[name] for name in ("late_answers", "missed_cycles"))
        print(
            f"{rate_hz} Hz, {cycles} cycles: answers late {late} ({100 * late / cycles:.2f} %), cycles missed {missed}"
        )
        for name in ("lateness_us", "execution_us"):
            print(f"  {name:13}" + "   ".join(f"{label} {value:.0f}" for label, value in report[name].items()))
        load = 100.0 * (spent["vssea control"] - processor["vssea control"]) / DURATION_S
        kind = "real-time" if report["real_time"] else "best effort"
        print(f"  {operator.snapshot['sentence']}; control process {load:.0f} % of a core; scheduling {kind}")


def main() -> None:
    """Print both rates."""
    for rate_hz in (500, 1000):
        measure(rate_hz)
