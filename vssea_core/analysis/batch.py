"""Many loops at once: controllers by plants, assembled in one compiled pass, their eigenvalues by one call of LAPACK."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vssea_core.actuator.dynamics import Plant
from vssea_core.analysis.batch_kernel import margins_of_all, systems_of
from vssea_core.analysis.loop import STABLE_RADIUS, delay_in_samples
from vssea_core.analysis.margin_kernel import FIELDS
from vssea_core.analysis.operating_point import LinearPlant
from vssea_core.analysis.probe import LAW_COLUMNS, OBSERVED, OBSERVER_COLUMNS, PLANT_STATES, probe_controller

Numbers = NDArray[np.float64]
FAR = 1e30  # what stands for a number that is none: grows at once


@dataclass(frozen=True)
class Controllers:
    """Probed controllers, m of them: observers (m, 13, 18), laws (m, 19), their theta_ms (m,) [rad]."""

    observers: Numbers
    laws: Numbers
    theta_ms: Numbers

    @classmethod
    def probed(cls, prepared: Sequence[Numbers], theta_ms: Sequence[float], delayed: bool) -> "Controllers":
        """Return the controllers of `prepared` tunings, each at its `theta_ms` [rad], with or without a compute delay."""
        m = len(prepared)
        found = cls(
            np.zeros((m, OBSERVED, OBSERVER_COLUMNS)), np.zeros((m, LAW_COLUMNS)), np.array(theta_ms, dtype=float)
        )
        for i in range(m):
            probe_controller(prepared[i], found.theta_ms[i], delayed, found.observers[i], found.laws[i])
        return found


@dataclass(frozen=True)
class Plants:
    """Plants as the kernels take them, m of them: numbers (m, ...), lag shares before and after the torque changes, delays."""

    rows: Numbers
    first: Numbers
    second: Numbers
    whole: NDArray[np.int64]
    fraction: Numbers
    states: int

    @classmethod
    def of(cls, plants: Sequence[LinearPlant], period_s: float) -> "Plants":
        """Return `plants` at a sample time `period_s` [s]."""
        delays = [delay_in_samples(plant.torque_delay_s, period_s) for plant in plants]
        fractions = [fraction for _, fraction in delays]
        return cls(
            np.array([_row(plant) for plant in plants]),
            np.array([plant.lag(f * period_s) for plant, f in zip(plants, fractions, strict=True)]),
            np.array([plant.lag((1.0 - f) * period_s) for plant, f in zip(plants, fractions, strict=True)]),
            np.array([whole for whole, _ in delays], dtype=np.int64),
            np.array(fractions),
            PLANT_STATES if any(plant.torque_lag_s > 0.0 for plant in plants) else PLANT_STATES - 1,
        )


_BASE = np.array(LinearPlant(1.0, 0.0, 1.0, 0.0, 1.0).numbers())
_AT = {name: place for place, name in enumerate(Plant._fields)}


def _row(plant: LinearPlant) -> Numbers:
    row = _BASE.copy()
    row[_AT["per_link_inertia"]] = 1.0 / plant.link_inertia
    row[_AT["link_damping"]] = plant.link_damping
    row[_AT["per_motor_inertia"]] = 1.0 / plant.motor_inertia
    row[_AT["motor_damping"]] = plant.motor_damping
    row[_AT["spring_constant"]] = plant.spring_constant
    return row


@dataclass(frozen=True)
class Batch:
    """Loops of `controllers[i]` with `plants[j]` for the pairs (i, j) of `pairs` (n, 2)."""

    controllers: Controllers
    plants: Plants
    pairs: NDArray[np.int64]
    period_s: float
    compute_delay: bool

    def systems(self, inputs: int) -> tuple[Numbers, Numbers, Numbers, Numbers]:
        """Return A, B, C, D, stacked (n, ...); shorter ones are filled with zeros: idle states at z = 0."""
        c, p = self.controllers, self.plants
        A, B, C, D = systems_of(
            c.observers, c.laws, c.theta_ms, p.rows, p.first, p.second, p.whole, p.fraction, p.states, self.pairs,
            self.period_s, self.compute_delay, inputs,
        )  # fmt: skip
        lost = ~np.isfinite(A).all(axis=(1, 2))
        A[lost] = 0.0
        A[lost, 0, 0] = FAR
        return A, B, C, D

    def radii(self) -> Numbers:
        """Return the spectral radius (n,) of every loop."""
        return np.asarray(np.abs(np.linalg.eigvals(self.systems(0)[0])).max(axis=1))

    def margins(self, per_decade: float) -> tuple[Numbers, Numbers]:
        """Return spectral radii (n,) and margins (n, 2, margin_kernel.FIELDS), NaN where the loop is unstable."""
        A, B, C, D = self.systems(2)
        multipliers = np.linalg.eigvals(A).astype(np.complex128)
        radii = np.abs(multipliers).max(axis=1)
        found = np.full((len(A), 2, FIELDS), np.nan)
        stable = radii < STABLE_RADIUS
        margins_of_all(A, B, C, D, multipliers, stable, self.period_s, self.compute_delay, per_decade, found)
        return radii, found


def all_pairs(controllers: int, plants: int) -> NDArray[np.int64]:
    """Return every pair (controller, plant), the plant changing fastest: (controllers * plants, 2)."""
    return np.stack(np.meshgrid(np.arange(controllers), np.arange(plants), indexing="ij"), axis=-1).reshape(-1, 2)
