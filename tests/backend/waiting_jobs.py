"""Jobs for tests of workers: one that goes on until it is ended, one that cannot be, and one that answers."""

import time

from backend.compute.worker import Progress

LONG = frozenset({"until_ended"})


def until_ended(progress: Progress) -> None:
    while progress(0.5):
        time.sleep(1e-3)


def for_ever() -> None:
    while True:
        time.sleep(60.0)


def answer(value: int) -> int:
    return value
