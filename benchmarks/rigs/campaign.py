"""The fault campaign: every breakage in every activity, on an emulated rig; one line of figures each.

Time to safe torque and the peaks come from the emulated plant itself, not from what the control process believes.
`python -m benchmarks faults` prints the table, a quarter of an hour long.
"""

import time
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Any, Self

from backend.emulator.start import EmulatorHandle, start_emulator
from benchmarks.live_server import Server, running_server
from benchmarks.rigs.activities import ACTIVITIES
from benchmarks.rigs.breakages import BREAKAGES, Breakage, Case
from benchmarks.rigs.emulated import armed, introduce
from benchmarks.rigs.line import Line
from benchmarks.rigs.operator import Operator

WATCH_S = 2.5
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
    def unsafe(self) -> bool:
        """Whether torque is still given although the breakage is none that a rig may go on with."""
        harmless = any(each.harmless for each in BREAKAGES if each.name == self.breakage)
        return self.safe_after_s is None and not harmless

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


class Bench:
    """An emulator and a server that stay from case to case; what a case has killed is started anew."""

    def __init__(self, rate_hz: int) -> None:
        self._rate_hz = rate_hz
        self.emulator = start_emulator()
        self._stack = ExitStack()
        self.server = self._started()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()
        self.emulator.close()

    def _started(self) -> Server:
        server = self._stack.enter_context(running_server(VSSEA_SCENE="false", VSSEA_RECORDING="false"))
        introduce(server, self.emulator, self._rate_hz)
        return server

    def mended(self) -> tuple[Server, EmulatorHandle]:
        """Take back what the case before broke."""
        self.emulator.control({"do": "clear"})
        if self.server.process.poll() is not None:
            self._stack.close()
            self.server = self._started()
        return self.server, self.emulator


def outcomes(breakages: tuple[Breakage, ...], activities: tuple[str, ...], rate_hz: int = 500) -> Iterator[Outcome]:
    """Yield what became of every case."""
    with Bench(rate_hz) as bench:
        for breakage in breakages:
            for activity in activities:
                yield outcome(breakage, activity, *bench.mended())


def run(breakages: tuple[Breakage, ...], activities: tuple[str, ...], rate_hz: int = 500) -> list[Outcome]:
    """Print the table, and how many cases ended with torque or armed themselves again; return all cases."""
    print(f"{rate_hz} Hz; ms: until the motor's torque stays below 0.5 N m; peaks after the breakage")
    print(HEADING)
    found = []
    for each in outcomes(breakages, activities, rate_hz):
        print(each.row, flush=True)
        found.append(each)
    print(f"{len(found)} cases; armed again by itself: {sum(each.re_armed for each in found)}; "
          f"torque still given where it should not be: {sum(each.unsafe for each in found)}")  # fmt: skip
    return found


def main() -> None:
    """Run all of them."""
    run(BREAKAGES, tuple(ACTIVITIES))
