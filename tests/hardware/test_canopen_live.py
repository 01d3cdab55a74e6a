"""The rig against the emulator, over a real socket and a real CANopen stack."""

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

from backend.cli import app
from backend.emulator.start import EmulatorHandle, start_emulator
from backend.rigs.canopen import CanopenRig
from backend.rigs.check import check_rig
from backend.rigs.faults import BUS_OFF, HOT, MOTOR_DRIVE, REBOOTED, Fault
from backend.rigs.rig import AXES
from tests.backend.server import until
from tests.hardware.fake_rig import GEAR_RATIO
from tests.hardware.live_rig import TORQUE, arm_both, pushed, rig_file_at, turns

pytestmark = pytest.mark.real_time


@pytest.fixture(scope="module")
def running() -> Iterator[EmulatorHandle]:
    handle = start_emulator()
    yield handle
    handle.close()


@pytest.fixture
def emulator(running: EmulatorHandle) -> EmulatorHandle:
    """The running emulator without a fault; what a test before left latched is reset."""
    running.control({"do": "clear"})
    if "fault" in running.control({"do": "state"})["states"].values():
        rig = CanopenRig(rig_file_at(running.port), GEAR_RATIO)
        rig.connect()
        rig.configure()
        turns(rig, lambda m: max(m.motor_age, m.stiffness_age) == 0)
        for axis in AXES:
            rig.reset(axis)
        turns(rig, lambda _: all(rig.axis(axis).state == "disabled" for axis in AXES))
        rig.close()
    return running


@pytest.fixture
def rig(emulator: EmulatorHandle) -> Iterator[CanopenRig]:
    rig = CanopenRig(rig_file_at(emulator.port), GEAR_RATIO)
    rig.connect()
    assert rig.identify().kind == "emulated"
    rig.configure()
    assert rig.without == ()
    yield rig
    rig.close()


def fault(emulator: EmulatorHandle, name: str, **how: object) -> None:
    assert emulator.control({"do": "fault", "name": name, **how})["ok"]


def tells(rig: CanopenRig, expected: Fault) -> bool:
    """Whether a fault is reported within some cycles."""
    turns(rig, lambda _: expected in [fault for fault, _ in rig.bus_faults()])
    return True


def test_torque_moves_the_motor_in_its_direction_and_the_link_follows(rig: CanopenRig) -> None:
    arm_both(rig)
    start = rig.exchange(0.0, 0.0)
    there = pushed(rig, lambda m: m.motor_position > start.motor_position + 0.05, motor=TORQUE)
    assert there.motor_torque == there.motor_torque_seen == pytest.approx(TORQUE, abs=0.05)
    assert there.link_position > start.link_position
    pushed(rig, lambda m: m.motor_position < start.motor_position, motor=-TORQUE)
    pushed(rig, lambda m: m.stiffness_position > start.stiffness_position + 0.5, stiffness=0.2)


def test_measured_positions_are_the_emulators_own(rig: CanopenRig, emulator: EmulatorHandle) -> None:
    arm_both(rig)
    rig.exchange(TORQUE, 0.0)
    measured, truth = rig.exchange(TORQUE, 0.0), emulator.control({"do": "state"})
    assert measured.link_position == pytest.approx(truth["link_position"], abs=0.01)
    assert measured.motor_position == pytest.approx(truth["motor_position"], abs=0.01)


def test_a_silent_bus_is_an_age_that_counts_up(rig: CanopenRig, emulator: EmulatorHandle) -> None:
    arm_both(rig)
    fault(emulator, "link_lost")
    ages = []
    for _ in range(12):
        measured = rig.exchange(0.0, 0.0)
        ages.append(min(measured.link_age, measured.motor_age, measured.stiffness_age))
    assert ages == list(range(ages[0], ages[0] + 12))
    assert ages[0] <= 1


def test_a_drive_fault_latches_until_it_is_reset_and_nothing_arms_again(
    rig: CanopenRig, emulator: EmulatorHandle
) -> None:
    arm_both(rig)
    fault(emulator, "drive_fault", node=1, value=0x2310)
    assert tells(rig, MOTOR_DRIVE)
    turns(rig, lambda _: rig.axis("motor").words == "fault")
    assert rig.axis("motor").error_words == "0x2310 over-current"
    emulator.control({"do": "clear"})
    rig.arm("motor")
    for _ in range(50):
        rig.exchange(TORQUE, 0.0)
        assert rig.axis("motor").state == "fault"
    rig.reset("motor")
    turns(rig, lambda _: rig.axis("motor").state == "disabled")
    for _ in range(50):
        rig.exchange(TORQUE, 0.0)
        assert rig.axis("motor").state == "disabled"
    assert rig.axis("motor").error_code == 0
    rig.arm("motor")
    turns(rig, lambda _: rig.axis("motor").state == "enabled")


