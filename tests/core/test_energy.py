"""Physics of the simulated plant: energy, passivity, equilibrium, and what the paper's printed back torque does."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.core.experiment import coasting
from vssea_core.actuator.dynamics import Plant, PlantState
from vssea_core.actuator.parameters import Actuator, StiffnessMechanism
from vssea_core.actuator.spring import equilibrium_deflection, stiffness_motor_position
from vssea_core.scenario import Initial, Scenario
from vssea_core.scenarios import NOMINAL, REALISTIC
from vssea_core.signals.documents import (
    ConstantDisturbance,
    ConstantStiffness,
    Disturbances,
    SineDisturbance,
    StepReference,
)
from vssea_core.simulation.run import simulate
from vssea_core.simulation.trajectory import Trajectory

INERTIAS = {"link": 0.10, "motor": 3.17, "stiffness_motor": 1e-4}
SPRING_CONSTANT = 6.2e7


@dataclass(frozen=True)
class Losses:
    """Damping of link, motor and stiffness motor [N m s/rad] and dry friction of the motor [N m]."""

    link: float = 0.0
    motor: float = 0.0
    stiffness_motor: float = 0.0
    dry: float = 0.0


def plant(losses: Losses, *, as_printed: bool = False, stops: tuple[float, float] = (0.0, math.inf)) -> Plant:
    per = [1.0 / inertia for inertia in INERTIAS.values()]
    return Plant(
        per[0], losses.link, per[1], losses.motor, losses.dry, 0.005, SPRING_CONSTANT,
        per[2], losses.stiffness_motor, *stops, float(as_printed), 3.0,
    )  # fmt: skip


def energy(run: Trajectory) -> np.ndarray:
    """Kinetic energy of the three inertias and the spring's, V = (2 Y/theta_ms^3)(1 - cos(delta/2)) [J]."""
    kinetic = sum(0.5 * inertia * run[f"{name}_velocity"] ** 2 for name, inertia in INERTIAS.items())
    spring = 2.0 * SPRING_CONSTANT / run["stiffness_motor_position"] ** 3 * (1.0 - np.cos(run["deflection"] / 2.0))
    return kinetic + spring


starts = st.builds(
    PlantState,
    st.floats(-0.25, 0.25), st.floats(-2.0, 2.0), st.floats(-0.25, 0.25), st.floats(-1.0, 1.0),
    st.floats(50.0, 80.0), st.floats(-40.0, 40.0), st.just(0.0),
)  # fmt: skip


@given(starts)
@settings(deadline=None, max_examples=25)
def test_without_losses_energy_is_conserved_while_the_stiffness_motor_moves(start: PlantState) -> None:
    run = coasting(plant(Losses()), start, 200, period=2.5e-4)
    total = energy(run)
    assert np.abs(total - total[0]).max() < 1e-6 * total[0] + 1e-9


def test_energy_moves_between_spring_and_stiffness_motor() -> None:
    start = PlantState(0.0, 1.0, 0.4, -0.5, 60.0, 10.0, 0.0)
    run = coasting(plant(Losses()), start, 400, period=2.5e-4)
    own = 0.5 * INERTIAS["stiffness_motor"] * run["stiffness_motor_velocity"] ** 2
    assert np.ptp(own) > 0.05 * energy(run)[0]


@given(
    starts,
    st.builds(Losses, st.floats(0.0, 1.0), st.floats(0.0, 20.0), st.floats(0.0, 1e-3), st.sampled_from([0.0, 5.6])),
)
@settings(deadline=None, max_examples=25)
def test_with_losses_energy_never_grows(start: PlantState, losses: Losses) -> None:
    run = coasting(plant(losses), start, 200, period=2.5e-4)
    total = energy(run)
    assert np.diff(total).max() <= 1e-8 * total[0] + 1e-12


