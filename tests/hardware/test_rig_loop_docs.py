"""docs/faults.md lists what backend/rigs/faults.py has, and its figures are the code's."""

import re
from pathlib import Path

from backend.loop import arming, freshness, latch, motion, reactions, rig_commands, rig_loop, stopping, watchdogs
from backend.rigs.faults import FAULTS

TEXT = (Path(__file__).parents[2] / "docs" / "faults.md").read_text("utf-8")


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


def test_the_figures_of_the_stop_are_those_of_the_code() -> None:
    figures = (
        (stopping.SLOW_RAD_S, 0.02), (stopping.SLOW_S, 0.02), (stopping.BRAKES_S, 0.6), (stopping.RAMP_S, 0.05),
        (stopping.UNLOADED_NM, 1.0), (stopping.UNLOADED_S, 0.1), (stopping.HOLDS_ON_S, 1.0), (latch.GONE_AFTER_S, 0.3),
        (watchdogs.LEASE_S, 0.4), (watchdogs.WEB_S, 0.25), (motion.JOG_LASTS_S, 0.3), (rig_commands.RESET_S, 1.5),
        (freshness.BRIDGED, 1), (freshness.STOPS, 3), (freshness.FAULTS, 10), (rig_loop.LATE_CYCLES, 10),
        (arming.BLEND_S, 0.1),
    )  # fmt: skip
    assert [code for code, _ in figures] == [told for _, told in figures]
    for words in (
        "below 0.02 rad/s for 20 ms",
        "after 0.6 s",
        "within 50 ms",
        "carries 1 N·m",
        "0.1 s",
        "0.3 s",
        "1.5 s",
    ):
        assert words in re.sub(r"\s+", " ", TEXT)
