"""What the emulated plant does, against closed forms and an integration by scipy."""

import math
import struct

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from backend.emulator.plant import LINK, MOTOR, STIFFNESS, EmulatedPlant, default_actuator
from tests.hardware import emulator_bench as host
from tests.hardware.emulator_bench import Bench
from vssea_core.actuator.parameters import Actuator, EquilibriumMotor

TURN = 2.0 * math.pi
EFFICIENCY = 0.7
Y, J_L, B_L, J_E, B_E, J_MS, B_MS = 6.2e7, 0.10, 0.10, 3.17, 4.0, 1.0e-4, 1.0e-4


def test_a_torque_moves_the_rig_as_an_independent_integration_says() -> None:
    torque, stiffness_torque, friction, smoothing, lag = 10.0, 0.002, 5.6, 0.005, 1.6e-4

    def motion(t: float, y: np.ndarray) -> list[float]:
        link, motor, soft, link_v, motor_v, soft_v = y
        deflection, given = motor - link, torque * (1.0 - math.exp(-t / lag))
        spring = Y / soft**3 * math.sin(0.5 * deflection)
        back = -6.0 * Y / soft**4 * (1.0 - math.cos(0.5 * deflection))
        dry = friction * motor_v / math.hypot(motor_v, smoothing)
        return [
            link_v,
            motor_v,
            soft_v,
            (spring - B_L * link_v) / J_L,
            (given - spring - B_E * motor_v - dry) / J_E,
            (stiffness_torque - B_MS * soft_v - back) / J_MS,
        ]

    start = [0.0, 0.0, (Y / 400.0) ** (1 / 3), 0.0, 0.0, 0.0]
    truth = solve_ivp(motion, (0.0, 0.4), start, method="DOP853", rtol=1e-10, atol=1e-12, max_step=1e-3).y[:, -1]
    plant = EmulatedPlant(default_actuator())
    plant.give(MOTOR, torque)
    plant.give(STIFFNESS, stiffness_torque)
    for _ in range(199):
        plant.advance(0.0020037)  # not a whole number of its steps
    plant.advance(0.4 - 199 * 0.0020037)
    got = [plant.position(LINK), plant.position(MOTOR), plant.position(STIFFNESS)]
    assert got == pytest.approx(truth[:3], rel=1e-5)
    assert plant.velocity(MOTOR) == pytest.approx(truth[4], rel=1e-4)


def test_it_starts_at_rest_and_stays_there() -> None:
    plant = EmulatedPlant(default_actuator())
    for _ in range(20):
        plant.advance(0.05)
    assert [plant.position(axis) for axis in (MOTOR, LINK)] == [0.0, 0.0]
    assert plant.truth()["stiffness"] == pytest.approx(200.0)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_drive_s_torque_counts_and_gear_have_one_sign_and_the_size_of_their_units(sign: int) -> None:
    actuator = Actuator(motor=EquilibriumMotor(damping=0.0))
    bench = Bench(actuator).enabled(torque=sign * 40)
    began = bench.read(host.MOTOR, 0x6064, signed=True)
    bench.cycle()
    start = bench.now  # the torque acts from here on
    for _ in range(150):
        bench.cycle()
    rated = 1e-6 * bench.read(host.MOTOR, 0x6076)
    torque = sign * 0.040 * rated * 100.0 * EFFICIENCY
    angle = TURN * (bench.read(host.MOTOR, 0x6064, signed=True) - began) / (16384 * 100)
    inertia = J_E + J_L  # the spring is stiff against this torque
    assert angle == pytest.approx(0.5 * torque / inertia * (bench.now - start) ** 2, rel=0.03)
    link = struct.unpack("<i", bench.taken(0x183)[-1])[0] * TURN / 131072
    assert link == pytest.approx(angle, abs=0.02)


def test_the_peak_torques_of_the_drives_are_those_of_the_actuator() -> None:
    bench = Bench()
    for node, gain, peak in ((host.MOTOR, 100.0 * EFFICIENCY, 74.0), (host.STIFFNESS, 1.0, 0.79)):
        rated = 1e-6 * bench.read(node, 0x6076)
        assert 1e-3 * rated * bench.read(node, 0x6072) * gain == pytest.approx(peak, rel=1e-3)


def test_the_stiffness_encoder_counts_from_where_it_was_switched_on_between_two_stops() -> None:
    bench = Bench(stiffness_offset=2.0).enabled()
    per_rad = 16384 / TURN
    assert bench.read(host.STIFFNESS, 0x6064, signed=True) == round(2.0 * per_rad)
    begins = bench.emulator.plant.position(STIFFNESS)
    ends = {}
    for direction in (-1, 1):
        bench.torques[host.STIFFNESS] = direction * 300
        bench.run(1.0)
        ends[direction] = bench.read(host.STIFFNESS, 0x6064, signed=True) / per_rad + begins - 2.0
    assert ends == pytest.approx({-1: (Y / 2000.0) ** (1 / 3), 1: (Y / 40.0) ** (1 / 3)}, abs=1e-3)


def test_a_stall_of_the_process_is_made_up_for_only_up_to_a_tenth_of_a_second() -> None:
    plant = EmulatedPlant(default_actuator())
    plant.give(MOTOR, 20.0)
    plant.advance(0.1)
    moved = plant.position(MOTOR)
    late = EmulatedPlant(default_actuator())
    late.give(MOTOR, 20.0)
    late.advance(3.0)
    assert late.position(MOTOR) == moved
    assert late.skipped_s == pytest.approx(2.9)
