"""How a command is ended from outside: Ctrl+C, or SIGTERM as job schedulers send it. Only the first one is heard."""

import asyncio
import signal
from collections.abc import Coroutine
from types import FrameType
from typing import Any

ENDS = signal.SIGINT, signal.SIGTERM


class Ended(Exception):
    """The command was ended by a signal; `status` is its exit status."""

    def __init__(self, number: int) -> None:
        super().__init__(f"ended by signal {number}")
        self.status = 128 + number


def run_until_ended(work: Coroutine[Any, Any, None]) -> None:
    """Run a coroutine; the first signal cancels it. Raises Ended, and then no further signal is heard until the process ends."""
    heard: list[int] = []

    async def run() -> None:
        loop, task = asyncio.get_running_loop(), asyncio.ensure_future(work)

        def end(number: int, _: FrameType | None) -> None:
            heard.append(number)
            if len(heard) == 1:
                task.cancel()
                loop.call_soon_threadsafe(lambda: None)  # it may be asleep

        for number in before:
            signal.signal(number, end)
        await task

    # What is ignored, as by a shell in the background, stays ignored.
    before = {number: handler for number in ENDS if (handler := signal.getsignal(number)) is not signal.SIG_IGN}
    try:
        asyncio.run(run())
    except (asyncio.CancelledError, Exception) as error:
        if heard:  # whatever has come of it, such as workers that the same signal has ended
            before = dict.fromkeys(before, signal.SIG_IGN)  # the interpreter's own end would die of a further one
            raise Ended(heard[0]) from error
        raise
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
