"""Predictions of the linear loop against nonlinear simulations at random points: verdicts and growth rates."""

import math
import time
from collections import Counter

import numpy as np
from rich.console import Console

from vssea_core.actuator.parameters import EquilibriumMotor, Timing
from vssea_core.analysis.certify import Certificate, certify
from vssea_core.analysis.operating_point import LinearPlant, OperatingPoint
from vssea_core.control.tuning import Observer, PositionObserver, Tuning, VelocityObserver

POINTS = 400
SEED = 20
DELAYS = "torque_delay_s" in EquilibriumMotor.model_fields
"""Whether the simulated drive has a transport delay; the compute delay of 0 or 1 sample is always tried."""


def random_point(
    observer: type[VelocityObserver] | type[PositionObserver], random: np.random.Generator
) -> OperatingPoint:
    """Return a random stiffness, bandwidth, mismatch of all five parameters, lag and delay."""

    def within(low: float, high: float) -> float:
        return math.exp(random.uniform(math.log(low), math.log(high)))

    chosen: Observer = observer(bandwidth=within(20.0, 300.0))
    tuning = Tuning(observer=chosen)
    plant = LinearPlant.of_model(tuning, torque_lag_s=float(random.choice([0.0, 1.6e-4])))
    plant = plant.scaled(
        link_inertia=within(0.4, 2.5),
        link_damping=within(0.3, 3.0),
        motor_inertia=within(0.6, 1.7),
        motor_damping=within(0.3, 3.0),
        spring_constant=within(0.5, 2.0),
    )
    if DELAYS:
        plant = plant.with_delay(float(random.uniform(0.0, 3e-3)))
    timing = Timing(compute_delay_samples=int(random.integers(2)))  # type: ignore[arg-type]
    return OperatingPoint(tuning, timing, within(20.0, 1000.0), plant)


def described(point: OperatingPoint, found: Certificate) -> str:
    """Return a line on one point."""
    model, plant, observer = point.tuning.model, point.plant, point.tuning.observer
    return (
        f"  {observer.kind} g {observer.bandwidth:.0f}, k {point.stiffness:.0f}, "
        f"J_l x{plant.link_inertia / model.link_inertia:.2f}, J_e x{plant.motor_inertia / model.motor_inertia:.2f}, "
        f"k x{plant.spring_constant / model.spring_constant:.2f}, delay {point.timing.compute_delay_samples} + "
        f"{plant.torque_delay_s * 1e3:.2f} ms: predicted {found.predicted_growth:.4g} 1/s, seen {found.seen_growth:.4g} 1/s; "
        f"{found.reason}"
    )


def main() -> None:
    """Certify random points for both observers and print how many verdicts agree, and every one that does not."""
    console = Console(width=180, highlight=False)
    random = np.random.default_rng(SEED)
    for observer in (VelocityObserver, PositionObserver):
        start = time.perf_counter()
        points = [random_point(observer, random) for _ in range(POINTS // 2)]
        found = [certify(point) for point in points]
        spent = time.perf_counter() - start
        agreed = sum(each.agreed for each in found)
        unstable = sum(not each.predicted_stable for each in found)
        errors = [
            abs(each.seen_growth - each.predicted_growth) / max(abs(each.predicted_growth), 1.0)
            for each in found
            if not each.predicted_stable and math.isfinite(each.seen_growth)
        ]
        console.print(
            f"{observer.__name__}: {agreed} of {len(found)} verdicts agree, {unstable} predicted unstable; growth of those "
            f"within {100 * float(np.median(errors)):.2g} % (median), {100 * max(errors):.2g} % (most); {spent:.1f} s"
        )
        for reason, count in Counter(each.reason.split(",")[0].split(" at ")[0] for each in found).most_common():
            console.print(f"  {count:4d}  {reason}")
        for point, each in zip(points, found, strict=True):
            if not each.agreed:
                console.print("disagreed:" + described(point, each))


if __name__ == "__main__":
    main()
