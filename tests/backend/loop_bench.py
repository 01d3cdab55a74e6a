"""The control loop on a bench: an engine of its own, a ring, a flag, and a pipe whose other end is the test's."""

from collections import deque
from typing import Any

import numpy as np
from numpy.typing import NDArray

from backend.loop import messages
from backend.loop.control_loop import ControlLoop
from backend.loop.pacer import Pacer
from backend.telemetry.ring import EPOCH, Ring, RingReader, RingWriter
from backend.telemetry.stop_flag import StopFlag
from vssea_core.channels import INDEX
from vssea_core.control.prepared import prepare
from vssea_core.control.tuning import Tuning
from vssea_core.scenario import Scenario
from vssea_core.simulation.run import prepare_scenario


class Pipe:
    """The loop's end of a pipe; commands wait in `inbox`, reports end up in `outbox`."""

    def __init__(self) -> None:
        self.inbox: deque[Any] = deque()
        self.outbox: list[messages.Report] = []
        self.closed = False

    def poll(self) -> bool:
        return bool(self.inbox) or self.closed

    def recv(self) -> Any:
        if not self.inbox:
            raise EOFError
        return self.inbox.popleft()

    def send(self, report: messages.Report) -> None:
        if self.closed:
            raise BrokenPipeError
        self.outbox.append(report)


class Bench:
    """Drives one loop turn by turn; time is what the loop asked to sleep."""

    def __init__(self) -> None:
        self.ring, self.flag, self.pipe = Ring(), StopFlag(), Pipe()
        self.reader, self.writer = RingReader(self.ring.name), RingWriter(self.ring.name)
        self.slept_s = 0.0
        self.loop = self.new_loop()
        self._numbers = 0

    def new_loop(self) -> ControlLoop:
        return ControlLoop(self.writer, self.flag, self.pipe, Pacer(lambda: self.slept_s, lambda s: self.sleep(s)))  # type: ignore[arg-type]

    def sleep(self, duration_s: float) -> None:
        self.slept_s += duration_s

    def send(self, command: messages.Command) -> None:
        self._numbers += 1
        self.pipe.inbox.append((self._numbers, command))

    def ask(self, command: messages.Command) -> messages.Done | messages.Refused:
        """Send a command, turn once, and return the answer."""
        self.send(command)
        self.loop.turn()
        (answer,) = [r for r in self.pipe.outbox if getattr(r, "number", None) == self._numbers]
        assert isinstance(answer, messages.Done | messages.Refused)
        return answer

    def load(self, scenario: Scenario, run: bool = True) -> messages.Done | messages.Refused:
        return self.ask(messages.Load(scenario, prepare_scenario(scenario), 1, run))

    def turns(self, count: int) -> float:
        return sum(self.loop.turn() for _ in range(count))

    def channel(self, name: str) -> NDArray[np.float64]:
        """All samples so far of a channel."""
        return self.reader.since(0).samples[:, INDEX[name]]

    def epochs(self) -> NDArray[np.float64]:
        return self.reader.since(0).samples[:, EPOCH]

    def changes(self) -> list[messages.State]:
        return [report.state for report in self.pipe.outbox if isinstance(report, messages.Changed)]

    def reason(self) -> str | None:
        return [report for report in self.pipe.outbox if isinstance(report, messages.Changed)][-1].reason

    def close(self) -> None:
        self.reader.close()
        del self.writer.header, self.writer.samples
        self.writer._memory.close()
        self.ring.close()
        self.flag.close()


def prepared(scenario: Scenario, tuning: Tuning) -> NDArray[np.float64]:
    return prepare(tuning, scenario.timing.sample_time_s)