def test_a_reset_while_the_cause_stands_does_nothing(rig: CanopenRig, emulator: EmulatorHandle) -> None:
    arm_both(rig)
    fault(emulator, "over_temperature", node=2)
    assert tells(rig, HOT)
    turns(rig, lambda _: rig.axis("stiffness").words == "fault")
    rig.reset("stiffness")
    for _ in range(50):
        rig.exchange(0.0, 0.0)
    assert rig.axis("stiffness").state == "fault"


@pytest.mark.parametrize(("name", "expected"), [("bus_off", BUS_OFF), ("node_reboot", REBOOTED)])
def test_bus_off_and_a_restarted_node_are_told(
    name: str, expected: Fault, rig: CanopenRig, emulator: EmulatorHandle
) -> None:
    arm_both(rig)
    fault(emulator, name)
    assert tells(rig, expected)


def test_the_drives_quick_stop_lets_the_motor_go_and_keeps_the_stiffness_axis(rig: CanopenRig) -> None:
    arm_both(rig)
    turns(rig, lambda m: m.motor_torque_seen > 0.5 * TORQUE, motor=TORQUE)
    for axis in AXES:
        rig.stop(axis)
    turns(rig, lambda _: rig.axis("motor").state == "disabled")
    assert rig.axis("stiffness").words == "quick stop active"


def test_drives_stop_by_themselves_when_the_client_is_killed(emulator: EmulatorHandle) -> None:
    emulator.control({"do": "watch"})
    client = subprocess.Popen(
        [sys.executable, "-m", "tests.hardware.armed_client", str(emulator.port)],
        stdout=subprocess.PIPE,
        cwd=Path(__file__).parents[2],
    )
    try:
        assert client.stdout is not None
        assert client.stdout.readline() == b"pushing\n"
        assert emulator.control({"do": "peaks"})["peak_motor_torque"] > 0.5 * TORQUE
    finally:
        client.kill()
        client.communicate()
    ended = {"motor": "switch on disabled", "stiffness": "quick stop active"}

    def stands() -> bool:
        state = emulator.control({"do": "state"})
        return state["states"] == ended and abs(state["motor_torque"]) < 1e-6 and abs(state["motor_velocity"]) < 0.1

    until(stands)
    again = CanopenRig(rig_file_at(emulator.port), GEAR_RATIO)
    again.connect()
    again.configure()
    for _ in range(50):
        again.exchange(0.0, 0.0)
    assert emulator.control({"do": "state"})["states"] == ended, "the stiffness axis is not let go by connecting"
    again.close()


def test_a_quiet_end_leaves_no_fault_behind(rig: CanopenRig, emulator: EmulatorHandle) -> None:
    arm_both(rig)
    rig.close()
    state = emulator.control({"do": "state"})
    assert set(state["states"].values()) == {"switch on disabled"}
    later = CanopenRig(rig_file_at(emulator.port), GEAR_RATIO)
    later.connect()
    later.configure()
    turns(later, lambda m: max(m.motor_age, m.stiffness_age) == 0)
    assert [later.axis(axis).error_code for axis in AXES] == [0, 0]
    assert later.bus_faults() == ()
    later.close()


def test_a_check_finds_the_emulator_as_its_file_says_and_changes_nothing(emulator: EmulatorHandle) -> None:
    before = emulator.control({"do": "state"})["nodes"]
    lines = check_rig(rig_file_at(emulator.port), GEAR_RATIO)
    assert [line for line in lines if not line["ok"]] == []
    assert {"nodes", "motor drive, node 1: rated torque", "link position"} <= {line["what"] for line in lines}
    assert emulator.control({"do": "state"})["nodes"] == before


def test_the_command_ends_with_1_where_something_differs(emulator: EmulatorHandle, tmp_path: Path) -> None:
    text = (Path(__file__).parents[2] / "backend" / "rigs" / "emulator.toml").read_text("utf-8")
    file = tmp_path / "here.toml"
    file.write_text(text.replace("29536", str(emulator.port)))
    found = CliRunner().invoke(app, ["rig", "check", str(file)])
    assert (found.exit_code, "The rig is as its file says." in found.stdout) == (0, True)
    file.write_text(file.read_text().replace("node = 2\n", "node = 2\nserial = 5\n"))
    found = CliRunner().invoke(app, ["rig", "check", str(file)])
    assert found.exit_code == 1
    assert "The stiffness drive is another device" in found.stdout
