"""What is measured of the runs; each over a stated window."""

import math

import numpy as np
from numpy.typing import NDArray

from vssea_core.control.chosen_gains import chosen_gains
from vssea_core.control.linear_model import LinearModel, state_space
from vssea_core.paper.claim import Run
from vssea_core.paper.disturbance_rates import load_and_rates
from vssea_core.paper.scenarios import DISTURBED_S, SET_POINT, UNDISTURBED_S
from vssea_core.simulation.settling import recovery_time
from vssea_core.simulation.step_response import StepMetrics, step_metrics

Samples = NDArray[np.float64]

SETTLED_S = 4.0
"""From here on a second has passed since the disturbances began: errors are counted to `UNDISTURBED_S`."""


def settled(run: Run, values: Samples) -> Samples:
    """Return the samples of `values` from 4 to 10 s."""
    time = run["time"]
    kept: Samples = values[(time >= SETTLED_S - 1e-9) & (time < UNDISTURBED_S - 1e-9)]
    return kept


def rms(values: Samples) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def rms_error(run: Run) -> float:
    """Return the RMS of reference - link [rad] from 4 to 10 s."""
    return rms(settled(run, run["error"]))


def peak_error(run: Run) -> float:
    """Return the largest |reference - link| [rad] from 4 to 10 s."""
    return float(np.abs(settled(run, run["error"])).max())


def peak_torque(run: Run) -> float:
    """Return the largest motor torque [N m] of the whole run."""
    return float(np.abs(run["motor_torque"]).max())


def effect_of_disturbance(disturbed: Run, undisturbed: Run) -> float:
    """Return the RMS of what the disturbances change of the link's position [rad] from 4 to 10 s."""
    return rms(settled(disturbed, disturbed["link_position"] - undisturbed["link_position"]))


def difference(a: Run, b: Run) -> float:
    """Return the largest difference of two runs' link positions [rad] over their whole length."""
    return float(np.abs(a["link_position"] - b["link_position"]).max())


def step(run: Run, target: float = SET_POINT) -> StepMetrics:
    """Return the figures of the step response until the disturbances begin."""
    before = run["time"] < DISTURBED_S - 1e-9
    return step_metrics(run["time"][before], run["link_position"][before], 0.0, target)


def rise_time(run: Run, target: float = SET_POINT) -> float:
    """Return the time [s] from 10 to 90 % of the step, before the disturbances; nan if it is not reached."""
    rise = step(run, target).rise_time_s
    return math.nan if rise is None else rise


def settling_time(run: Run, target: float = SET_POINT) -> float:
    """Return the time [s] until the link stays within 2 % of the set point, before the disturbances; nan if it does not."""
    time_s = step(run, target).settling_time_s
    return math.nan if time_s is None else time_s


def onset_error(run: Run) -> float:
    """Return the largest |reference - link| [rad] from 3 to 10 s, the first moments of the disturbances included."""
    during = (run["time"] >= DISTURBED_S - 1e-9) & (run["time"] < UNDISTURBED_S - 1e-9)
    return float(np.abs(run["error"][during]).max())


def recovery(run: Run, band: float) -> float:
    """Return the seconds from 3 s until |error| <= `band` [rad] up to 10 s; nan if it is outside then."""
    before = run["time"] < UNDISTURBED_S - 1e-9
    time_s = recovery_time(run["time"][before], run["error"][before], DISTURBED_S, band)
    return math.nan if time_s is None else time_s


def chatter(run: Run) -> float:
    """Return the RMS change of the motor torque [N m] from one sample to the next, from 4 to 10 s."""
    return rms(np.diff(settled(run, run["motor_torque"])))


def compliance(run: Run) -> float:
    """Return how far a steady load of 1 N m on the link moves it [rad/(N m)] in the linear loop u = -K x of Eq. (5)."""
    tuning, k = run.scenario.tuning, run.scenario.stiffness_reference.stiffness
    model = tuning.model
    plant = LinearModel(model.link_inertia, model.link_damping, model.motor_inertia, model.motor_damping, k)
    a, b, c = state_space(plant)
    gains = chosen_gains(tuning, k, run.scenario.timing.sample_time_s)[7:11]
    load = np.array([0.0, 1.0 / model.link_inertia, 0.0, 0.0])
    return float(abs(c @ np.linalg.solve(a - np.outer(b, gains), load)))


LINK_ESTIMATES = ("link_disturbance_estimate", "link_disturbance_rate", "link_disturbance_acceleration")
MOTOR_ESTIMATES = ("motor_disturbance_estimate", "motor_disturbance_rate")


def estimate_error(run: Run, channel: str) -> float:
    """Return the RMS error of an estimate (d, d' or d'') as a share of the signal's own RMS, from 4 to 10 s."""
    side, channels = ("link", LINK_ESTIMATES) if channel in LINK_ESTIMATES else ("motor", MOTOR_ESTIMATES)
    true = load_and_rates(getattr(run.scenario.disturbances, side), run["time"])[channels.index(channel)]
    return rms(settled(run, run[channel] - true)) / rms(settled(run, true))
