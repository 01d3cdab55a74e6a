"""Time of one simulated run of 10 s at 1 kHz, beside scipy and python-control on the same loop in the same process."""

from collections.abc import Callable
from dataclasses import replace

import control
import numpy as np
from rich.console import Console
from rich.table import Table
from scipy.integrate import solve_ivp

from benchmarks.timing import timed
from tests.core.as_reference import reference_config
from tests.reference.closed_loop import simulate as reference_simulate
from tests.reference.plant import derivative
from vssea_core.analysis.sampled_loop import closed_loop_matrix
from vssea_core.channels import CHANNELS
from vssea_core.control.prepared import prepare
from vssea_core.control.tuning import SlidingMode
from vssea_core.scenario import Scenario
from vssea_core.scenarios import NOMINAL, REALISTIC
from vssea_core.signals.references import reference_row
from vssea_core.signals.stiffness import slew_row
from vssea_core.simulation.kernel import run
from vssea_core.simulation.run import simulate
from vssea_core.simulation.state import equilibrium_state, inputs_of

REPEATS = 60
SAMPLES = 10_000


def kernel_of(scenario: Scenario) -> Callable[[], object]:
    """Return the kernel's run of `scenario` with everything it needs prepared, rows allocated."""
    period, inputs = scenario.timing.sample_time_s, inputs_of(scenario)
    prepared, reference = prepare(scenario.tuning, period), reference_row(scenario.reference)
    slew = slew_row(scenario.stiffness_reference, scenario.tuning, scenario.actuator.stiffness, period)
    start, rows = equilibrium_state(scenario), np.empty((SAMPLES, len(CHANNELS)))
    terms = inputs.link_terms, inputs.motor_terms, inputs.stiffness_terms

    def work() -> object:
        state = start.copy()
        return run(inputs.rig, prepared, prepared, reference, slew, *terms, True, 1.0, state, 0, SAMPLES, rows)

    return work


def solved_by_scipy(method: str) -> Callable[[], object]:
    """Return 1 s of `nominal` by the reference: numpy controller, scipy.solve_ivp over each sample, torque held."""
    config = replace(reference_config(NOMINAL), duration_s=1.0)
    if method == "rk":
        config = replace(config, integrator="rk")
    return lambda: reference_simulate(config)


def plant_by_scipy() -> Callable[[], object]:
    """Return the plant alone over 1 s of `nominal`: solve_ivp over each sample, torques replayed from a run, no controller."""
    recorded = simulate(NOMINAL.model_copy(update={"duration_s": 1.0}))
    torques = list(zip(recorded["motor_torque"].tolist(), recorded["stiffness_motor_torque"].tolist(), strict=True))
    plant, start = reference_config(NOMINAL).plant, equilibrium_state(NOMINAL)[:7]
    calm = (lambda t: 0.0,) * 3

    def work() -> object:
        state = start
        for k, (torque, stiffness_torque) in enumerate(torques):
            span = (k * 1e-3, (k + 1) * 1e-3)
            state = solve_ivp(
                lambda t, x, u=torque, v=stiffness_torque: derivative(plant, t, x.tolist(), u, v, calm), span, state
            ).y[:, -1]
        return state

    return work


def linear_by_control() -> Callable[[], object]:
    """Return 10 s of the linear loop (closed_loop_matrix of `nominal`) by control.forced_response, discrete time."""
    matrix = closed_loop_matrix(NOMINAL.tuning, NOMINAL.timing, 0.0, 200.0)
    n = len(matrix)
    system = control.ss(matrix, np.eye(n)[:, 1:2], np.eye(n)[:1], 0.0, NOMINAL.timing.sample_time_s)
    times = np.arange(SAMPLES) * NOMINAL.timing.sample_time_s
    load = np.where(times >= 3.0, -1e-2, 0.0)
    return lambda: control.forced_response(system, times, load)


def main() -> None:
    """Print times of 10 s of simulated time, and how many times longer than the kernel's `nominal` each takes."""
    sliding = NOMINAL.model_copy(
        update={"name": "sliding mode", "tuning": NOMINAL.tuning.model_copy(update={"controller": SlidingMode()})}
    )
    scenarios = (NOMINAL, REALISTIC, sliding)
    rows: list[tuple[str, float, float, str]] = []
    for scenario in scenarios:
        best, median = timed(kernel_of(scenario), REPEATS)
        rows.append((f"kernel, {scenario.name}", best, median, f"best and median of {REPEATS}; rows allocated before"))
    for scenario in scenarios:
        best, median = timed(lambda each=scenario: simulate(each), REPEATS)
        rows.append((f"simulate(), {scenario.name}", best, median, f"best and median of {REPEATS}; with preparation"))
    best, median = timed(linear_by_control(), 5)
    how = (
        f"discrete state space of {len(closed_loop_matrix(NOMINAL.tuning, NOMINAL.timing, 0.0, 200.0))} states, 10,000 "
    )
    rows.append(("control.forced_response", best, median, how + "samples: linear, no limits, no moving stiffness"))
    how = "1 s x 10: numpy controller, nonlinear plant, torque held over each sample"
    for words, method in (
        ("reference, fixed-step RK4 in numpy", "rk"),
        ("reference, scipy solve_ivp DOP853", "dop853"),
    ):
        best, median = timed(solved_by_scipy(method), 3)
        rows.append((words, 10.0 * best, 10.0 * median, how))

    best, median = timed(plant_by_scipy(), 3)
    how = "1 s x 10: plant only, torques replayed, default tolerances (1e-3)"
    rows.append(("scipy solve_ivp RK45, plant alone", 10.0 * best, 10.0 * median, how))

    table = Table("10 s of simulated time", "best", "median", "ratio of medians", "how")
    for words, best, median, how in rows:
        table.add_row(words, f"{1e3 * best:.4g} ms", f"{1e3 * median:.4g} ms", f"{median / rows[0][2]:.3g}", how)
    console = Console(width=180)
    console.print(table)
    console.print(f"kernel, nominal: {1e9 * rows[0][1] / SAMPLES:.0f} ns a sample at best")
