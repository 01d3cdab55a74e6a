"""The probed loop against the compiled kernel: its matrix by differences, its inputs by small simulations."""

import numpy as np
import pytest

from tests.core.experiment import Experiment
from vssea_core.actuator.drive import Drives
from vssea_core.actuator.parameters import Actuator, EquilibriumMotor, Link, StiffnessMechanism, Timing
from vssea_core.actuator.sensors import Encoders
from vssea_core.analysis.assembly import LINK_LOAD, MOTOR_LOAD, NOISE, REFERENCE, TORQUE
from vssea_core.analysis.loop import LoopModel, loop_model
from vssea_core.analysis.operating_point import LinearPlant, OperatingPoint
from vssea_core.analysis.probe import ENTRIES, PLANT_NAMES, POSITION_ENTRIES
from vssea_core.control.tuning import (
    Controller,
    Observer,
    PositionObserver,
    SlidingMode,
    StateFeedback,
    Tuning,
    VelocityObserver,
)
from vssea_core.scenario import Scenario
from vssea_core.signals.documents import ConstantDisturbance, ConstantStiffness, Disturbances, StepReference
from vssea_core.simulation.state import APPLIED, MEMORY, PENDING, plant_numbers, rig_numbers

UNLIMITED = Drives(1e12, 1e12, 1e12, 0.0, 1e12, 1e12, 1e12, 0.0, 1e36)
TINY = 1e-20
"""Size of small signals: the spring's curvature is far below rounding."""
OBSERVERS: dict[str, Observer] = {
    "velocity": VelocityObserver(bandwidth=80.0),
    "first-order hold": VelocityObserver(bandwidth=80.0, discretisation="first_order_hold"),
    "difference": VelocityObserver(bandwidth=50.0, velocity_source="difference"),
    "position": PositionObserver(bandwidth=80.0),
}
CONTROLLERS: dict[str, Controller] = {"feedback": StateFeedback(), "sliding": SlidingMode(switching_gain=2e4)}
MISMATCHED = Actuator(
    link=Link(inertia=0.13, damping=0.2),
    motor=EquilibriumMotor(inertia=3.4, damping=6.0, torque_lag_s=1.6e-4),
    stiffness=StiffnessMechanism(spring_constant=5.5e7),
)
PLANT_PLACES = {"link_position": 0, "link_velocity": 1, "motor_position": 2, "motor_velocity": 3, "motor_torque": 6}


def still(observer: Observer, controller: Controller, delay: int, **changes: object) -> Scenario:
    """A scenario at rest at zero, on the mismatched plant."""
    fields: dict[str, object] = {
        "actuator": MISMATCHED,
        "timing": Timing(compute_delay_samples=delay),
        "tuning": Tuning(observer=observer, controller=controller),
        "reference": StepReference(origin=0.0, target=0.0, repeat=False, start_s=0.0),
        "stiffness_reference": ConstantStiffness(stiffness=300.0),
        "duration_s": 1.0,
    }
    return Scenario(**(fields | changes))


def loop_of(scenario: Scenario) -> LoopModel:
    plant = LinearPlant.of_actuator(scenario.actuator)
    return loop_model(OperatingPoint(scenario.tuning, scenario.timing, scenario.stiffness_reference.stiffness, plant))


def started(scenario: Scenario) -> Experiment:
    """The scenario after its first tick, at rest, without drive limits."""
    experiment = Experiment(scenario)
    plant, lag = plant_numbers(scenario.actuator, scenario.timing.sample_time_s), scenario.actuator.motor.torque_lag_s
    experiment.rig = rig_numbers(plant, UNLIMITED, Encoders(0.0, 0.0, 0.0), lag, scenario.timing)
    experiment.advance(1)
    return experiment


def places(names: tuple[str, ...]) -> list[int]:
    """Places in the kernel's state of the loop's states."""
    found = []
    for name in names:
        if name == "delayed_torque":
            found.append(PENDING)
        elif name in PLANT_NAMES:
            found.append(PLANT_PLACES[name])
        else:
            found.append(MEMORY + ENTRIES[name])
    return found


@pytest.mark.parametrize("delay", [0, 1])
@pytest.mark.parametrize("observer", OBSERVERS.values(), ids=OBSERVERS)
@pytest.mark.parametrize("controller", CONTROLLERS.values(), ids=CONTROLLERS)
def test_the_matrix_is_that_of_the_kernel_taken_by_differences(
    observer: Observer, controller: Controller, delay: int
) -> None:
    """The kernel's state s holds plant and memory of different ticks: xi = W s, so A W = W F with its own matrix F."""
    scenario = still(observer, controller, delay)
    loop, experiment = loop_of(scenario), started(scenario)
    memory = [MEMORY + place for place in POSITION_ENTRIES]
    kernel = [*PLANT_PLACES.values(), *memory, APPLIED, *([PENDING] if delay else [])]
    rest = experiment.state.copy()
    F = np.empty((len(kernel), len(kernel)))
    for column, place in enumerate(kernel):
        sides = []
        for size in (TINY, -TINY):
            probe = experiment.fork()
            probe.state = rest.copy()
            probe.state[place] += size
            probe.advance(1)
            sides.append(probe.state[kernel])
        F[:, column] = (sides[0] - sides[1]) / (2.0 * TINY)
    wanted = places(loop.states)
    W = np.zeros((len(wanted), len(kernel)))
    for row, place in enumerate(wanted):
        at = kernel.index(place)
        if place in memory:
            W[row] = F[at]  # the memory of this tick is written by it
        else:
            W[row, at] = 1.0
    left, right = loop.A @ W, W @ F
    weight = np.abs(loop.A) @ np.abs(W) + np.abs(W) @ np.abs(F)
    assert np.all(np.abs(left - right) <= 1e-9 * weight.max(axis=1, keepdims=True))


