"""Stiffness 50 -> 800 -> 50 N m/rad while tracking under load, with every term of a moving stiffness in the law and without."""

import time

import numpy as np

from benchmarks.live_server import Server
from benchmarks.rigs.activities import SINE
from benchmarks.rigs.agreement import recorded
from benchmarks.rigs.emulated import armed, emulated_rig
from benchmarks.rigs.operator import Operator

LOAD = 5.0  # N m on the link
REACHED_S = 4.0
SLOW_SINE = SINE | {"amplitude": 0.15, "frequency_hz": 0.25}
STIFFNESSES = (50.0, 800.0, 50.0)


def peaks(operator: Operator, server: Server, terms: str) -> str:
    """Return in words the largest error while the stiffness stands still and while it goes there and back."""
    operator.ask("tune", changes={"stiffness_loop.terms": terms})
    operator.ask("set_stiffness", changes={"stiffness": STIFFNESSES[0]})
    operator.ask("set_reference", replace=SLOW_SINE)
    operator.ask("follow")
    time.sleep(REACHED_S)
    begun_s = operator.snapshot["time_s"]
    time.sleep(2.0)
    for stiffness in STIFFNESSES[1:]:
        if operator.state == "running":
            operator.ask("set_stiffness", changes={"stiffness": stiffness})
            time.sleep(REACHED_S)
    stopped = "" if operator.state == "running" else f"; {operator.snapshot['sentence'].split(chr(46))[0]}"
    span = recorded(server, begun_s, operator.snapshot["time_s"])
    error, still = 1e3 * np.abs(span["error"]), span["time"] < begun_s + 1.8
    reached = f"{span['stiffness'].min():.0f} to {span['stiffness'].max():.0f} N m/rad"
    return (
        f"peak error {error[~still].max():.2f} mrad while k moves ({reached}), {error[still].max():.2f} before{stopped}"
    )


def main() -> None:
    """Print the peaks."""
    with emulated_rig() as (server, emulator), Operator(server.port) as operator:
        emulator.control({"do": "load", "value": LOAD})
        for terms, words in (("all", "every term"), ("rate", "that of tau_s' only"), ("none", "none")):
            armed(operator)
            print(f"{words:20} {peaks(operator, server, terms)}", flush=True)
