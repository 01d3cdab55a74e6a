"""Every way out of a rig ramps down, disables, then closes the bus."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from backend.loop import messages
from backend.loop.messages import Done
from tests.hardware.rig_loop_bench import RigBench


class Bug(Exception):
    """Something nobody thought of."""


@pytest.fixture
def bench() -> Iterator[RigBench]:
    opened = RigBench()
    opened.armed()
    opened.follow()
    opened.pass_s(0.8)
    yield opened
    opened.close()


def run_until(bench: RigBench, happens: Any, after: int = 5) -> None:
    """Run the loop by itself; after some turns something happens."""
    turn, count = bench.loop.turn, 0

    def counted(*arguments: Any) -> float:
        nonlocal count
        count += 1
        for which in (0, 1):
            bench.beats.beat(which)
        if count == after:
            happens()
        return turn(*arguments)

    bench.loop.turn = counted  # type: ignore[method-assign]
    bench.loop._pacer.restart()
    bench.loop.run()


def raise_bug() -> None:
    raise Bug


def lose_the_pipe(bench: RigBench) -> None:
    bench.pipe.closed = True


@pytest.mark.parametrize("way", ["signal", "pipe", "exception", "disconnect"])
def test_the_rig_is_ramped_down_disabled_and_closed(bench: RigBench, way: str) -> None:
    before, begun = len(bench.rig.asked), bench.now
    speed = bench.rig.plant.omega_e
    assert abs(bench.rig.asked[-1][0]) > 1.0
    if way == "exception":
        with pytest.raises(Bug):
            run_until(bench, raise_bug)
    else:
        happens = {
            "signal": bench.loop.end,
            "pipe": lambda: lose_the_pipe(bench),
            "disconnect": lambda: bench.send(messages.Disconnect()),
        }[way]
        run_until(bench, happens)
    asked = np.array(bench.rig.asked[before:])
    assert bench.rig.closed == 1
    assert bench.enabled() == []
    assert (asked[-1] == 0.0).all()
    assert np.abs(np.diff(asked[:, 0])).max() < 40.0
    assert bench.now - begun < 2.0
    if way != "exception":  # the orderly ways brake as STOP does
        assert abs(bench.rig.plant.omega_e) < abs(speed) / 5
        assert bench.loop.leaving


def test_disconnect_is_answered_when_the_bus_is_closed(bench: RigBench) -> None:
    number = bench.send(messages.Disconnect())
    closed_when_answered = []
    send = bench.pipe.send

    def noted(report: messages.Report) -> None:
        if isinstance(report, Done) and report.number == number:
            closed_when_answered.append(bench.rig.closed)
        send(report)

    bench.pipe.send = noted  # type: ignore[method-assign]
    bench.loop.run()
    assert closed_when_answered == [1]


def test_a_rig_under_load_is_left_within_two_seconds() -> None:
    bench = RigBench()
    try:
        bench.armed()
        bench.rig.spoiled = {"link_position": -0.05, "motor_position": 0.05}  # looks loaded for ever
        bench.turns(3)
        begun = bench.now
        run_until(bench, bench.loop.end, 1)
        assert bench.now - begun < 2.0
        assert bench.rig.closed == 1
        assert bench.enabled() == []
    finally:
        bench.close()


def test_a_loop_without_a_rig_just_ends() -> None:
    bench = RigBench()
    try:
        bench.pipe.closed = True
        bench.loop.run()
        assert bench.rig.closed == 0
    finally:
        bench.close()


def test_the_loop_counts_the_cycles_it_missed_and_leaves_them_out(bench: RigBench) -> None:
    slept = bench.sleep

    def slow(duration_s: float) -> None:
        slept(duration_s + 0.005)

    bench.loop._pacer._sleep = slow
    run_until(bench, bench.loop.end, 20)
    assert bench.reader.overruns >= 19 * 2
