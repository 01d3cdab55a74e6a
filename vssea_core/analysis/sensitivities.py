"""Closed-loop maps over frequency: what becomes of references, disturbances, noise, and of doubts about the plant."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vssea_core.analysis.assembly import (
    LIMITER,
    LINK,
    LINK_DISTURBANCE,
    LINK_LOAD,
    MOTOR_DISTURBANCE,
    MOTOR_LOAD,
    NOISE,
    PLANT_TORQUE,
    REFERENCE,
    TORQUE,
)  # fmt: skip
from vssea_core.analysis.frequency_response import frequency_grid, frequency_response
from vssea_core.analysis.loop import LoopModel

Complex = NDArray[np.complex128]
Numbers = NDArray[np.float64]
PER_DECADE = 60.0


@dataclass(frozen=True)
class Map:
    """One closed-loop map: its name, words and unit, and how it follows from the loop's frequency response."""

    name: str
    label: str
    unit: str
    of: Callable[[Complex, Numbers, LoopModel], Complex]


def _sensitivity(G: Complex, w: Numbers, loop: LoopModel) -> Complex:
    late = np.exp(-1j * w * loop.period_s * loop.compute_delay)
    return np.asarray(1.0 + late * G[:, TORQUE, PLANT_TORQUE])


def _of_load(output: int, load: int, sign: float = 1.0) -> Callable[[Complex, Numbers, LoopModel], Complex]:
    """Map of a sine load: its mean over each period acts; held from its value at the tick it would come half a period late."""

    def of(G: Complex, w: Numbers, loop: LoopModel) -> Complex:
        half = 0.5 * w * loop.period_s
        return np.asarray(sign * G[:, output, load] * np.exp(1j * half) * np.sinc(half / np.pi))

    return of


def _tracking(G: Complex, w: Numbers, loop: LoopModel) -> Complex:
    ahead = np.exp(1j * w * loop.period_s * loop.looks_ahead)
    derivatives = (1j * w[:, None]) ** np.arange(NOISE - REFERENCE) * ahead[:, None]
    return np.asarray(1.0 - np.sum(G[:, LINK, REFERENCE:NOISE] * derivatives, axis=1))


MAPS: tuple[Map, ...] = (
    Map("S", "sensitivity S at the plant's input", "", _sensitivity),
    Map("T", "complementary sensitivity T at the plant's input", "", lambda G, w, loop: 1.0 - _sensitivity(G, w, loop)),
    Map("S_limiter", "sensitivity at the limiter", "", lambda G, w, loop: 1.0 + G[:, TORQUE, LIMITER]),
    Map("reference_to_error", "reference to error", "rad/rad", _tracking),
    Map("link_disturbance_to_error", "link disturbance to error", "rad/(N·m)", _of_load(LINK, LINK_LOAD, -1.0)),
    Map("motor_disturbance_to_error", "motor disturbance to error", "rad/(N·m)", _of_load(LINK, MOTOR_LOAD, -1.0)),
    Map("link_noise_to_torque", "link encoder noise to torque", "N·m/rad", lambda G, w, loop: G[:, TORQUE, NOISE]),
    Map(
        "motor_noise_to_torque", "motor encoder noise to torque", "N·m/rad", lambda G, w, loop: G[:, TORQUE, NOISE + 1]
    ),
    Map("link_estimate", "link disturbance to its estimate", "", _of_load(LINK_DISTURBANCE, LINK_LOAD)),
    Map("motor_estimate", "motor disturbance to its estimate", "", _of_load(MOTOR_DISTURBANCE, MOTOR_LOAD)),
)
BY_NAME = {each.name: each for each in MAPS}


@dataclass(frozen=True)
class Peak:
    """The largest magnitude of a map, in its unit, and its frequency [rad/s]."""

    value: float
    frequency: float


@dataclass(frozen=True)
class Sensitivities:
    """Every map of MAPS, complex (n,), over `frequencies` (n,) [rad/s], and its peak; M_s, M_t are those of S and T."""

    frequencies: Numbers
    curves: dict[str, Complex]
    peaks: dict[str, Peak]
    note: str | None

    def document(self) -> dict[str, Any]:
        """Return plain lists: magnitudes and phases [rad] of every map."""
        return {
            "frequencies": self.frequencies.tolist(),
            "curves": {
                each.name: {
                    "label": each.label,
                    "unit": each.unit,
                    "magnitude": np.abs(self.curves[each.name]).tolist(),
                    "phase": np.unwrap(np.angle(self.curves[each.name])).tolist(),
                    "peak": self.peaks[each.name].value,
                    "peak_frequency": self.peaks[each.name].frequency,
                }
                for each in MAPS
            },
            "note": self.note,
        }


def sensitivities(loop: LoopModel) -> Sensitivities:
    """Return the Sensitivities of `loop` from 0.01 rad/s to Nyquist. Disturbances act by their mean over each period.

    Raises ValueError if the closed loop is unstable.
    """
    require_stable(loop)
    grid: Numbers = frequency_grid(loop.multipliers, loop.period_s, PER_DECADE)
    G = response(loop, grid)
    curves = {each.name: each.of(G, grid, loop) for each in MAPS}
    return Sensitivities(
        grid, curves, {name: _peak(loop, name, grid, curve) for name, curve in curves.items()}, loop.note
    )


def map_at(loop: LoopModel, name: str, frequencies: Numbers) -> Complex:
    """Return one map of MAPS, complex (n,), at `frequencies` (n,) [rad/s]."""
    w = np.atleast_1d(np.asarray(frequencies, dtype=float))
    return BY_NAME[name].of(response(loop, w), w, loop)


def response(loop: LoopModel, frequencies: Numbers) -> Complex:
    """Return the response of all outputs to all inputs, complex (n, outputs, inputs), at `frequencies` (n,) [rad/s]."""
    G: Complex = frequency_response(loop.A, loop.B, loop.C, loop.D, loop.period_s, frequencies)
    return G


def require_stable(loop: LoopModel) -> None:
    """Raise ValueError if the closed loop is unstable: its responses to lasting signals do not exist."""
    if not loop.stable:
        raise ValueError(
            f"the closed loop is unstable (it grows {loop.radius:.4g}-fold a sample), so it has no frequency response; "
            "expected a stable tuning: lower the poles or the observer bandwidth, or bring the model closer to the plant"
        )


def _peak(loop: LoopModel, name: str, grid: Numbers, curve: Complex) -> Peak:
    """Return the peak of `curve` over `grid`, its neighbourhood looked at twice more closely."""
    size = np.abs(curve)
    top = int(np.argmax(size))
    best = Peak(float(size[top]), float(grid[top]))
    for _ in range(2):
        if top in (0, len(grid) - 1):
            break
        grid = np.linspace(grid[top - 1], grid[top + 1], 41)
        size = np.abs(map_at(loop, name, grid))
        top = int(np.argmax(size))
        if size[top] > best.value:
            best = Peak(float(size[top]), float(grid[top]))
    return best


def first_below(loop: LoopModel, name: str, level: float) -> float:
    """Return the lowest frequency [rad/s] at which the magnitude of a map falls below `level`; NaN if it does not."""
    grid: Numbers = frequency_grid(loop.multipliers, loop.period_s, PER_DECADE)
    for _ in range(4):
        below = np.abs(map_at(loop, name, grid)) < level
        first = int(np.argmax(below))
        if not below[first] or first == 0:
            return math.nan
        low, high = grid[first - 1], grid[first]
        grid = np.linspace(low, high, 33)
    return float(high)
