"""docs/faults.md lists what backend/rigs/faults.py has, and its figures are the code's."""

import re
from pathlib import Path

from backend.loop import arming, freshness, latch, messages, reactions, rig_commands, rig_loop, stopping, watchdogs
from backend.rigs.faults import FAULTS, LEASE_EXPIRED, LOOP_LATE, WEB_SILENT
from backend.telemetry import beats

DOCS = Path(__file__).parents[2] / "docs"
TEXT = (DOCS / "faults.md").read_text("utf-8")
BRINGING_UP = (DOCS / "hardware.md").read_text("utf-8")


def test_every_fault_is_listed_with_its_name_cause_and_remedy() -> None:
    rows = [
        [cell.strip() for cell in line.split("|")[1:-1]] for line in TEXT.splitlines() if re.match(r"\| \d+ \|", line)
    ]
    assert [(int(row[0]), row[1].strip("`"), row[2], row[4]) for row in rows] == [tuple(fault) for fault in FAULTS]
    assert all(row[3].endswith(".") for row in rows)


def test_numbers_rise_and_names_differ() -> None:
    numbers = [fault.number for fault in FAULTS]
    assert numbers == sorted(set(numbers))
    assert len({fault.name for fault in FAULTS}) == len(FAULTS)


def test_what_is_said_to_unhome_or_to_last_until_reconnected_does() -> None:
    rows = {int(line.split("|")[1]): line for line in TEXT.splitlines() if re.match(r"\| \d+ \|", line)}
    assert {n for n, row in rows.items() if "not homed afterwards" in row} == {
        fault.number for fault in reactions.UNHOMES
    }
    until = {
        n for n, row in rows.items() if "until the rig is connected again" in row or "Refuses the connection" in row
    }
    assert until == latch.UNTIL_RECONNECTED
    quick = {fault.number: set(axes) for fault, axes in reactions.LOST.items()}
    told = {n: row for n, row in rows.items() if "quick stop" in row}
    assert set(told) == set(quick)
    assert {n for n, row in told.items() if "both axes" in row} == {n for n, axes in quick.items() if len(axes) == 2}


def ms(seconds: float) -> str:
    return f"{seconds * 1e3:g} ms"


def test_the_figures_of_stops_and_watches_are_those_of_the_code() -> None:
    told = re.sub(r"\s+", " ", TEXT)
    for words in (
        f"below {stopping.SLOW_RAD_S:g} rad/s for {ms(stopping.SLOW_S)}), after {stopping.BRAKES_S:g} s at the latest",
        f"torque goes to zero within {ms(stopping.RAMP_S)}",
        f"the spring carries {stopping.UNLOADED_NM:g} N·m or more",
        f"unloaded for {stopping.UNLOADED_S:g} s",
        f"{stopping.HOLDS_ON_S:g} s after the motor is off",
        f"while it is seen, and {latch.GONE_AFTER_S:g} s longer",
        f"to leave it, and has {rig_commands.RESET_S:g} s for that",
        f"| {ms(beats.LEASE_S)} of silence while homing, armed or running | stop {LEASE_EXPIRED.number} |",
        f"| {ms(watchdogs.WEB_S)} of silence while homing, armed or running | stop {WEB_SILENT.number} |",
        f"| {ms(messages.JOG_LASTS_S)} after its last renewal was sent |",
        f"| {freshness.BRIDGED} missed cycle |",
        f"| {freshness.STOPS} missed cycles | stop |",
        f"| {freshness.FAULTS} missed cycles | fault 1, 2, 3 or 4 |",
        f"missing for {freshness.STOPS} cycles",
        f"| {rig_loop.LATE_CYCLES} late cycles in a row while armed | fault {LOOP_LATE.number} |",
    ):
        assert words in told
    for fault in (fault for fault in FAULTS if fault.name.endswith("_silent") and fault != WEB_SILENT):
        assert f"for {freshness.FAULTS} cycles" in fault.cause
    assert f"{rig_loop.LATE_CYCLES} cycles in a row" in LOOP_LATE.cause
    assert ms(watchdogs.WEB_S) in WEB_SILENT.cause
    bringing_up = re.sub(r"\s+", " ", BRINGING_UP)
    assert f"the torque comes in over {ms(arming.BLEND_S)}" in bringing_up
    assert f"{ms(beats.LEASE_S)} after the last one the rig is stopped" in bringing_up
