"""Whatever a valid document asks for, a simulation of it ends finite, or early with the reason."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vssea_core.actuator.parameters import Actuator, EquilibriumMotor, Link, Sensors, StiffnessMechanism, Timing
from vssea_core.channels import CHANNELS
from vssea_core.control.tuning import PositionObserver, SlidingMode, StateFeedback, Tuning, VelocityObserver
from vssea_core.scenario import Initial, Scenario
from vssea_core.scenarios import NOMINAL
from vssea_core.signals.documents import (
    ChirpDisturbance,
    ChirpReference,
    ConstantDisturbance,
    ConstantStiffness,
    ContactDisturbance,
    Disturbances,
    FilteredStepReference,
    JogReference,
    MoveReference,
    MoveStiffness,
    MultisineDisturbance,
    MultisineReference,
    NoiseDisturbance,
    PendulumDisturbance,
    PositionComponent,
    PulseDisturbance,
    RecordedReference,
    SineDisturbance,
    SineReference,
    StepReference,
    TorqueComponent,
)
from vssea_core.simulation.metrics import metrics
from vssea_core.simulation.run import simulate
from vssea_core.simulation.trajectory import Trajectory

stiffnesses, angles = st.floats(20.0, 1000.0), st.floats(-1.0, 1.0)
actuators = st.builds(
    Actuator,
    link=st.builds(Link, inertia=st.floats(0.03, 0.45), damping=st.floats(0.0, 1.0)),
    motor=st.builds(
        EquilibriumMotor,
        coulomb_friction=st.floats(0.0, 9.0),
        torque_lag_s=st.sampled_from([0.0, 1e-5, 1.6e-4, 5e-4, 5e-3]),
        torque_delay_s=st.sampled_from([0.0, 0.0, 1e-4, 5e-4, 2.2e-3]),
    ),
    stiffness=st.builds(StiffnessMechanism, back_torque=st.sampled_from(["energy", "paper"])),
)
tunings = st.builds(
    Tuning,
    controller=st.one_of(
        st.builds(StateFeedback, natural_frequency=st.floats(0.5, 300.0), damping=st.floats(0.2, 2.0)),
        st.builds(SlidingMode, switching_gain=st.floats(0.0, 1e6), switch=st.sampled_from(["layer", "sgn"])),
    ),
    observer=st.one_of(
        st.builds(PositionObserver, bandwidth=st.floats(1.0, 2000.0)),
        st.builds(
            VelocityObserver,
            bandwidth=st.floats(1.0, 2000.0),
            discretisation=st.sampled_from(["exact", "first_order_hold"]),
            velocity_source=st.just("difference"),
        ),
    ),
)
anywhere = [
    st.builds(ConstantDisturbance, torque=st.floats(-10.0, 10.0), start_s=st.floats(0.01, 0.3)),
    st.builds(SineDisturbance, amplitude=st.floats(0.0, 20.0), frequency_hz=st.floats(0.0, 200.0), phase=st.just(0.0)),
    st.builds(
        MultisineDisturbance,
        components=st.lists(st.builds(TorqueComponent, frequency_hz=st.floats(0.0, 200.0)), max_size=8).map(tuple),
    ),
    st.builds(ChirpDisturbance, end_frequency_hz=st.floats(0.01, 200.0), duration_s=st.floats(0.1, 2.0)),
    st.builds(NoiseDisturbance, rms=st.floats(0.0, 0.3), bandwidth_hz=st.floats(0.01, 100.0)),
    st.builds(PulseDisturbance, torque=st.floats(-10.0, 10.0), width_s=st.floats(0.005, 0.09), period_s=st.floats(0.1, 0.4),
              start_s=st.floats(0.01, 0.3)),
]  # fmt: skip
met = [
    st.builds(PendulumDisturbance, mass=st.floats(0.0, 0.5), length=st.floats(0.0, 0.5)),
    st.builds(
        ContactDisturbance, position=st.floats(1.0, 1.5), stiffness=st.floats(0.0, 1e5), damping=st.floats(0.0, 100.0)
    ),
    st.builds(
        ContactDisturbance, position=angles, side=st.sampled_from(["above", "below"]), start_s=st.floats(0.01, 0.3)
    ),
]
loads = st.lists(st.one_of(anywhere), max_size=3).map(tuple)
link_loads = st.lists(st.one_of(anywhere + met), max_size=3).map(tuple)
late_loads = st.lists(
    st.builds(ConstantDisturbance, torque=st.floats(-1.0, 1.0), start_s=st.floats(0.01, 0.3)), max_size=2
)
scenarios = st.builds(
    Scenario,
    actuator=actuators,
    sensors=st.builds(
        Sensors,
        link_bits=st.integers(0, 20),
        motor_counts=st.sampled_from([0, 1, 16384]),
        velocities=st.booleans(),
        link_noise=st.sampled_from([0.0, 0.0, 1e-4]),
        velocity_noise=st.sampled_from([0.0, 0.0, 0.1]),
    ),
    timing=st.builds(
        Timing, sample_time_s=st.sampled_from([1e-4, 3.3e-4, 1e-3, 5e-3]), compute_delay_samples=st.sampled_from([0, 1])
    ),
    tuning=tunings,
    reference=st.one_of(
        st.builds(SineReference, amplitude=angles.map(abs), frequency_hz=st.floats(0.0, 50.0)),
        st.builds(MoveReference, target=angles, duration_s=st.floats(0.02, 1.0), start_s=st.floats(0.0, 0.2)),
        st.builds(StepReference, target=angles, start_s=st.floats(0.0, 0.2)),
        st.builds(
            MultisineReference,
            components=st.lists(st.builds(PositionComponent, frequency_hz=st.floats(0.0, 50.0)), max_size=8).map(tuple),
        ),
        st.builds(FilteredStepReference, target=angles, bandwidth=st.floats(1.0, 200.0), dwell_s=st.floats(1.0, 2.0)),
        st.builds(ChirpReference, amplitude=angles.map(abs), end_frequency_hz=st.floats(0.01, 50.0)),
        st.builds(JogReference, velocity=st.floats(-20.0, 20.0), distance=st.one_of(st.none(), st.floats(0.01, 10.0))),
        st.builds(RecordedReference, positions=st.tuples(angles, angles, angles, angles)),
    ),
    stiffness_reference=st.one_of(
        st.builds(ConstantStiffness, stiffness=stiffnesses),
        st.builds(MoveStiffness, stiffness=stiffnesses, target=stiffnesses, start_s=st.floats(0.0, 0.2)),
    ),
    disturbances=st.builds(Disturbances, link=link_loads, motor=loads, stiffness_motor=late_loads.map(tuple)),
    seed=st.integers(0, 2**31 - 1),
    initial=st.builds(Initial, link_position=angles),
    duration_s=st.floats(0.001, 0.5),
)


@given(scenarios)
@settings(deadline=None, max_examples=100)
def test_any_valid_scenario_stays_finite_or_says_why_it_ended(scenario: Scenario) -> None:
    run = simulate(scenario)
    asked = max(1, round(scenario.duration_s / scenario.timing.sample_time_s))
    assert run.rows.shape[1] == len(CHANNELS)
    assert np.allclose(run["time"], np.arange(len(run)) * scenario.timing.sample_time_s)
    plant = ("link_position", "motor_position", "stiffness_motor_position", "motor_torque", "link_velocity")
    for name in plant:
        assert np.isfinite(run[name]).all(), name
    if run.ending is None:
        assert len(run) == asked
        assert all(np.isfinite(value) for value in metrics(run.rows).values())
    else:
        assert len(run) <= asked
        assert run.ending.startswith("stopped at t = ")


def test_a_run_ends_when_the_deflection_leaves_the_springs_law() -> None:
    hit = Disturbances(link=(ConstantDisturbance(torque=150.0, start_s=0.2),))
    run: Trajectory = simulate(NOMINAL.model_copy(update={"disturbances": hit, "duration_s": 1.0}))
    assert run.ending is not None
    assert "the deflection left ±π rad" in run.ending
    assert 0.2 < run["time"][-1] < 0.4
    assert (
        run.ending == f"stopped at t = {run['time'][-1]:.3f} s: the deflection left ±π rad, where the spring's law ends"
    )


def test_a_scenario_gives_the_same_bits_every_time() -> None:
    assert np.array_equal(simulate(NOMINAL).rows, simulate(NOMINAL).rows)


def test_an_unknown_channel_is_refused_with_the_known_ones() -> None:
    with pytest.raises(KeyError, match=r"no channel 'torque'; known: time, reference"):
        Trajectory(np.zeros((1, len(CHANNELS))), 1e-3)["torque"]
