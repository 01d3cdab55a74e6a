"""The live 1 kHz loop with and without a batch beside it, in turn: lateness, overruns; and what the batch gets done."""

import json
import time

import numpy as np

from benchmarks.batch import plants
from benchmarks.live_server import Server, running_server
from benchmarks.recorder import measured
from vssea_core.scenarios import NOMINAL

TURNS = 3
RUNS = 1_000_000


def begun(server: Server) -> str:
    """Return the id of a batch that is at work."""
    batch = str(json.loads(server.post("/api/batches", plants(NOMINAL, RUNS).model_dump(mode="json")))["id"])
    while server.get(f"/api/batches/{batch}")["progress"]["done"] == 0:
        time.sleep(0.2)
    return batch


def main() -> None:
    """Print each turn and the medians over them."""
    found: dict[bool, list[dict[str, float]]] = {False: [], True: []}
    with running_server(probed=True, VSSEA_SCENE="false") as server:
        time.sleep(5.0)  # what a start leaves to do
        for _ in range(TURNS):
            for beside in found:
                batch = begun(server) if beside else None
                late, overruns, _ = measured(server)
                rate = server.get(f"/api/batches/{batch}")["rate"] if batch else None
                if batch:
                    server.post(f"/api/batches/{batch}/cancel")
                found[beside].append(late)
                words = "   ".join(f"{label} {value:.0f}" for label, value in late.items())
                told = f", batch {rate:.0f} runs/s" if rate else ""
                print(
                    f"  {'batch' if beside else 'alone'}  lateness_us  {words}   overruns {overruns}{told}", flush=True
                )
    for beside, turns in found.items():
        medians = {label: float(np.median([turn[label] for turn in turns])) for label in turns[0]}
        words = "   ".join(f"{label} {value:.0f}" for label, value in medians.items())
        print(f"median of the turns, {'with' if beside else 'without'} a batch: {words}")
