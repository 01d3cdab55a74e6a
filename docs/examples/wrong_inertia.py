"""How wrong may the link's inertia be before LQR, pole placement or sliding mode fails?

`python docs/examples/wrong_inertia.py` runs a batch of the realistic scenario (encoders, dry friction, torque-loop lag, a sample of
delay), prints what each controller stands, and draws docs/images/wrong_inertia.png.
"""

import math
import sys
from itertools import takewhile
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from vssea_core.analysis.operating_point import LinearPlant, OperatingPoint
from vssea_core.analysis.robustness import robustness
from vssea_core.batch.document import Batch, Grid, Listed
from vssea_core.batch.part import run_part
from vssea_core.batch.plan import BatchPlan
from vssea_core.scenario import Scenario
from vssea_core.scenarios import REALISTIC

IMAGE = Path(__file__).parents[1] / "images" / "wrong_inertia.png"
CONTROLLERS: dict[str, dict[str, Any]] = {
    "pole placement": {"kind": "state_feedback", "design": "poles"},
    "LQR on the error state": {"kind": "state_feedback", "design": "lqr_chain"},
    "LQR on the plant": {"kind": "state_feedback", "design": "lqr_plant"},
    "sliding mode with a layer": {"kind": "sliding_mode", "switch": "layer"},
}
"""Each with its default gains: dominant poles near 20 rad/s, but for those that an LQR chooses."""
WORSE = 5.0
"""A run has failed if it ended early, or if its RMS error is so many times that with the true inertia."""
Numbers = NDArray[np.float64]


class Found(NamedTuple):
    """RMS errors (n,) [rad] at factors (n,) of the true inertia, and the least and largest factor that is stood.

    `at_one` is the RMS error with the true inertia, `linear` the range in which linear analysis has the loop stable.
    """

    factors: Numbers
    errors: Numbers
    at_one: float
    stood: tuple[float, float]
    linear: tuple[float, float]


def batch(steps: int, duration_s: float) -> Batch:
    """Return the batch: each controller with `steps` factors below 1 and as many above, from 1/4 to 4; the model stays."""
    factors = Grid(
        path="actuator.link.inertia", low=0.25, high=4.0, count=2 * steps + 1, spacing="log", factor=True
    )  # fmt: skip
    return Batch(
        name="wrong inertia",
        scenario=REALISTIC.model_copy(update={"duration_s": duration_s}),
        vary=(Listed(path="tuning.controller", values=tuple(CONTROLLERS.values())), factors),
    )


def found(asked: Batch) -> dict[str, Found]:
    """Run the batch here and return what was found, by controller."""
    plan = BatchPlan(asked)
    part = run_part(plan, 0, plan.count)
    if part is None:
        raise RuntimeError("the batch was ended before it was done")
    shape = len(CONTROLLERS), -1
    states, errors = np.reshape(part.rows["state"], shape), np.reshape(part.rows["rms_error"], shape)
    true = asked.scenario.actuator.link.inertia
    factors = np.reshape(part.rows["actuator.link.inertia"], shape) / true
    middle = factors.shape[1] // 2
    return {
        name: _judged(
            factors[i],
            np.where(states[i] == "done", errors[i], math.inf),
            _linear(plan.scenario(i * factors.shape[1] + middle)),
        )
        for i, name in enumerate(CONTROLLERS)
    }


def _judged(factors: Numbers, errors: Numbers, linear: tuple[float, float]) -> Found:
    """Return what is stood: on from the true inertia as far as no run has failed."""
    middle = len(factors) // 2
    held = errors <= WORSE * errors[middle]
    below = sum(1 for _ in takewhile(bool, held[middle::-1])) - 1
    above = sum(1 for _ in takewhile(bool, held[middle:])) - 1
    stood = float(factors[middle - below]), float(factors[middle + above])
    return Found(factors, errors, float(errors[middle]), stood, linear)


def _linear(scenario: Scenario) -> tuple[float, float]:
    """Return the factors of the link's inertia between which the linear sampled loop is stable, friction and limits left out."""
    plant, stiffness = LinearPlant.of_actuator(scenario.actuator), scenario.stiffness_reference.stiffness
    borders = robustness(OperatingPoint(scenario.tuning, scenario.timing, stiffness, plant)).link_inertia
    if borders is None:
        return 1.0, 1.0
    return borders.below or 0.0, borders.above or math.inf


def drawn(results: dict[str, Found]) -> Figure:
    """Return the figure: RMS error over the factor, one curve a controller, thick where it is stood."""
    figure = Figure(figsize=(8.0, 4.8), layout="constrained")
    axes = figure.add_subplot()
    for number, (name, each) in enumerate(results.items()):
        low, high = each.stood
        inside = (each.factors >= low) & (each.factors <= high)
        label = f"{name}: stands {low:.2f} to {high:.2f}"
        axes.plot(each.factors, 1e3 * each.errors, color=f"C{number}", linewidth=0.8, alpha=0.6)
        axes.plot(each.factors[inside], 1e3 * each.errors[inside], color=f"C{number}", linewidth=2.4, label=label)
    axes.set(xscale="log", yscale="log", xlabel="true link inertia / inertia of the model", ylabel="RMS error [mrad]")
    axes.set_xticks(ticks := [0.25, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 4.0], [f"{tick:g}" for tick in ticks])
    axes.minorticks_off()
    axes.grid(alpha=0.3)
    figure.legend(loc="outside lower center", ncols=2, fontsize="small")
    return figure


def words(results: dict[str, Found]) -> str:
    """Return a table in Markdown of what was found."""
    lines = [
        "| controller | RMS error with the true inertia | stands, simulated | stable, linear analysis |",
        "|---|---|---|---|",
    ]
    for name, each in results.items():
        stood, linear = (f"{low:.2f} to {high:.2f}" for low, high in (each.stood, each.linear))
        lines.append(f"| {name} | {1e3 * each.at_one:.1f} mrad | {stood} | {linear} |")
    return "\n".join(lines)


if __name__ == "__main__":
    results = found(batch(120, REALISTIC.duration_s))
    sys.stdout.write(f"{words(results)}\n")
    drawn(results).savefig(IMAGE, dpi=100)
