"""Test vectors: what the compiled tick is given and what it answers, over an exercise that uses all of it."""

import csv
import io
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vssea_core import __version__
from vssea_core.actuator.drive import CONTINUOUS, PEAK, SPEED
from vssea_core.channels import CHANNELS, INDEX
from vssea_core.export.c_source import braced
from vssea_core.export.tables import tables_of
from vssea_core.export.ticks import (
    INPUT_UNITS,
    INPUTS,
    OUTPUT_UNITS,
    OUTPUTS,
    STIFFNESS_AT,
    TORQUES_AT,
    answered,
    given,
)  # fmt: skip
from vssea_core.scenario import Scenario
from vssea_core.signals.documents import (
    ConstantDisturbance,
    Disturbances,
    MoveReference,
    MoveStiffness,
    SineDisturbance,
)
from vssea_core.signals.references import reference_row
from vssea_core.signals.stiffness import slew_row
from vssea_core.simulation.kernel import RUNNING, run
from vssea_core.simulation.state import APPLIED, PENDING, PLANT, SLEWED, equilibrium_state, inputs_of

Numbers = NDArray[np.float64]
TICKS = 300
SATURATED_SHARE = 0.8
"""Share of the largest torque asked for to which the exercise limits the motor, so that the limit certainly acts."""


@dataclass(frozen=True)
class Vectors:
    """Inputs (n, INPUTS) and expected outputs (n, OUTPUTS) of a controller from its first tick on."""

    inputs: Numbers
    outputs: Numbers


def exercise(scenario: Scenario) -> Scenario:
    """Return the scenario with a course that moves link and stiffness under load, and a motor too weak for all of it.

    Raises ValueError if a design has no solution.
    """
    moving = _moving(scenario)
    _, _, rows = _recorded(moving)
    motor, demand = moving.actuator.motor, np.abs(rows[:, INDEX["motor_torque_demand"]])
    holding = 1.2 * _load(scenario)
    peak = min(motor.peak_torque, max(holding, SATURATED_SHARE * float(np.max(demand))))
    weak = {"peak_torque": peak, "continuous_torque": min(peak, motor.continuous_torque)}
    actuator = moving.actuator.model_copy(update={"motor": motor.model_copy(update=weak)})
    return moving.model_copy(update={"actuator": actuator})


def _load(scenario: Scenario) -> float:
    """Return a torque [N m] on the link that spring and motor hold with ease."""
    actuator = scenario.actuator
    return min(0.5, 0.05 * scenario.stiffness_reference.stiffness, 0.1 * actuator.motor.peak_torque)


def _moving(scenario: Scenario) -> Scenario:
    """Return the scenario with a move of the link and one of the stiffness, and loads on link and motor."""
    t, origin, load = scenario.timing.sample_time_s, scenario.initial.link_position, _load(scenario)
    before, mechanism = scenario.stiffness_reference.stiffness, scenario.actuator.stiffness
    after = 0.5 * before if 0.5 * before >= mechanism.softest else min(2.0 * before, mechanism.stiffest)
    return Scenario(
        name=scenario.name,
        actuator=scenario.actuator,
        sensors=scenario.sensors,
        timing=scenario.timing,
        tuning=scenario.tuning,
        initial=scenario.initial,
        seed=scenario.seed,
        reference=MoveReference(
            origin=origin,
            target=origin - 0.2 if origin > 0.0 else origin + 0.2,
            start_s=20.0 * t,
            duration_s=max(0.25, 200.0 * t),
            repeat=False,
        ),
        stiffness_reference=MoveStiffness(
            stiffness=before, target=after, start_s=60.0 * t, duration_s=max(0.1, 100.0 * t)
        ),
        disturbances=Disturbances(
            link=(ConstantDisturbance(torque=load), ConstantDisturbance(torque=load, start_s=100.0 * t)),
            motor=(SineDisturbance(amplitude=3.0, frequency_hz=5.0, start_s=40.0 * t),),
        ),
        duration_s=TICKS * t,
    )


def vectors_of(scenario: Scenario) -> Vectors:
    """Return the vectors of the scenario's tuning: first tick under load, both moves, and a motor torque that is limited.

    Fewer than TICKS if the exercise runs away. Raises ValueError if a design has no solution.
    """
    asked, tables = exercise(scenario), tables_of(scenario)
    inputs, states, _ = _recorded(asked)
    given(inputs_of(asked).rig, reference_row(asked.reference), states, inputs)
    outputs = np.empty((len(inputs), OUTPUTS))
    answered(tables.prepared, tables.predicts, inputs, outputs)
    return Vectors(inputs, outputs)


def _recorded(scenario: Scenario) -> tuple[Numbers, Numbers, Numbers]:
    """Return torques and stiffness reference in rows of inputs, the plant's states, and the recorded rows of a run."""
    period, terms = scenario.timing.sample_time_s, inputs_of(scenario)
    prepared, reference = tables_of(scenario).prepared, reference_row(scenario.reference)
    slew = slew_row(scenario.stiffness_reference, scenario.tuning, scenario.actuator.stiffness, period)
    loads = terms.link_terms, terms.motor_terms, terms.stiffness_terms
    state, limited = equilibrium_state(scenario), False
    inputs, states, rows = np.zeros((TICKS, INPUTS)), np.empty((TICKS, PLANT)), np.empty((TICKS, len(CHANNELS)))
    for i in range(TICKS):
        states[i] = state[:PLANT]
        inputs[i, TORQUES_AT : TORQUES_AT + 2] = state[APPLIED : APPLIED + 2]
        inputs[i, TORQUES_AT + 2], inputs[i, TORQUES_AT + 3] = state[PENDING], limited
        inputs[i, STIFFNESS_AT : STIFFNESS_AT + 3] = state[SLEWED + 1 : SLEWED + 4]
        _, end = run(terms.rig, prepared, prepared, reference, slew, *loads, True, 1.0, state, i, 1, rows[i : i + 1])
        inputs[i, STIFFNESS_AT + 3 : STIFFNESS_AT + 6] = state[SLEWED + 1 : SLEWED + 4]
        if end != RUNNING:
            return inputs[: i + 1], states[: i + 1], rows[: i + 1]
        limited = bool(int(rows[i, INDEX["limits"]]) & (PEAK | CONTINUOUS | SPEED))
    return inputs, states, rows


def as_csv(vectors: Vectors) -> str:
    """Return the vectors as CSV: a heading with units, a row a tick, inputs then outputs, every digit."""
    text = io.StringIO()
    writer = csv.writer(text)
    units = INPUT_UNITS | OUTPUT_UNITS
    writer.writerow([f"{name} [{unit}]" if unit else name for name, unit in units.items()])
    writer.writerows(np.hstack([vectors.inputs, vectors.outputs]).tolist())
    return text.getvalue()


def as_c_header(vectors: Vectors) -> str:
    """Return the vectors as the C header that test_vssea_controller.c includes."""
    parts = []
    for name, size, values in (
        ("vssea_inputs", "VSSEA_INPUTS", vectors.inputs),
        ("vssea_expected", "VSSEA_OUTPUTS", vectors.outputs),
    ):
        rows = ",\n    ".join(braced(row) for row in values.tolist())
        parts.append(f"static const double {name}[VSSEA_TICKS][{size}] = {{\n    {rows},\n}};\n")
    return (
        f"/* Test vectors of the controller, made by VSSEA {__version__}; columns as in vssea_controller_flat. */\n"
        f"#define VSSEA_TICKS {len(vectors.inputs)}\n\n" + "\n".join(parts)
    )
