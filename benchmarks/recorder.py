"""The 1 kHz loop with the recorder on and off, in turn: lateness, execution, overruns, and what the recorder costs."""

import json
import time

import numpy as np

from benchmarks.live_server import Server, running_server

TURNS = 3
DURATION_S = 30.0


def measured(server: Server) -> tuple[dict[str, float], int, dict[str, float]]:
    """Return lateness [us], overruns and the shares of a core [%] over DURATION_S."""
    server.post("/probe/start")
    before = server.processor_seconds()
    time.sleep(DURATION_S)
    report = json.loads(server.post("/probe/report"))
    after = server.processor_seconds()
    load = {name: 100.0 * (after[name] - before[name]) / DURATION_S for name in before if name in after}
    return report["lateness_us"], report["overruns"], load


def main() -> None:
    """Print each turn and the medians over them."""
    print(f"the 1 kHz loop, no page open, {TURNS} turns of {DURATION_S:.0f} s with the recorder off and on")
    found: dict[str, list[dict[str, float]]] = {"false": [], "true": []}
    for _ in range(TURNS):
        for recording in found:
            with running_server(probed=True, VSSEA_RECORDING=recording) as server:
                time.sleep(5.0)  # what a start leaves to do
                late, overruns, load = measured(server)
            found[recording].append(late)
            words = "   ".join(f"{label} {value:.0f}" for label, value in late.items())
            cost = f"recorder {load['vssea recorder']:.1f} % of a core" if "vssea recorder" in load else "no recorder"
            print(f"  {'on ' if recording == 'true' else 'off'} lateness_us  {words}   overruns {overruns}, {cost}")
    for recording, turns in found.items():
        medians = {label: float(np.median([turn[label] for turn in turns])) for label in turns[0]}
        words = "   ".join(f"{label} {value:.0f}" for label, value in medians.items())
        print(f"median of the turns, recorder {'on ' if recording == 'true' else 'off'}: {words}")
