"""The control process of a rig, as a process: it starts, obeys, and leaves the rig in order on every way out."""

import os
import signal
from collections.abc import Iterator
from typing import Any

import pytest

from backend.loop import messages
from backend.loop.messages import Changed, Done, Ready
from backend.processes import CONTEXT, started
from backend.rigs.faults import PROCESS_ENDED
from backend.telemetry.beats import LEASE, WEB, Beats
from backend.telemetry.ring import EPOCH, Ring, RingReader
from backend.telemetry.stop_flag import StopFlag
from tests.hardware.rig_loop_bench import FILE, SCENARIO, prepared

pytestmark = pytest.mark.real_time

LIMIT_S = 300.0  # to compile on a busy machine


class Process:
    """A rig's control process, and the web process's ends."""

    def __init__(self) -> None:
        self.ring, self.flag, self.beats = Ring(), StopFlag(), Beats()
        self.reader = RingReader(self.ring.name)
        self.pipe, theirs = CONTEXT.Pipe()
        entry = "tests.hardware.rig_process_entry:run"
        self.process = started("vssea rig", entry, self.ring.name, self.flag.name, self.beats.name, 4, theirs)
        theirs.close()
        self.reports: list[Any] = []
        self.next(Ready)

    def next(self, kind: type, **fields: object) -> Any:
        """Wait for a report of this kind, keeping server and operator alive."""
        for _ in range(round(LIMIT_S / 0.05)):
            self.beats.beat(WEB)
            self.beats.beat(LEASE)
            while self.pipe.poll(0.05):
                self.reports.append(report := self.pipe.recv())
                if isinstance(report, kind) and all(getattr(report, name) == value for name, value in fields.items()):
                    return report
        raise AssertionError(f"no {kind.__name__} {fields} among {self.reports[-5:]}")

    def connect(self) -> None:
        self.pipe.send((1, messages.Connect(FILE, SCENARIO, prepared(SCENARIO.tuning), 1)))
        self.next(Done, number=1)

    def rest(self) -> list[Any]:
        """Everything that is reported until the process has ended."""
        try:
            while True:
                assert self.pipe.poll(LIMIT_S)
                self.reports.append(self.pipe.recv())
        except EOFError:
            self.process.join(LIMIT_S)
            return self.reports

    def close(self) -> None:
        if self.process.is_alive():
            self.process.kill()
        self.process.join(LIMIT_S)
        self.pipe.close()
        self.reader.close()
        for segment in (self.ring, self.flag, self.beats):
            segment.close()


@pytest.fixture
def process() -> Iterator[Process]:
    opened = Process()
    yield opened
    opened.close()


def test_it_connects_measures_and_is_ended_by_sigterm_in_order(process: Process) -> None:
    process.connect()
    process.pipe.send((2, messages.Home()))
    process.next(Changed, state="homing")
    assert process.process.pid is not None
    os.kill(process.process.pid, signal.SIGTERM)
    states = [report.state for report in process.rest() if isinstance(report, Changed)]
    assert states == ["connected", "homing", "stopping", "stopped"]
    assert PROCESS_ENDED.sentence() in [report.reason for report in process.reports if isinstance(report, Changed)]
    assert process.process.exitcode == 0
    assert process.reader.written > 10
    assert process.reader.latest()[EPOCH] == 5.0  # type: ignore[index]


def test_disconnect_is_answered_and_ends_it(process: Process) -> None:
    process.connect()
    process.pipe.send((2, messages.Disconnect()))
    assert isinstance(process.rest()[-1], Done)
    assert process.process.exitcode == 0
