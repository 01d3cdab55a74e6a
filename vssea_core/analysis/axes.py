"""The parameters a map or a search may vary: what each changes, in the tuning, in the stiffness or in the true plant."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from vssea_core.analysis.operating_point import LinearPlant, OperatingPoint
from vssea_core.control.tuning import Controller, Observer, SlidingMode


@dataclass(frozen=True)
class Axis:
    """One parameter: name, words, unit, usual range and scale, and how a value changes an OperatingPoint.

    `side` tells what changes: "tuning", "stiffness" (the commanded one) or "plant"; factors multiply the plant as given.
    """

    name: str
    label: str
    unit: str
    low: float
    high: float
    scale: str
    side: str
    change: Callable[[OperatingPoint, float], OperatingPoint]


def _factor(field: str) -> Callable[[OperatingPoint, float], OperatingPoint]:
    return lambda point, value: replace(point, plant=point.plant.scaled(**{field: value}))


def _bandwidth(point: OperatingPoint, value: float) -> OperatingPoint:
    observer = _with(point.tuning.observer, "bandwidth", value)
    return replace(point, tuning=point.tuning.model_copy(update={"observer": observer}))


def _poles(point: OperatingPoint, value: float) -> OperatingPoint:
    controller = point.tuning.controller
    if not isinstance(controller, SlidingMode) and controller.design != "poles":
        raise ValueError(
            "the gains come from an LQR, so there are no poles to vary; choose another axis, or the design by poles"
        )
    field = "natural_frequency" if "natural_frequency" in type(controller).model_fields else "surface_pole"
    changed_controller = _with(controller, field, value)
    return replace(point, tuning=point.tuning.model_copy(update={"controller": changed_controller}))


def _with(part: Controller | Observer, field: str, value: float) -> Controller | Observer:
    if field not in type(part).model_fields:
        raise ValueError(f"{part.kind.replace('_', ' ')} has no {field.replace('_', ' ')} to vary; choose another axis")
    return part.model_copy(update={field: value})


def _delayed(plant: LinearPlant, delay_s: float) -> LinearPlant:
    return plant.with_delay(delay_s)


AXES: dict[str, Axis] = {
    axis.name: axis
    for axis in (
        Axis("spring", "true / nominal stiffness", "", 0.3, 3.0, "log", "plant", _factor("spring_constant")),
        Axis("link_inertia", "true / nominal link inertia", "", 0.3, 3.0, "log", "plant", _factor("link_inertia")),
        Axis("motor_inertia", "true / nominal motor inertia", "", 0.3, 3.0, "log", "plant", _factor("motor_inertia")),
        Axis("link_damping", "true / nominal link damping", "", 0.1, 10.0, "log", "plant", _factor("link_damping")),
        Axis("motor_damping", "true / nominal motor damping", "", 0.1, 10.0, "log", "plant", _factor("motor_damping")),
        Axis(
            "delay_s", "additional delay", "s", 0.0, 5e-3, "linear", "plant",
            lambda point, value: replace(point, plant=_delayed(point.plant, value)),
        ),
        Axis(
            "torque_lag_s", "torque-loop lag", "s", 0.0, 2e-3, "linear", "plant",
            lambda point, value: replace(point, plant=replace(point.plant, torque_lag_s=value)),
        ),
        Axis(
            "stiffness", "stiffness", "N·m/rad", 20.0, 1000.0, "log", "stiffness",
            lambda point, value: replace(point, stiffness=value),
        ),
        Axis("bandwidth", "observer bandwidth g", "rad/s", 10.0, 1000.0, "log", "tuning", _bandwidth),
        Axis("poles", "poles p", "rad/s", 2.0, 200.0, "log", "tuning", _poles),
    )
}  # fmt: skip


def axis_named(name: str) -> Axis:
    """Return the Axis called `name`. Raises ValueError naming the known ones."""
    if name not in AXES:
        raise ValueError(f"no axis {name!r}; expected one of {', '.join(AXES)}")
    return AXES[name]


def changed(point: OperatingPoint, values: dict[str, float]) -> OperatingPoint:
    """Return `point` with every named axis at its value. Raises ValueError for an unknown name."""
    for name, value in values.items():
        point = axis_named(name).change(point, value)
    return point
