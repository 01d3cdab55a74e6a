"""Stiffness 50 -> 800 -> 50 N m/rad while tracking under load, with every term of a moving stiffness in the law and without."""

import time

import numpy as np

from benchmarks.rigs.activities import SINE
from benchmarks.rigs.agreement import recorded
from benchmarks.rigs.emulated import armed, emulated_rig
from benchmarks.rigs.operator import Operator

LOAD = 5.0  # N m on the link
REACHED_S = 4.0
STIFFNESSES = (50.0, 800.0, 50.0)


def peak(operator: Operator, server, terms: str) -> tuple[float, float]:  # type: ignore[no-untyped-def]
    """Return the largest error [rad] while the stiffness stands still and while it goes there and back."""
    operator.ask("tune", changes={"stiffness_loop.terms": terms})
    operator.ask("set_stiffness", changes={"stiffness": STIFFNESSES[0]})
    time.sleep(REACHED_S)
    begun_s = operator.snapshot["time_s"]
    time.sleep(2.0)
    for stiffness in STIFFNESSES[1:]:
        operator.ask("set_stiffness", changes={"stiffness": stiffness})
        time.sleep(REACHED_S)
    span = recorded(server, begun_s, operator.snapshot["time_s"])
    still = span["time"] < begun_s + 1.8
    print(f"    reached {span['stiffness'].min():.0f} to {span['stiffness'].max():.0f} N m/rad")
    error = np.abs(span["error"])
    return float(error[still].max()), float(error[~still].max())


def main() -> None:
    """Print the peaks."""
    with emulated_rig() as (server, emulator), Operator(server.port) as operator:
        emulator.control({"do": "load", "value": LOAD})
        armed(operator)
        operator.ask("set_reference", replace=SINE | {"amplitude": 0.15, "frequency_hz": 0.25})
        operator.ask("follow")
        for terms, words in (("all", "every term"), ("rate", "that of tau_s' only"), ("none", "none")):
            still, moving = peak(operator, server, terms)
            print(f"{words:22} peak error {1e3 * moving:.2f} mrad while k moves, {1e3 * still:.2f} mrad at rest of k")
