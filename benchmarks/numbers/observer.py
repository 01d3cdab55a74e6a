"""Section 3: the velocity observer, and what breaks the cancellation of g v."""

import numpy as np

from benchmarks.numbers.setting import run_with
from benchmarks.numbers.table import PRODUCT, Line, mrad, rms, settled
from tests.core.experiment import Experiment
from vssea_core.control.law import GAINS
from vssea_core.control.observer import Channel
from vssea_core.control.observer_design import velocity_exact, velocity_first_order_hold
from vssea_core.control.packing import OBSERVER, ROWS_AT
from vssea_core.control.prepared import prepare
from vssea_core.control.tuning import Tuning, VelocityObserver
from vssea_core.scenario import Scenario
from vssea_core.scenarios import NOMINAL, PAPER_FIG2
from vssea_core.signals.documents import ConstantDisturbance, ConstantStiffness, Disturbances, StepReference
from vssea_core.simulation.run import simulate
from vssea_core.simulation.state import MEMORY

T = 1e-3


def matrices_of(g: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return F, G, H of a' = F a + G f + H v."""
    gains = np.array([3.0 * g, 3.0 * g * g, g**3])
    f = np.column_stack([-gains, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    return f, gains, -f @ gains


def zero_order_hold(g: float) -> list[np.ndarray]:
    """Return A, h, b0, b1 of the observer with v and f held at their old values; in d the v terms leave h = -G."""
    a, _, b0, b1 = velocity_first_order_hold(g, T)
    return [a, -matrices_of(g)[1], b0 + b1, np.zeros(3)]


def euler(g: float) -> list[np.ndarray]:
    """Return A, h, b0, b1 of a+ = a + T (F a + G f + H v) with the new f and v."""
    f, gains, h = matrices_of(g)
    return [np.eye(3) + T * f, T * h - gains, np.zeros(3), T * gains]


def with_gains(tuning: Tuning, parts: list[np.ndarray]) -> np.ndarray:
    """Return the prepared numbers of `tuning` with other matrices in the velocity observers of link and motor."""
    prepared = prepare(tuning, T)
    numbers = np.concatenate([part.ravel() for part in parts])
    for channel in (0, 1):
        start = ROWS_AT + GAINS + channel * OBSERVER
        prepared[start : start + len(numbers)] = numbers
    return prepared


def discretisations() -> list[Line]:
    """paper_fig2 with its disturbances at k 200 and 1000, RMS error after 4 s."""
    lines = []
    for k, sound, broken in ((200.0, "9 mrad", "169 mrad"), (1000.0, "6 mrad", "333 mrad")):
        scenario = PAPER_FIG2.model_copy(update={"stiffness_reference": ConstantStiffness(stiffness=k)})
        for form in ("exact", "first_order_hold"):
            observer = VelocityObserver(bandwidth=200.0, discretisation=form)
            run = simulate(
                scenario.model_copy(update={"tuning": scenario.tuning.model_copy(update={"observer": observer})})
            )
            error = rms(settled(run["time"], run["error"]))
            lines.append(Line(f"paper_fig2, k {k:g}, {form}: RMS error", sound, mrad(error), PRODUCT))
        for words, parts in (("zero-order hold", zero_order_hold(200.0)), ("Euler, new values", euler(200.0))):
            run = run_with(scenario, with_gains(scenario.tuning, parts))
            error = rms(settled(run["time"], run["error"]))
            lines.append(
                Line(
                    f"paper_fig2, k {k:g}, {words}: RMS error",
                    broken,
                    mrad(error),
                    "product's kernel, variant matrices",
                )
            )
    return lines


def kicks() -> list[Line]:
    """A change of g with a held instead of the estimates, and a preloaded spring with estimates of zero."""
    experiment = Experiment(NOMINAL)
    experiment.advance(4000)
    largest, kept = 0.0, 0.0
    more = VelocityObserver(bandwidth=120.0)
    changed = NOMINAL.tuning.model_copy(update={"observer": more})
    jump = matrices_of(120.0)[1] - matrices_of(100.0)[1]
    for _ in range(40):
        experiment.advance(100)
        plain, bumpless, held = experiment.fork(), experiment.fork(), experiment.fork()
        for channel, omega in ((0, held.state[1]), (1, held.state[3])):
            first = MEMORY + channel * len(Channel._fields) + Channel._fields.index("d")
            held.state[first : first + 3] -= jump * omega
        demand = plain.advance(1)["motor_torque_demand"][0]
        kept = max(kept, abs(bumpless.advance(1, changed)["motor_torque_demand"][0] - demand))
        largest = max(largest, abs(held.advance(1, changed)["motor_torque_demand"][0] - demand))
    how = "nominal, largest over 4 to 8 s; its instant and bandwidths are not stated"
    scenario = Scenario(
        stiffness_reference=ConstantStiffness(stiffness=50.0),
        reference=StepReference(origin=0.0, target=0.0),
        disturbances=Disturbances(link=(ConstantDisturbance(torque=3.0),)),
    )
    start = Experiment(scenario)
    start.advance(1)
    calm = start.fork().advance(1)["motor_torque_demand"][0]
    for channel in (0, 1):
        first = MEMORY + channel * len(Channel._fields) + Channel._fields.index("d")
        start.state[first : first + 3] = 0.0
    # the estimate after one period is no longer zero, so the kick is found by a period without correction
    blind = with_gains(scenario.tuning, [np.zeros((3, 3)), np.zeros(3), np.zeros(3), np.zeros(3)])
    start.tuning = blind
    kick = start.advance(1)["motor_torque_demand"][0]
    return [
        Line(
            "g 100 to 120 with a held: kick",
            "1880 N m",
            f"{largest:.4g} N m",
            f"product's kernel with that shift; {how}",
        ),
        Line("g 100 to 120 with the estimates held: kick", "0", f"{kept:.1g} N m", f"{PRODUCT}; {how}"),
        Line(
            "k 50, 3 N m preload, p 20, estimates of zero: kick",
            "343 N m",
            f"{abs(kick - calm):.4g} N m",
            "product's kernel, estimates zeroed",
        ),
        Line("the same, started in equilibrium: torque - load", "0", f"{abs(calm - 3.0):.1g} N m", PRODUCT),
    ]


def biases() -> list[Line]:
    """Steady error of d^ under d = t^2 at 1 ms, g 100: none in the exact form."""
    lines = []
    for words, form in (("exact", velocity_exact), ("first-order hold", velocity_first_order_hold)):
        a, h, _, _ = form(100.0, T)
        estimate, v = np.zeros(3), 0.0
        for k in range(1, 2001):
            v_next = -((k * T) ** 3) / 3.0
            estimate = a @ estimate + h * (v_next - v)
            v = v_next
        lines.append(
            Line(
                f"{words}: error of d^ under d = t^2",
                "0" if words == "exact" else "-",
                f"{4.0 - estimate[0]:.1e}",
                PRODUCT,
            )
        )
    return lines


SECTIONS = (discretisations, kicks, biases)
