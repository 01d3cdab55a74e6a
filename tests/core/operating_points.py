"""Operating points that several tests of the analysis share."""

from vssea_core.actuator.parameters import Timing
from vssea_core.analysis.operating_point import LinearPlant, OperatingPoint
from vssea_core.control.tuning import Observer, PositionObserver, Tuning, VelocityObserver

OBSERVERS: dict[str, Observer] = {"velocity": VelocityObserver(), "position": PositionObserver()}
GAIN_FIELDS = ("link_inertia", "link_damping", "motor_inertia", "motor_damping", "spring_constant")


def realistic(
    observer: Observer | None = None, delay: int = 1, stiffness: float = 200.0, lag_s: float = 1.6e-4, **factors: float
) -> OperatingPoint:
    """A tuning with lag and delay, on its own model times `factors`."""
    tuning = Tuning(observer=observer or PositionObserver())
    plant = LinearPlant.of_model(tuning, lag_s).scaled(**factors)
    return OperatingPoint(tuning, Timing(compute_delay_samples=1 if delay else 0), stiffness, plant)


def with_actuator_gain(point: OperatingPoint, gain: float) -> OperatingPoint:
    """The drive gives `gain` times its torque: the same as every inertia, damping and the spring divided by it."""
    plant = point.plant.scaled(**dict.fromkeys(GAIN_FIELDS, 1.0 / gain))
    return OperatingPoint(point.tuning, point.timing, point.stiffness, plant)
