"""The scene process, and its keeper in the web process.

viser runs on its own, as its bursts of work must never delay the web process, through which STOP passes. The two share
a pipe: the port travels over it, and its end tells the scene to leave. Poses come from the telemetry ring.
"""

import asyncio
import io
import logging
import multiprocessing
import signal
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import TYPE_CHECKING, Final

from backend.processes import name_this_process, set_niceness

if TYPE_CHECKING:
    from backend.scene.actuator_scene import ScenePose

FRAME_S: Final = 1.0 / 30.0
IDLE_S: Final = 0.2
"""How often the scene looks for a first visitor."""
WATCH_S: Final = 0.25
"""How often the keeper looks after the process."""
START_LIMIT_S: Final = 60.0
RESTART_PAUSES_S: Final = (1.0, 5.0, 20.0)
"""Pauses before the first, second, ... restart; after the last one it stays off."""
PROVEN_S: Final = 120.0
"""A scene that ran this long has its restarts back."""

logger = logging.getLogger(__name__)


def run_scene(ring_name: str, port_sender: Connection) -> None:
    """Entry of the scene process: serve the scene and follow the ring until the keeper's end of the pipe closes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl+C is the keeper's to handle
    name_this_process("vssea scene")
    set_niceness(5)  # pictures give way to the control loop
    sys.stdout = io.StringIO()  # viser prints a banner, with an address that is not for visitors
    import viser

    from backend.scene.actuator_scene import ActuatorScene

    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    scene = ActuatorScene(server)
    latest = _pose_source(ring_name)
    try:
        with suppress(BrokenPipeError):  # the keeper has already left: follow sees it too
            port_sender.send(server.get_port())
        follow(latest, scene.update, lambda: bool(server.get_clients()), port_sender)
    finally:
        server.stop()


def follow(
    latest: "Callable[[], ScenePose | None]",
    show: "Callable[[ScenePose], None]",
    has_visitors: Callable[[], bool],
    pipe: Connection,
) -> None:
    """Show the newest pose 30 times a second while somebody watches, until the pipe's other end closes."""
    due = time.monotonic()
    while True:
        pose = latest() if has_visitors() else None
        if pose is not None:
            show(pose)
        now = time.monotonic()
        due = max(due + (IDLE_S if pose is None else FRAME_S), now)
        if pipe.poll(due - now):
            return  # the keeper sends nothing: readable means closed


def _pose_source(ring_name: str) -> "Callable[[], ScenePose | None]":
    """A reader of the newest pose in a telemetry ring."""
    from backend.scene.actuator_scene import ScenePose
    from backend.telemetry.ring import RingReader
    from vssea_core.channels import INDEX

    reader = RingReader(ring_name)
    columns = [INDEX[name] for name in ScenePose.__dataclass_fields__]

    def latest() -> ScenePose | None:
        row = reader.latest()
        return None if row is None else ScenePose(*(float(row[column]) for column in columns))

    return latest


class SceneProcess:
    """Keeps a scene process running, without ever disturbing the session.

    Parameters
    ----------
    ring_name : name of the telemetry ring that the scene follows.
    target : entry of the process; takes the ring's name and its end of the pipe.
    restart_pauses_s : pause before each restart, in seconds; their number is the number of restarts.
    """

    def __init__(
        self,
        ring_name: str,
        target: Callable[[str, Connection], None] = run_scene,
        restart_pauses_s: tuple[float, ...] = RESTART_PAUSES_S,
    ) -> None:
        self._ring_name = ring_name
        self._target = target
        self._pauses_s = restart_pauses_s
        self._keeper: asyncio.Task[None] | None = None
        self._port: int | None = None
        self._sentence = "The 3D scene is starting; it appears here in a moment."

    @property
    def port(self) -> int | None:
        """Port of the scene on 127.0.0.1; None while there is none."""
        return self._port

    @property
    def sentence(self) -> str:
        """What the scene is doing, for the place where it would be seen."""
        return self._sentence

    def start(self) -> None:
        """Start the process in the background; call it with an event loop running."""
        if self._keeper is None:
            self._keeper = asyncio.create_task(self._keep(), name="scene keeper")

    async def stop(self) -> None:
        """End the process and wait until it has ended."""
        if self._keeper is not None:
            self._keeper.cancel()
            await asyncio.wait([self._keeper])
            self._keeper = None

    async def _keep(self) -> None:
        failures = 0
        while True:
            started = time.monotonic()
            await self._run_once()
            failures = 1 if time.monotonic() - started > PROVEN_S else failures + 1
            if failures > len(self._pauses_s):
                self._sentence = "The 3D scene keeps failing and stays off; everything else works on. The log says why."
                logger.error("The scene process ended %d times in a row and is not started again.", failures)
                return
            pause = self._pauses_s[failures - 1]
            self._sentence = "The 3D scene ended unexpectedly and is starting again; everything else works on."
            logger.warning("The scene process ended unexpectedly; it is started again in %g s.", pause)
            await asyncio.sleep(pause)

    async def _run_once(self) -> None:
        """One life of the process, from start to end."""
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        process = context.Process(target=self._target, args=(self._ring_name, theirs), name="vssea scene", daemon=True)
        try:
            # Spawning takes some ms of system calls: not in the event loop.
            await asyncio.to_thread(process.start)
            theirs.close()
            deadline = time.monotonic() + START_LIMIT_S
            while process.is_alive():
                if self._port is None:
                    self._port = _received_port(ours)
                    if self._port is None and time.monotonic() > deadline:
                        logger.warning("The scene process did not answer within %g s.", START_LIMIT_S)
                        return
                await asyncio.sleep(WATCH_S)
        finally:
            self._port = None
            ours.close()
            await asyncio.shield(asyncio.to_thread(_end, process))


def _received_port(pipe: Connection) -> int | None:
    """The port, if the scene has sent it."""
    try:
        return int(pipe.recv()) if pipe.poll() else None
    except (EOFError, OSError):
        return None  # it died first, which the keeper sees next


def _end(process: BaseProcess) -> None:
    """Let the process leave, as its pipe has closed, and make it if it does not."""
    if process.pid is None:
        return
    for insist in (lambda: None, process.terminate, process.kill):
        insist()
        process.join(2.0)
        if process.exitcode is not None:
            break
    process.close()
