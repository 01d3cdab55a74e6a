"""The setting that the expected numbers share: no fade-in, no limit but the peak torque, sine of 0.5 rad at 0.25 Hz."""

import numpy as np

from benchmarks.numbers.table import rms, settled
from vssea_core.actuator.parameters import Actuator, EquilibriumMotor, Sensors
from vssea_core.channels import CHANNELS
from vssea_core.control.tuning import Tuning
from vssea_core.scenario import Scenario
from vssea_core.scenarios import NOMINAL
from vssea_core.signals.documents import ConstantStiffness, SineReference
from vssea_core.signals.references import reference_row
from vssea_core.signals.stiffness import slew_row
from vssea_core.simulation.kernel import run
from vssea_core.simulation.state import equilibrium_state, inputs_of
from vssea_core.simulation.trajectory import Trajectory


def unlimited_motor(peak_torque: float = 74.0, **changes: float) -> EquilibriumMotor:
    """Return a motor without thermal and speed limit."""
    limits = {"peak_torque": peak_torque, "continuous_torque": peak_torque, "no_load_speed": 1e3, "stall_torque": 1e5}
    return EquilibriumMotor(**(limits | changes))  # type: ignore[arg-type]


def sine_scenario(tuning: Tuning, stiffness: float = 200.0, peak_torque: float = 74.0, **changes: object) -> Scenario:
    """Return the sine with link 3 + 3 sin(pi t) N m from 3 s, for 10 s."""
    fields: dict[str, object] = {
        "actuator": Actuator(motor=unlimited_motor(peak_torque)),
        "reference": SineReference(fade_in_s=0.0),
        "stiffness_reference": ConstantStiffness(stiffness=stiffness),
        "tuning": tuning,
        "disturbances": NOMINAL.disturbances,
        "sensors": Sensors(),
    }
    return Scenario(**(fields | changes))  # type: ignore[arg-type]


def run_with(scenario: Scenario, prepared: np.ndarray) -> Trajectory:
    """Return the trajectory of `scenario` in the product's kernel with other numbers in the place of its tuning's."""
    period = scenario.timing.sample_time_s
    count, inputs = round(scenario.duration_s / period), inputs_of(scenario)
    rows = np.empty((count, len(CHANNELS)))
    slew = slew_row(scenario.stiffness_reference, scenario.tuning, scenario.actuator.stiffness, period)
    done, _ = run(
        inputs.rig, prepared, prepared, reference_row(scenario.reference), slew, inputs.link_terms,
        inputs.motor_terms, inputs.stiffness_terms, True, 1.0, equilibrium_state(scenario), 0, count, rows,
    )  # fmt: skip
    return Trajectory(rows[:done], period)


def error_and_chatter(run: Trajectory, from_s: float = 4.0) -> tuple[float, float]:
    """Return RMS error [rad] and RMS sample-to-sample torque [N m] from `from_s` [s] on."""
    error, torque = (settled(run["time"], run[name], from_s) for name in ("error", "motor_torque"))
    return rms(error), rms(np.diff(torque))
