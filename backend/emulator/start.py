"""Starting an emulator from a program: a process of its own that ends with the one that started it."""

from dataclasses import dataclass
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any

from backend.emulator.control_port import ask
from backend.processes import CONTEXT, started

START_S = 60.0  # compiling for the first time takes seconds
END_S = 5.0


@dataclass(frozen=True)
class EmulatorHandle:
    """A running emulator."""

    process: BaseProcess
    port: int
    pipe: Connection

    def control(self, request: dict[str, Any]) -> dict[str, Any]:
        """Ask the control port. Raises OSError."""
        return ask(self.port + 1, request)

    def close(self) -> None:
        """End the process."""
        self.pipe.close()
        self.process.join(END_S)
        if self.process.is_alive():
            self.process.kill()
            self.process.join(END_S)


def start_emulator(port: int = 0, **options: Any) -> EmulatorHandle:
    """Start an emulator on 127.0.0.1 and return it once it listens; 0 takes any free port. Raises OSError.

    `options` are those of process.Options.
    """
    ours, its = CONTEXT.Pipe()
    process = started("vssea-emulator", "backend.emulator.process:run_emulator_with", {"port": port, **options}, its)
    its.close()
    try:
        ready = ours.recv() if ours.poll(START_S) else "it did not come up in time"
    except EOFError:
        ready = "its process ended"
    if not isinstance(ready, int):
        ours.close()
        process.join(END_S)
        process.kill()
        raise OSError(f"the emulator cannot start: {ready}")
    return EmulatorHandle(process, ready, ours)
