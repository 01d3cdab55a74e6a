"""The emulator's process: one loop over sockets and deadlines."""

import gc
import logging
import selectors
import signal
import socket
import time
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import Any

from filelock import FileLock

from backend.emulator.answers import answer
from backend.emulator.can_interface import CanInterface
from backend.emulator.control_port import PORT, ControlPort
from backend.emulator.emulator import Emulator
from backend.emulator.faults import Faults
from backend.emulator.plant import DEFAULT_STIFFNESS, EmulatedPlant, default_actuator
from backend.emulator.socketcand import SocketcandServer
from backend.processes import ask_for_real_time
from vssea_core.actuator.parameters import Actuator
from vssea_core.compiled import cache_folder

TRIES = 20
"""Pairs of free ports that are looked for where any will do."""


@dataclass(frozen=True)
class Options:
    """How an emulator is started; `port` 0 takes any free one, and the control port is the next."""

    port: int = PORT
    interface: str = "socketcand"
    channel: str = "can0"
    actuator: Actuator | None = None  # None = the default one with dry friction and lag
    stiffness: float = DEFAULT_STIFFNESS
    stiffness_offset: float = 0.0


class Server:
    """An emulator with its bus and its control port."""

    def __init__(self, options: Options) -> None:
        actuator = options.actuator or default_actuator()
        _compile(actuator)
        self.selector = selectors.DefaultSelector()
        self._open(options)
        self.emulator = Emulator(actuator, self.bus.send, time.monotonic(), options.stiffness, options.stiffness_offset)
        self.faults = Faults(self.emulator, self.bus.send_error)
        self.ending = False

    def _open(self, options: Options) -> None:
        if options.interface != "socketcand":
            self.bus: SocketcandServer | CanInterface = CanInterface(
                options.interface, options.channel, self.selector, self._receive
            )
            self.control = ControlPort(options.port + 1 if options.port else 0, self.selector, self._answer)
            return
        for left in range(TRIES, 0, -1):
            bus = SocketcandServer(options.port, self.selector, self._receive)
            try:
                self.control = ControlPort(bus.port + 1, self.selector, self._answer)
            except OSError:
                bus.close()
                if options.port or left == 1:
                    raise
                continue
            self.bus = bus
            return

    @property
    def port(self) -> int:
        """The bus's port; the control port is the next."""
        return self.control.port - 1

    def _receive(self, can_id: int, data: bytes, arrived: float) -> None:
        self.emulator.receive(can_id, data, arrived)

    def _answer(self, request: dict[str, Any]) -> dict[str, Any]:
        self.emulator.advance(time.monotonic())
        return answer(self.emulator, self.faults, request)

    def run(self) -> None:
        """Serve until told to end."""
        emulator, flush, select, clock = self.emulator, self.bus.flush, self.selector.select, time.monotonic
        emulator.begin(clock())
        while not self.ending:
            for key, events in select(max(0.0, emulator.next_turn() - clock())):
                key.data(events)
            now = clock()
            if now >= emulator.next_turn():
                for key, events in select(0.0):  # after a stall, a deadline is judged by all that had come until then
                    key.data(events)
                emulator.turn(now)
            flush()

    def end(self, *_: object) -> None:
        """Leave `run` after its present turn."""
        self.ending = True

    def close(self) -> None:
        """Let all clients go."""
        self.bus.close()
        self.control.close()
        self.selector.close()


def _compile(actuator: Actuator) -> None:
    folder = cache_folder()
    folder.mkdir(parents=True, exist_ok=True)
    with FileLock(folder / "compiling.lock"):  # who comes second finds the machine code ready
        EmulatedPlant(actuator).advance(1e-3)


def run_emulator(options: Options, started: Callable[[int], None], pipe: Connection | None = None) -> None:
    """Serve until SIGINT, SIGTERM or the other end of `pipe` closes; `started` is told the port. Raises OSError."""
    server = Server(options)
    if pipe is not None:
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl+C is for the process that started this one to handle
        server.selector.register(pipe, selectors.EVENT_READ, server.end)
    else:
        signal.signal(signal.SIGINT, server.end)
    logging.getLogger("canopen").setLevel(logging.CRITICAL)  # what a host does wrong is the host's to tell
    started(server.port)
    signal.signal(signal.SIGTERM, server.end)
    wake, woken = socket.socketpair()
    woken.setblocking(False)
    signal.set_wakeup_fd(woken.fileno(), warn_on_full_buffer=False)  # a signal ends the waiting
    server.selector.register(wake, selectors.EVENT_READ, lambda _events: wake.recv(64))
    gc.collect()
    gc.freeze()
    ask_for_real_time()  # it stands for devices that have processors of their own
    try:
        server.run()
    finally:
        signal.set_wakeup_fd(-1)
        server.close()
        wake.close()
        woken.close()


def run_emulator_with(options: dict[str, Any], pipe: Connection) -> None:
    """Be the process of `start_emulator`: tell the pipe the port, or why there is none."""
    try:
        run_emulator(Options(**options), pipe.send, pipe)
    except OSError as error:
        pipe.send(str(error))
