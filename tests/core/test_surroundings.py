"""Weight and wall on the link: against scipy with events, their own laws, and starts in equilibrium."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.core.as_reference import reference_config
from tests.core.experiment import NO_TORQUE, Experiment
from tests.reference.closed_loop import simulate as reference_simulate
from tests.reference.parameters import Plant as ReferencePlant
from tests.reference.plant import derivative
from vssea_core.actuator.dynamics import PlantState
from vssea_core.actuator.parameters import Actuator, EquilibriumMotor
from vssea_core.actuator.sensors import Encoders
from vssea_core.scenario import Initial, Scenario
from vssea_core.scenarios import NOMINAL, REALISTIC
from vssea_core.signals.documents import (
    ConstantDisturbance,
    ContactDisturbance,
    Disturbances,
    LinkDisturbance,
    MoveReference,
    NoiseDisturbance,
    PendulumDisturbance,
    SineDisturbance,
    StepReference,
)
from vssea_core.simulation.run import simulate
from vssea_core.simulation.state import PLANT, plant_numbers, rig_numbers
from vssea_core.simulation.trajectory import Trajectory

GRAVITY = 9.80665
REST = StepReference(origin=0.0, target=0.0)


def coasting(terms: tuple[LinkDisturbance, ...], start: PlantState, count: int, **plant: float) -> Trajectory:
    """Both motors without torque, the link loaded by `terms`."""
    scenario = Scenario(disturbances=Disturbances(link=terms), actuator=Actuator(motor=EquilibriumMotor(**plant)))
    experiment = Experiment(scenario.model_copy(update={"disturbances": Disturbances()}))
    experiment.inputs = Experiment(scenario.model_copy(update={"initial": Initial(link_position=0.0)})).inputs
    numbers = plant_numbers(scenario.actuator, 1e-3)
    experiment.rig = rig_numbers(numbers, NO_TORQUE, Encoders(0.0, 0.0, 0.0), 0.0, scenario.timing)
    experiment.state[:PLANT] = start
    return experiment.advance(count)


def met(terms: tuple[LinkDisturbance, ...], theta: float, omega: float) -> float:
    """The torque of weights and walls, written down once more."""
    total = 0.0
    for term in terms:
        if isinstance(term, PendulumDisturbance):
            total += term.mass * GRAVITY * term.length * math.sin(theta)
        elif isinstance(term, ContactDisturbance):
            sign = 1.0 if term.side == "above" else -1.0
            depth = sign * (theta - term.position)
            if depth > 0.0:
                total += sign * max(0.0, term.stiffness * depth + term.damping * sign * omega)
    return total


def solved(terms: tuple[LinkDisturbance, ...], start: PlantState, times: np.ndarray) -> np.ndarray:
    """States (n, 7) by scipy, integrated from one wall event to the next."""
    plant = ReferencePlant()
    walls = [term for term in terms if isinstance(term, ContactDisturbance)]

    def slope(t: float, x: np.ndarray) -> list[float]:
        load = met(terms, x[0], x[1])
        return derivative(plant, t, x.tolist(), 0.0, 0.0, (lambda _: load, lambda _: 0.0, lambda _: 0.0))

    def depth(wall: ContactDisturbance):  # type: ignore[no-untyped-def]
        def event(t: float, x: np.ndarray) -> float:
            return float(x[0] - wall.position)

        event.terminal = True  # type: ignore[attr-defined]
        return event

    def release(wall: ContactDisturbance):  # type: ignore[no-untyped-def]
        def event(t: float, x: np.ndarray) -> float:
            return float(wall.stiffness * (x[0] - wall.position) + wall.damping * x[1])

        event.terminal = True  # type: ignore[attr-defined]
        return event

    events = [make(wall) for wall in walls for make in (depth, release)]
    t, x, states = 0.0, np.array(start), [np.array(start)]
    for end in times[1:]:
        while t < end:
            part = solve_ivp(slope, (t, end), x, method="DOP853", rtol=1e-11, atol=1e-13, events=events)
            t, x = float(part.t[-1]), part.y[:, -1]
            if t < end:  # a hair past the event, so that it is not found again
                hair = min(1e-10, end - t)
                x, t = x + hair * np.array(slope(t, x)), t + hair
        states.append(x)
    return np.array(states)


START = PlantState(0.1, 2.0, 0.15, 1.0, 53.7, 0.0, 0.0)


def test_a_weight_swings_as_scipy_says() -> None:
    terms = (PendulumDisturbance(mass=1.0, length=0.4),)
    run, expected = coasting(terms, START, 300), solved(terms, START, np.arange(300) * 1e-3)
    for column, name in ((0, "link_position"), (1, "link_velocity"), (2, "motor_position")):
        assert np.abs(run[name] - expected[:, column]).max() < 1e-8, name
    assert np.allclose(run["link_disturbance"], GRAVITY * 0.4 * np.sin(run["link_position"]))


@pytest.mark.parametrize(("stiffness", "damping"), [(500.0, 0.0), (1000.0, 2.0), (2e4, 20.0)])
def test_a_bounce_against_a_wall_is_as_scipy_with_events_says(stiffness: float, damping: float) -> None:
    terms = (ContactDisturbance(position=0.13, stiffness=stiffness, damping=damping),)
    run, expected = coasting(terms, START, 120), solved(terms, START, np.arange(120) * 1e-3)
    assert run["link_disturbance"].max() > 1.0
    assert np.abs(run["link_position"] - expected[:, 0]).max() < 1e-5
    assert np.abs(run["link_velocity"] - expected[:, 1]).max() < 5e-3


def test_a_wall_below_is_the_mirror_image_of_one_above() -> None:
    above = coasting((ContactDisturbance(position=0.13),), START, 200)
    mirrored = PlantState(*(-value for value in START[:4]), *START[4:])
    below = coasting((ContactDisturbance(position=-0.13, side="below"),), mirrored, 200)
    assert np.allclose(above["link_position"], -below["link_position"], atol=1e-12)
    assert np.allclose(above["link_disturbance"], -below["link_disturbance"], atol=1e-9)


def test_a_wall_without_damping_and_a_weight_conserve_energy() -> None:
    wall, weight = ContactDisturbance(position=0.15, stiffness=2000.0, damping=0.0), PendulumDisturbance(mass=0.5)
    scenario_plant = {"damping": 0.0}
    run = coasting((wall, weight), START, 400, **scenario_plant)
    link, motor = run["link_position"], run["motor_velocity"]
    spring = 2.0 * 6.2e7 / run["stiffness_motor_position"] ** 3 * (1.0 - np.cos(run["deflection"] / 2.0))
    own = (
        0.5 * 1e-4 * run["stiffness_motor_velocity"] ** 2
        + 0.5 * 3.17 * motor**2
        + 0.5 * 0.1 * run["link_velocity"] ** 2
    )
    stored = 1000.0 * np.maximum(0.0, link - 0.15) ** 2 - 0.5 * GRAVITY * 0.3 * np.cos(link)
    lost = (
        0.1 * np.cumsum(run["link_velocity"] ** 2) * 1e-3
        + 1e-4 * np.cumsum(run["stiffness_motor_velocity"] ** 2) * 1e-3
    )
    total = own + spring + stored + lost
    assert np.any(link > 0.15)
    assert np.ptp(total) < 5e-3 * np.ptp(stored)


def test_a_wall_only_pushes_and_only_inside() -> None:
    run = simulate(
        NOMINAL.model_copy(
            update={
                "reference": MoveReference(target=0.3, repeat=False),
                "disturbances": Disturbances(link=(ContactDisturbance(position=0.28, stiffness=5e3, damping=50.0),)),
                "duration_s": 3.0,
            }
        )
    )
    push, depth = run["link_disturbance"], run["link_position"] - 0.28
    assert run.ending is None
    assert push.min() == 0.0
    assert push.max() > 1.0
    assert not push[depth <= 0.0].any()
    assert np.allclose(push, np.where(depth > 0, np.maximum(0.0, 5e3 * depth + 50.0 * run["link_velocity"]), 0.0))


def test_the_stiffest_wall_on_the_lightest_link_stays_bounded() -> None:
    light = Actuator(link=Actuator().link.model_copy(update={"inertia": 0.005}))
    wall = ContactDisturbance(position=0.1, stiffness=1e5, damping=100.0)
    for period in (1e-3, 5e-3):
        scenario = NOMINAL.model_copy(
            update={
                "actuator": light,
                "timing": NOMINAL.timing.model_copy(update={"sample_time_s": period}),
                "disturbances": Disturbances(link=(wall,)),
                "duration_s": 2.0,
            }
        )
        run = simulate(scenario)
        assert run["link_position"].max() < 0.11, period


@pytest.mark.parametrize("scenario", [NOMINAL, REALISTIC], ids=lambda each: each.name)
def test_a_period_in_parts_is_the_ordinary_period(scenario: Scenario) -> None:
    """A weight of no mass changes nothing, though it takes the other path."""
    short = scenario.model_copy(update={"duration_s": 3.5})
    weightless = PendulumDisturbance(mass=0.0)
    loads = short.disturbances.model_copy(update={"link": (*short.disturbances.link, weightless)})
    apart = simulate(short.model_copy(update={"disturbances": loads}))
    gap = np.abs(simulate(short)["link_position"] - apart["link_position"]).max()
    assert gap < (1e-12 if scenario is NOMINAL else 1e-6)


@pytest.mark.parametrize("angle", [-1.2, 0.0, 0.7, 3.0])
def test_a_start_under_a_weight_stays_in_equilibrium(angle: float) -> None:
    loads = Disturbances(
        link=(PendulumDisturbance(mass=1.0, length=0.5), ConstantDisturbance(torque=1.0)),
        stiffness_motor=(ConstantDisturbance(torque=0.1),),
    )
    run = simulate(
        NOMINAL.model_copy(
            update={
                "disturbances": loads,
                "initial": Initial(link_position=angle),
                "reference": StepReference(origin=angle, target=angle),
                "duration_s": 0.3,
            }
        )
    )
    assert np.allclose(run["link_disturbance"], 1.0 + GRAVITY * 0.5 * math.sin(angle))
    assert np.allclose(run["stiffness_motor_disturbance"], 0.1)
    for name in ("link_velocity", "motor_velocity", "stiffness_motor_velocity"):
        assert np.abs(run[name]).max() < 1e-8, name


def test_a_start_inside_a_wall_that_the_spring_bears_stays_in_equilibrium() -> None:
    loads = Disturbances(link=(ContactDisturbance(position=-0.01, stiffness=500.0),))
    run = simulate(NOMINAL.model_copy(update={"disturbances": loads, "reference": REST, "duration_s": 0.2}))
    assert np.allclose(run["link_disturbance"], 5.0)
    assert np.abs(run["link_velocity"]).max() < 1e-9


def test_a_noise_that_acts_at_the_start_starts_in_equilibrium() -> None:
    loads = Disturbances(link=(NoiseDisturbance(rms=2.0),), motor=(NoiseDisturbance(rms=1.0),))
    run = simulate(NOMINAL.model_copy(update={"disturbances": loads, "reference": REST, "seed": 5, "duration_s": 0.01}))
    assert run["link_disturbance"][0] == pytest.approx(run["link_disturbance_estimate"][0])
    assert run["motor_torque"][0] == pytest.approx(run["link_disturbance"][0] + run["motor_disturbance"][0])
    assert abs(run["link_disturbance"][0]) > 0.01


REFUSED = {
    "wall and weight load the link with 400 N·m: the spring cannot carry .* or start elsewhere": Disturbances(
        link=(ContactDisturbance(position=-0.4, stiffness=1000.0),)
    ),
    "the motor would need 90 N·m to hold still at t = 0; expected at most its peak torque 74": Disturbances(
        motor=(ConstantDisturbance(torque=90.0),)
    ),
    "the stiffness motor would need .* lower the disturbances at t = 0": Disturbances(
        stiffness_motor=(ConstantDisturbance(torque=3.0),)
    ),
}


@pytest.mark.parametrize("sentence", REFUSED)
def test_what_cannot_start_at_rest_is_refused_with_what_to_do(sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        simulate(NOMINAL.model_copy(update={"disturbances": REFUSED[sentence]}))


def test_a_disturbed_stiffness_motor_moves_as_the_reference_says() -> None:
    """Same sign as Eq. (1): a positive torque slows it; its estimate goes into the stiffness loop."""
    loads = Disturbances(stiffness_motor=(SineDisturbance(amplitude=0.2, frequency_hz=5.0, start_s=0.05),))
    scenario = NOMINAL.model_copy(update={"disturbances": loads, "duration_s": 0.4})
    config = reference_config(scenario)
    run, expected = simulate(scenario), reference_simulate(config)
    assert np.abs(run["stiffness_motor_position"] - expected["state"][:, 4]).max() < 1e-8
    assert np.ptp(run["stiffness_motor_position"]) > 1e-3


def test_the_stiff_end_stop_holds_what_overcomes_the_stiffness_motor() -> None:
    loads = Disturbances(stiffness_motor=(ConstantDisturbance(torque=5.0, start_s=0.1),))
    run = simulate(NOMINAL.model_copy(update={"disturbances": loads, "duration_s": 1.0}))
    assert run["stiffness_motor_position"].min() == pytest.approx((6.2e7 / 2000.0) ** (1 / 3))