@pytest.mark.parametrize(("stop", "rate"), [(0, -60.0), (1, 30.0)], ids=["stiff", "soft"])
def test_end_stops_take_energy_and_never_return_it(stop: int, rate: float) -> None:
    stops = (50.0, 56.0)
    start = PlantState(0.0, 0.0, 0.1, 0.0, 53.0, rate, 0.0)
    run = coasting(plant(Losses(), stops=stops), start, 2000, period=2.5e-4)
    position = run["stiffness_motor_position"]
    assert np.any(position == stops[stop])
    assert np.all((position >= stops[0]) & (position <= stops[1]))
    total = energy(run)
    assert np.diff(total).max() < 1e-6
    assert total[-1] < 0.95 * total[0]


def test_the_printed_back_torque_throws_the_stiffness_motor_into_its_stop_within_10_ms() -> None:
    """Eq. (2) as printed puts the spring's own torque on an inertia of 1e-4 kg m^2; the energy's gradient is far smaller."""
    theta_ms, stop = (stiffness_motor_position(k, SPRING_CONSTANT) for k in (500.0, 1000.0))
    start = PlantState(0.0, 0.0, equilibrium_deflection(20.0, SPRING_CONSTANT, theta_ms), 0.0, theta_ms, 0.0, 0.0)
    printed, gradient = (
        coasting(plant(Losses(), as_printed=choice, stops=(stop, 116.0)), start, 11) for choice in (True, False)
    )
    assert printed["stiffness_motor_position"][-1] == stop
    assert theta_ms < gradient["stiffness_motor_position"][-1] < theta_ms + 0.2


@given(
    load=st.floats(-6.0, 6.0), motor_load=st.floats(-5.0, 5.0), stiffness=st.floats(40.0, 900.0),
    position=st.floats(-3.0, 3.0), back_torque=st.sampled_from(["energy", "paper"]),
)  # fmt: skip
@settings(deadline=None, max_examples=20)
def test_a_start_under_a_constant_load_stays_in_equilibrium(
    load: float, motor_load: float, stiffness: float, position: float, back_torque: str
) -> None:
    mechanism = StiffnessMechanism(back_torque=back_torque, peak_torque=50.0, continuous_torque=50.0)
    scenario = NOMINAL.model_copy(
        update={
            "actuator": Actuator(stiffness=mechanism),
            "reference": StepReference(origin=position, target=position),
            "stiffness_reference": ConstantStiffness(stiffness=stiffness),
            "disturbances": Disturbances(
                link=(ConstantDisturbance(torque=load),), motor=(ConstantDisturbance(torque=motor_load),)
            ),
            "initial": Initial(link_position=position),
            "duration_s": 0.3,
        }
    )
    run = simulate(scenario)
    for name in ("link_velocity", "motor_velocity", "stiffness_motor_velocity"):
        assert np.abs(run[name]).max() < 1e-9, name
    assert np.allclose(run["motor_torque"], load + motor_load, atol=1e-6)
    assert np.allclose(run["link_disturbance_estimate"], load, atol=1e-8)
    assert np.allclose(run["motor_disturbance_estimate"], motor_load, atol=1e-6)


def test_the_realistic_rig_starts_under_load_without_a_kick() -> None:
    loads = Disturbances(
        link=(ConstantDisturbance(torque=4.0), SineDisturbance(amplitude=2.0, frequency_hz=0.0, phase=1.0)),
        motor=(ConstantDisturbance(torque=-3.0),),
    )
    scenario = REALISTIC.model_copy(
        update={"disturbances": loads, "duration_s": 0.3, "reference": StepReference(origin=0.0, target=0.0)}
    )
    run = simulate(scenario)
    first_count = 2.0 * math.pi / 2**REALISTIC.sensors.link_bits
    assert np.ptp(run["motor_torque"]) < 0.3
    assert np.abs(run["link_position"]).max() < first_count


def test_a_load_the_spring_cannot_carry_is_refused_with_what_to_do() -> None:
    scenario = Scenario(
        stiffness_reference=ConstantStiffness(stiffness=20.0),
        disturbances=Disturbances(link=(ConstantDisturbance(torque=60.0),)),
    )
    with pytest.raises(ValueError, match=r"cannot carry 60 N·m .* raise the stiffness"):
        simulate(scenario)
