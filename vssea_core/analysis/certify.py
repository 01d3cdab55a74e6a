"""A prediction of the linear loop against the nonlinear simulation: the growth seen, and whether the verdicts agree."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vssea_core.actuator.parameters import Actuator, EquilibriumMotor, Link, StiffnessMechanism
from vssea_core.analysis.loop import LoopModel, loop_model
from vssea_core.analysis.margins import finite
from vssea_core.analysis.operating_point import OperatingPoint
from vssea_core.scenario import Scenario
from vssea_core.signals.documents import ConstantDisturbance, ConstantStiffness, Disturbances, StepReference
from vssea_core.simulation.metrics import TORQUE_LIMITS
from vssea_core.simulation.run import simulate
from vssea_core.simulation.trajectory import Trajectory

PUSH_NM, PUSH_S = 1e-6, 0.01
"""The disturbance: so small that everything is linear for long, and far above rounding, since the loop rests at zero."""
E_FOLDS = 14.0
LONGEST_S, SHORTEST_S = 30.0, 1.0
SMALL_DEFLECTION = 0.02  # rad; below, the spring's stiffness is constant within 5e-5
MOST_WINDOWS, LEAST_WINDOWS = 60, 12
"""How many windows the linear part is cut into."""
SLOW = 4.0
"""e-folds below which a growth does not stand out against what happens at first."""
RATE_TOLERANCE, RATE_FLOOR = 0.03, 0.2
"""Share of the predicted growth, and 1/s, within which the growth seen agrees."""


@dataclass(frozen=True)
class Certificate:
    """Prediction and simulation of one point; rates in 1/s, NaN where the simulation shows none."""

    predicted_growth: float
    predicted_frequency: float  # of the dominant mode [rad/s]
    seen_growth: float
    predicted_stable: bool
    seen_stable: bool | None  # None: too slow to tell
    agreed: bool
    reason: str
    duration_s: float
    peak_error: float  # largest link error [rad]
    ending: str | None

    def document(self) -> dict[str, Any]:
        """Return plain values; None for what does not exist."""
        return {
            "predicted_growth": finite(self.predicted_growth),
            "predicted_frequency": self.predicted_frequency,
            "seen_growth": finite(self.seen_growth),
            "predicted_stable": self.predicted_stable,
            "seen_stable": self.seen_stable,
            "agreed": self.agreed,
            "reason": self.reason,
            "duration_s": self.duration_s,
            "peak_error": self.peak_error,
            "ending": self.ending,
        }


def certify(point: OperatingPoint, limits: bool = False) -> Certificate:
    """Return the Certificate of `point`: its plant simulated with the nonlinear spring, pushed by 1e-6 N m for 10 ms.

    With `limits` the default drive's limits are on and a growth may end in a limit cycle; without, the link runs away. The
    growth is taken from the part of the run that is still linear. Raises ValueError if the point has no linear loop.
    """
    loop = loop_model(point)
    largest = loop.multipliers[np.argmax(np.abs(loop.multipliers))]
    growth = math.log(abs(largest)) / point.period_s
    frequency = float(abs(np.angle(largest))) / point.period_s
    duration = min(LONGEST_S, max(SHORTEST_S, E_FOLDS / max(abs(growth), 1e-9)))
    trajectory = simulate(scenario_of(point, duration, limits))
    seen = _growth(trajectory, frequency)
    ran = len(trajectory) * point.period_s
    seen_stable, agreed, reason = _verdict(loop, growth, seen, trajectory, ran)
    return Certificate(
        growth, frequency, seen, loop.stable, seen_stable, agreed, reason, ran,
        float(np.abs(trajectory["error"]).max()), trajectory.ending,
    )  # fmt: skip


def scenario_of(point: OperatingPoint, duration_s: float, limits: bool = False) -> Scenario:
    """Return the Scenario that simulates `point` from rest, pushed a little at the link."""
    plant = point.plant
    changes: dict[str, float] = {
        "inertia": plant.motor_inertia,
        "damping": plant.motor_damping,
        "torque_lag_s": plant.torque_lag_s,
    }
    if plant.torque_delay_s > 0.0:
        changes["torque_delay_s"] = plant.torque_delay_s
    if not limits:
        changes |= {"peak_torque": 1e4, "continuous_torque": 1e4, "no_load_speed": 1000.0, "stall_torque": 1e5}
    motor = EquilibriumMotor.model_validate(changes)
    true = point.stiffness * plant.spring_constant / point.tuning.model.spring_constant
    mechanism = StiffnessMechanism(  # end stops far from both the commanded and the true stiffness
        spring_constant=plant.spring_constant,
        softest=max(1.0, min(point.stiffness, true) / 4.0),
        stiffest=min(1e5, max(point.stiffness, true) * 4.0),
    )
    link = Link(inertia=plant.link_inertia, damping=plant.link_damping)
    return Scenario(
        name="certificate",
        actuator=Actuator(link=link, motor=motor, stiffness=mechanism),
        timing=point.timing,
        tuning=point.tuning,
        reference=StepReference(origin=0.0, target=0.0, repeat=False),
        stiffness_reference=ConstantStiffness(stiffness=point.stiffness),
        disturbances=Disturbances(link=(ConstantDisturbance(torque=PUSH_NM, start_s=0.001, end_s=0.001 + PUSH_S),)),
        duration_s=duration_s,
    )


def _linear_part(trajectory: Trajectory) -> NDArray[np.float64]:
    """Return the link's position as long as the deflection is small and no torque is limited."""
    limited = (trajectory["limits"].astype(np.int64) & TORQUE_LIMITS) != 0
    left = limited | (np.abs(trajectory["deflection"]) > SMALL_DEFLECTION)
    count = int(np.argmax(left)) if left.any() else len(left)
    return trajectory["link_position"][:count]


