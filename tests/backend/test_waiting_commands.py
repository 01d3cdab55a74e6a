"""A command that waits, for its turn or for a design, takes no effect if who gave it lost control of the rig meanwhile."""

import asyncio
from pathlib import Path
from typing import Any

import pytest

from backend.problem import Problem
from tests.backend.rig_bench import RigBench, at_rig

WAITING: dict[str, dict[str, Any]] = {
    "tune": {"changes": {"observer.bandwidth": 90.0}}, "set_stiffness": {"changes": {"stiffness": 300.0}},
    "set_reference": {"replace": {"kind": "sine", "amplitude": 0.2, "frequency_hz": 0.5, "offset": 0.312}},
    "set_disturbances": {"replace": {"motor": [{"kind": "constant", "torque": 1.0}]}},
    "apply_preset": {"name": "other"}, "undo": {}, "redo": {}, "return_to": {}, "reset": {},
}  # fmt: skip
DESIGNED = ("tune", "set_stiffness", "apply_preset", "undo", "redo", "return_to")


async def with_a_past(bench: RigBench) -> None:
    """A rig that is armed, with changes to undo, to redo and to return from, and another preset."""
    await bench.ask("tune", changes={"observer.bandwidth": 80.0})
    await bench.ask("save_preset", name="other")
    await bench.ask("tune", changes={"observer.bandwidth": 100.0})
    await bench.to("armed")
    for bandwidth in (95.0, 85.0, 75.0):
        await bench.ask("tune", changes={"observer.bandwidth": bandwidth})
        bench.clock.now += 0.1
        await bench.ask("renew_control")
        await bench.ask("save_point")  # each change an entry of its own
    await bench.ask("undo")


async def give(bench: RigBench, command: str) -> None:
    start = {"number": bench.session.history.last(100)[0]["number"]} if command == "return_to" else {}
    await bench.ask(command, **WAITING[command], **start)


async def nothing_came_of(bench: RigBench, asked: "asyncio.Task[Any]", before: tuple[Any, ...]) -> None:
    with pytest.raises(Problem, match="page 2 is in control") as refusal:
        await asked
    assert (refusal.value.status, refusal.value.title) == (403, "Not in control")
    assert as_it_is(bench) == before


def as_it_is(bench: RigBench) -> tuple[Any, ...]:
    session = bench.session
    return session.scenario, session.status.tuning_id, len(bench.rig.asked), session.history.last(1), session.preset


@pytest.mark.parametrize("command", WAITING)
def test_control_that_is_lost_before_its_turn_comes_refuses_a_command(data_dir: Path, command: str) -> None:
    async def work(bench: RigBench) -> None:
        await with_a_past(bench)
        before = as_it_is(bench)
        await bench.session.turn.acquire()
        asked = asyncio.create_task(give(bench, command))
        for _ in range(20):  # it was permitted, and waits for its turn
            await asyncio.sleep(0)
        await bench.ask("hand_control", to="page 2")
        bench.session.turn.release()
        await nothing_came_of(bench, asked, before)

    at_rig(data_dir, work)


@pytest.mark.parametrize("command", DESIGNED)
def test_control_that_is_lost_while_a_design_is_computed_refuses_a_command(data_dir: Path, command: str) -> None:
    async def work(bench: RigBench) -> None:
        await with_a_past(bench)
        before, compute = as_it_is(bench), bench.session.design.run

        async def slowly(*arguments: Any, **options: Any) -> Any:
            if bench.snapshot()["control"]["operator"] == "page 1":
                await bench.ask("hand_control", to="page 2")
            return await compute(*arguments, **options)

        bench.session.design.run = slowly  # type: ignore[method-assign]
        await nothing_came_of(bench, asyncio.create_task(give(bench, command)), before)

    at_rig(data_dir, work)


@pytest.mark.parametrize("command", WAITING)
def test_who_keeps_control_has_the_command_carried_out_after_the_wait(data_dir: Path, command: str) -> None:
    async def work(bench: RigBench) -> None:
        await with_a_past(bench)
        asked = len(bench.rig.asked)
        async with bench.session.turn:
            waiting = asyncio.create_task(give(bench, command))
            await asyncio.sleep(0)
        await waiting
        assert len(bench.rig.asked) > asked

    at_rig(data_dir, work)
