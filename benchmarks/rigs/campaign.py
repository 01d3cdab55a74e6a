"""The fault campaign: every breakage in every activity, on an emulated rig; one line of figures each.

Time to safe torque and the peaks come from the emulated plant itself, not from what the control process believes.
`python -m benchmarks faults` prints the table; `python -m benchmarks faults --short` a part of it.
"""

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from backend.emulator.start import EmulatorHandle, start_emulator
from benchmarks.live_server import Server, running_server
from benchmarks.rigs.activities import ACTIVITIES
from benchmarks.rigs.breakages import BREAKAGES, Breakage, Case
from benchmarks.rigs.emulated import armed, introduce
from benchmarks.rigs.line import Line
from benchmarks.rigs.operator import Operator

WATCH_S = 3.0
"""How long a case is watched after it broke: every reaction promised is done by then."""


@dataclass(frozen=True)
class Outcome:
    """What became of one case; `safe_after_s` is None while torque is given."""

    breakage: str
    activity: str
    safe_after_s: float | None
    peak_link_velocity: float
    peak_deflection: float
    state: str
    sentence: str
    re_armed: bool

    @property
    def row(self) -> str:
        """Return one line of the table."""
        safe = "none" if self.safe_after_s is None else f"{1e3 * self.safe_after_s:7.0f}"
        return (
            f"{self.breakage:26} {self.activity:19} {safe:>7} {self.peak_link_velocity:8.2f} {self.peak_deflection:8.3f}  "
            f"{'YES' if self.re_armed else 'no':3}  {self.state:9} {self.sentence}"
        )


HEADING = f"{'broken':26} {'while':19} {'ms':>7} {'rad/s':>8} {'rad':>8}  re-armed  final state"


def outcome(breakage: Breakage, activity: str, server: Server, emulator: EmulatorHandle) -> Outcome:
    """Arm, begin the activity, break it, watch, and return what happened."""
    line = Line(server.port)
    operator = Operator(line.port)
    try:
        armed(operator)
        ACTIVITIES[activity](operator)
        time.sleep(0.3)
        emulator.control({"do": "watch"})
        breakage.break_it(Case(emulator, server, line, operator))
        time.sleep(WATCH_S)
        peaks: dict[str, Any] = emulator.control({"do": "peaks"})
    finally:
        operator.close()
        line.close()
    state, sentence = _after(server) if breakage.server_survives else ("gone", "")
    return Outcome(
        breakage.name, activity, peaks["safe_after_s"], peaks["peak_link_velocity"], peaks["peak_deflection"],
        state, sentence, bool(peaks["re_enabled"]),
    )  # fmt: skip


def _after(server: Server) -> tuple[str, str]:
    snapshot = server.get("/api/session")
    return snapshot["state"], snapshot["sentence"]


@contextmanager
def fresh(rate_hz: int) -> Iterator[tuple[Server, EmulatorHandle]]:
    """Start a new emulator and a new server: no case inherits what another one broke."""
    emulator = start_emulator()
    try:
        with running_server(VSSEA_SCENE="false", VSSEA_RECORDING="false") as server:
            introduce(server, emulator, rate_hz)
            yield server, emulator
    finally:
        emulator.close()


def outcomes(breakages: tuple[Breakage, ...], activities: tuple[str, ...], rate_hz: int = 500) -> Iterator[Outcome]:
    """Yield what became of every case."""
    for breakage in breakages:
        for activity in activities:
            with fresh(rate_hz) as (server, emulator):
                yield outcome(breakage, activity, server, emulator)


def main() -> None:
    """Print the table, and how many cases ended with torque or armed themselves again."""
    short = "--short" in sys.argv
    breakages = BREAKAGES[::4] if short else BREAKAGES
    found = []
    print(HEADING)
    for each in outcomes(breakages, tuple(ACTIVITIES)[:: 2 if short else 1]):
        print(each.row, flush=True)
        found.append(each)
    harmless = {each.name for each in BREAKAGES if each.harmless}
    unsafe = [each for each in found if each.safe_after_s is None and each.breakage not in harmless]
    print(f"{len(found)} cases; armed again by itself: {sum(each.re_armed for each in found)}; "
          f"torque still given where it should not be: {len(unsafe)}")  # fmt: skip