def _growth(trajectory: Trajectory, frequency: float) -> float:
    """Return the growth rate [1/s] of the last half of the linear part, from its size over whole periods; NaN if too short."""
    y = _linear_part(trajectory)
    period = trajectory.period_s
    whole = 2.0 * math.pi / max(frequency * period, 1e-9)
    window = round(
        min(max(whole, len(y) / MOST_WINDOWS), len(y) / LEAST_WINDOWS)
    )  # few periods: the decay is fast, not the turn
    if window < 4:
        return math.nan
    count = len(y) // window
    sizes = np.sqrt(np.mean(y[len(y) - count * window :].reshape(count, window) ** 2, axis=1))
    late = sizes[count // 2 :]
    if np.any(late <= 0.0):
        return math.nan
    times = np.arange(len(late)) * window * period
    return float(np.polyfit(times, np.log(late), 1)[0])


def _verdict(
    loop: LoopModel, growth: float, seen: float, trajectory: Trajectory, ran_s: float
) -> tuple[bool | None, bool, str]:
    """Return whether the run was stable, whether that agrees, and in words why."""
    if math.isnan(seen):
        if trajectory.ending is not None or not loop.stable:
            return False, not loop.stable, "left the linear range within a few periods"
        return None, False, "too short to see a growth"
    close = abs(seen - growth) <= RATE_TOLERANCE * abs(growth) + RATE_FLOOR
    if abs(growth) * ran_s < SLOW:
        return (
            None,
            close,
            f"only {abs(growth) * ran_s:.1f} e-folds within {ran_s:.3g} s: too slow for a verdict of its own",
        )
    stable = seen < 0.0
    if stable != loop.stable:
        words = "decays" if stable else "grows"
        return stable, False, f"the simulation {words} at {seen:.3g} 1/s, {growth:.3g} 1/s was predicted"
    if loop.stable:
        return True, True, "decays as predicted"
    if not close:
        return False, True, f"grows, but at {seen:.3g} 1/s instead of {growth:.3g} 1/s"
    if trajectory.ending is None and bool(
        (trajectory["limits"].astype(np.int64) & TORQUE_LIMITS)[-len(trajectory) // 10 :].any()
    ):
        return False, True, "grows as predicted into a limit cycle: the torque limit holds it"
    return False, True, "grows as predicted"
