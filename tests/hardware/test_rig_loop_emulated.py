"""The whole of a rig in injected time: loop, CANopen driver and emulator, over frames in memory."""

from collections.abc import Iterator

import numpy as np
import pytest

from backend.loop import messages
from backend.rigs.faults import LEASE_EXPIRED
from backend.telemetry.beats import LEASE
from tests.hardware.emulated_loop import EmulatedBench


@pytest.fixture
def bench() -> Iterator[EmulatedBench]:
    opened = EmulatedBench()
    opened.connect()
    opened.home()
    opened.arm()
    opened.pass_s(0.3)
    yield opened
    opened.close()


def follow(bench: EmulatedBench) -> None:
    bench.follow()
    bench.pass_s(1.3)
    assert (bench.state, bench.report().faults) == ("running", ())
    bench.bus.emulator.watch()


def test_the_emulated_rig_is_homed_armed_and_follows(bench: EmulatedBench) -> None:
    assert bench.report().kind == "emulated"
    assert bench.report().span_found == pytest.approx(84.3, abs=0.2)
    follow(bench)
    bench.pass_s(2.0)
    assert np.abs(bench.channel("error")[-500:]).max() < 0.01
    bench.stop()
    assert bench.until("stopped", most_s=1.5) < 1.0
    assert set(bench.bus.emulator.states().values()) == {"switch on disabled"}
    bench.do(messages.Reset())
    bench.arm()


# name, value, node, within [s] of which the loop notices, numbers of which one comes first
FAULTS = [
    ("frames_dropped", 0.5, None, 0.1, {1, 2, 3, 4}),
    ("frames_delayed", 30.0, None, 0.1, {1, 2, 3, 4}),
    ("frames_corrupted", 0.2, None, 1.0, set(range(1, 35))),
    ("encoder_frozen", None, 1, 1.0, {32, 31, 18, 13, 15, 16}),
    ("encoder_frozen", None, 3, 0.2, {11}),
    ("encoder_jump", 0.1, 1, 0.01, {9}),
    ("encoder_jump", 5.0, 2, 0.01, {10}),
    ("encoder_jump", 0.1, 3, 0.01, {8}),
    ("drive_fault", None, 1, 0.01, {5}),
    ("drive_fault", None, 2, 0.01, {6}),
    ("over_temperature", None, 1, 0.01, {20}),
    ("over_temperature", None, 2, 0.01, {20}),
    ("bus_off", None, None, 0.02, {1, 22}),
    ("link_lost", None, None, 0.02, {1}),
    ("node_reboot", None, 1, 0.02, {2, 19, 21}),
    ("node_reboot", None, 2, 0.02, {3, 19, 21}),
    ("node_reboot", None, 3, 0.02, {4, 21}),
    ("torque_saturated", 0.1, 1, 1.0, {23}),
    ("wrong_inertia", 5.0, None, 3.0, {13, 15, 16, 18, 31, 34}),
    ("end_stop", None, None, 0.5, {17, 33}),
]


@pytest.mark.parametrize(("name", "value", "node", "within_s", "first"), FAULTS, ids=lambda part: str(part))
def test_every_fault_of_the_emulator_ends_latched_and_safe(
    bench: EmulatedBench, name: str, value: float | None, node: int | None, within_s: float, first: set[int]
) -> None:
    follow(bench)
    bench.faults_of.set(name, value, node)
    begun = bench.now
    assert bench.until("stopping", "fault", most_s=within_s + 0.01) <= within_s + 0.01
    bench.until("fault", most_s=4.0)
    bench.pass_s(max(0.0, 3.0 - (bench.now - begun)))
    peaks = bench.bus.emulator.peaks()
    assert bench.faults()[0] in first
    assert not peaks["re_enabled"]
    assert peaks["motor_torque"] == 0.0
    assert peaks["safe_after_s"] is not None
    assert peaks["safe_after_s"] < within_s + 1.0
    assert peaks["states"]["motor"] in ("switch on disabled", "fault")
    bench.bus.emulator.watch()
    bench.faults_of.clear()
    bench.pass_s(1.0)  # what heals does not start by itself
    assert bench.state == "fault"
    assert not bench.bus.emulator.peaks()["re_enabled"]
    assert bench.bus.emulator.peaks()["peak_motor_torque"] == 0.0


def test_a_drive_fault_is_reset_when_its_cause_is_gone_and_not_before(bench: EmulatedBench) -> None:
    follow(bench)
    bench.faults_of.set("drive_fault", None, 2)
    bench.until("fault", most_s=3.0)
    assert "still reports" in bench.refused(messages.Reset())
    bench.faults_of.clear()
    bench.do(messages.Reset())
    assert bench.state == "ready"
    assert set(bench.bus.emulator.states().values()) == {"switch on disabled"}
    bench.pass_s(0.5)
    bench.arm()


def test_a_silent_operator_stops_the_emulated_rig_within_its_promise(bench: EmulatedBench) -> None:
    follow(bench)
    bench.bus.emulator.plant.mark()
    bench.alive[LEASE] = False
    bench.until("stopped", most_s=3.0)
    bench.pass_s(1.5)
    assert bench.reason() == LEASE_EXPIRED.sentence()
    peaks = bench.bus.emulator.peaks()
    assert 0.4 < peaks["safe_after_s"] < 0.4 + 0.65 + 0.02
    assert not peaks["re_enabled"]


def test_a_host_that_is_killed_leaves_a_rig_that_stops_itself(bench: EmulatedBench) -> None:
    follow(bench)
    bench.bus.emulator.plant.mark()
    for _ in range(400):  # nobody turns the loop any more
        bench.now += 0.005
        bench.bus.emulator.turn(bench.now)
    peaks = bench.bus.emulator.peaks()
    assert peaks["safe_after_s"] is not None
    assert peaks["safe_after_s"] < 0.5
    assert abs(peaks["motor_torque"]) == 0.0


def test_disconnect_leaves_the_drives_off(bench: EmulatedBench) -> None:
    follow(bench)
    bench.send(messages.Disconnect())
    bench.turn()
    bench.loop.run()
    assert set(bench.bus.emulator.states().values()) == {"switch on disabled"}
    assert bench.bus.closed
