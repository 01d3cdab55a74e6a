"""What a rig is doing when something breaks."""

import time

from benchmarks.rigs.operator import Operator

SETTLE_S = 1.0
SINE = {"kind": "sine", "amplitude": 0.3, "frequency_hz": 0.5, "offset": 0.0, "fade_in_s": 1.0}


def idle(_: Operator) -> None:
    """Hold still."""


def jogging(operator: Operator) -> None:
    """Move at 0.3 rad/s for as long as it is renewed."""
    operator.jogging = {"link": 0.3, "stiffness": 0.0}
    operator.wait_for("running")


def tracking(operator: Operator) -> None:
    """Follow a sine of 0.3 rad, 0.5 Hz."""
    operator.ask("set_reference", replace=SINE)
    operator.ask("follow")
    operator.wait_for("running")
    time.sleep(SETTLE_S)  # the fade-in of the sine


def changing_stiffness(operator: Operator) -> None:
    """Jog the stiffness while the sine is followed."""
    tracking(operator)
    operator.jogging = {"link": 0.0, "stiffness": 300.0}


ACTIVITIES = {"idle": idle, "jogging": jogging, "tracking": tracking, "changing stiffness": changing_stiffness}