INPUTS_TRIED = {
    "reference": (REFERENCE, {"reference": StepReference(origin=0.0, target=1e-12, repeat=False, start_s=0.0)}),
    "link load": (LINK_LOAD, {"disturbances": Disturbances(link=(ConstantDisturbance(torque=1e-12, start_s=0.001),))}),
    "motor load": (
        MOTOR_LOAD,
        {"disturbances": Disturbances(motor=(ConstantDisturbance(torque=1e-12, start_s=0.001),))},
    ),
}


@pytest.mark.parametrize("delay", [0, 1])
@pytest.mark.parametrize("observer", OBSERVERS.values(), ids=OBSERVERS)
@pytest.mark.parametrize("what", INPUTS_TRIED)
def test_inputs_act_as_in_a_simulation(observer: Observer, delay: int, what: str) -> None:
    column, changes = INPUTS_TRIED[what]
    scenario = still(observer, StateFeedback(), delay)
    loop, experiment = loop_of(scenario), started(scenario)
    driven = Experiment(still(observer, StateFeedback(), delay, **changes))
    driven.state, driven.rig, driven.sample = experiment.state.copy(), experiment.rig, 1
    run = driven.advance(150)
    xi = np.zeros(len(loop.A))
    torque, link = [], []
    for _ in range(150):
        link.append(loop.C[1] @ xi)
        torque.append(loop.C[TORQUE] @ xi + loop.D[TORQUE, column])
        xi = loop.A @ xi + loop.B[:, column]
    assert run["motor_torque_demand"] / 1e-12 == pytest.approx(torque, rel=1e-8, abs=1e-9 * np.abs(torque).max())
    assert run["link_position"] / 1e-12 == pytest.approx(link, rel=1e-8, abs=1e-9 * np.abs(link).max())


@pytest.mark.parametrize("observer", OBSERVERS.values(), ids=OBSERVERS)
@pytest.mark.parametrize("sensor", [0, 1])
def test_noise_of_one_reading_passes_as_in_the_kernel(observer: Observer, sensor: int) -> None:
    """A false reading at one tick: the plant is moved aside for that tick only."""
    scenario = still(observer, StateFeedback(), 1)
    loop, experiment = loop_of(scenario), started(scenario)
    column = NOISE + sensor
    place = ("link_position", "motor_position")[sensor]
    aside = experiment.fork()
    aside.state[PLANT_PLACES[place]] += TINY
    torque = [aside.advance(1)["motor_torque_demand"][0]]
    truth = experiment.fork()
    truth.advance(1)
    truth.state[MEMORY:] = aside.state[MEMORY:]
    truth.state[APPLIED:MEMORY] = aside.state[APPLIED:MEMORY]
    torque += list(truth.advance(99)["motor_torque_demand"])
    xi, expected = np.zeros(len(loop.A)), []
    for k in range(100):
        noise = 1.0 if k == 0 else 0.0
        expected.append(loop.C[TORQUE] @ xi + loop.D[TORQUE, column] * noise)
        xi = loop.A @ xi + loop.B[:, column] * noise
    assert np.array(torque) / TINY == pytest.approx(expected, rel=1e-7, abs=1e-8 * np.abs(expected).max())


def test_the_broken_loop_closed_again_is_the_closed_loop() -> None:
    loop = loop_of(still(PositionObserver(), StateFeedback(), 1))
    for A, B, C, _ in (loop.broken_at_plant(), loop.broken_at_limiter()):
        assert np.allclose(A - B @ C, loop.A, rtol=1e-12, atol=1e-9)


def test_a_delay_of_a_whole_sample_continues_that_of_nearly_one() -> None:
    scenario = still(VelocityObserver(), StateFeedback(), 0)
    plant = LinearPlant.of_actuator(scenario.actuator)
    point = OperatingPoint(scenario.tuning, scenario.timing, 300.0, plant.with_delay(1e-3))
    near = OperatingPoint(scenario.tuning, scenario.timing, 300.0, plant.with_delay(1e-3 - 1e-9))
    assert loop_model(point).radius == pytest.approx(loop_model(near).radius, rel=1e-6)
