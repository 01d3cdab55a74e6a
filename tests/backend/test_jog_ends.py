"""A jog waits for nothing: whether the tuning fits where a stiffness jog can end is worked out beside it."""

import asyncio
from pathlib import Path
from typing import Any

import pytest

from backend.compute.pool import JobFailedError
from backend.loop import messages
from backend.problem import Problem
from tests.backend.rig_bench import RigBench, at_rig

FAST = {"controller.natural_frequency": 100.0, "observer.bandwidth": 100.0}
"""Unstable at 25 N m/rad, the low end of the rig's range."""


class Designs:
    """The design worker, which answers nothing while it is held back."""

    def __init__(self, bench: RigBench) -> None:
        self._compute, self.may_answer = bench.session.design.run, asyncio.Event()
        self.may_answer.set()
        self.fails = False
        self.asked = 0
        bench.session.design.run = self.run  # type: ignore[method-assign]

    async def run(self, job: str, *arguments: Any, **options: Any) -> Any:
        if job != "plan_run":
            return await self._compute(job, *arguments, **options)
        self.asked += 1
        await self.may_answer.wait()
        if self.fails:
            raise JobFailedError("the worker ended")
        return await self._compute(job, *arguments, **options)


async def refused(bench: RigBench, **velocity: float) -> Problem:
    with pytest.raises(Problem) as refusal:
        await bench.ask("jog", **velocity)
    return refusal.value


def test_a_stiffness_jog_that_could_end_where_the_tuning_is_unstable_is_refused_before_it_begins(
    data_dir: Path,
) -> None:
    async def work(bench: RigBench) -> None:
        await bench.to("armed")
        await bench.ask("tune", changes=FAST)
        await bench.passed(0.1)
        asked = len(bench.rig.asked)
        problem = await refused(bench, stiffness=-100.0)
        assert (problem.status, problem.title) == (409, "Cannot jog")
        assert "could end at 25 N·m/rad" in problem.detail
        assert "wait" not in problem.document()
        assert len(bench.rig.asked) == asked
        await bench.ask("jog", stiffness=100.0)
        assert isinstance(bench.rig.asked[-1], messages.Jog)

    at_rig(data_dir, work)


def test_both_ends_are_known_before_anybody_jogs_and_looked_at_once_a_tuning(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.to("armed")
        designs = Designs(bench)
        await bench.passed(1.0)
        assert designs.asked == 2
        await bench.ask("jog", stiffness=100.0)
        await bench.ask("jog", stiffness=-100.0)
        await bench.passed(1.0)
        assert designs.asked == 2
        await bench.ask("tune", changes={"observer.bandwidth": 90.0})
        await bench.passed(1.0)
        assert designs.asked == 2 + 1 + 2

    at_rig(data_dir, work)


def test_a_jog_is_refused_at_once_while_its_end_is_not_known_and_none_goes_out_afterwards(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.to("armed")
        designs, asked = Designs(bench), len(bench.rig.asked)
        designs.may_answer.clear()
        for _ in range(5):  # held: asked for anew every 100 ms, while the design is being computed
            problem = await refused(bench, stiffness=100.0)
            assert (problem.status, problem.document()["wait"]) == (409, True)
            assert "being checked at 900 N·m/rad" in problem.detail
            bench.clock.now += 0.1
            await bench.ask("renew_control")
        designs.may_answer.set()
        await bench.settled()
        assert len(bench.rig.asked) == asked  # let go of meanwhile: nothing of it is left
        await bench.ask("jog", stiffness=100.0)
        assert bench.rig.asked[-1] == messages.Jog(0.0, 100.0, bench.clock.now)

    at_rig(data_dir, work)


def test_a_jog_of_the_link_needs_no_design(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.to("armed")
        Designs(bench).may_answer.clear()
        await bench.ask("jog", link=0.2)
        assert bench.rig.asked[-1] == messages.Jog(0.2, 0.0, bench.clock.now)
        await bench.ask("jog")

    at_rig(data_dir, work)


def test_what_was_found_of_one_tuning_says_nothing_of_the_next(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.to("armed")
        await bench.passed(0.1)
        await bench.ask("jog", stiffness=-100.0)
        designs = Designs(bench)
        await bench.ask("tune", changes={"observer.bandwidth": 90.0})
        designs.may_answer.clear()
        assert (await refused(bench, stiffness=-100.0)).document()["wait"]
        tuned = asyncio.create_task(bench.ask("tune", changes=FAST))
        designs.may_answer.set()  # the newest counts, whichever was being looked at
        await tuned
        await bench.passed(0.1)
        assert "could end at 25 N·m/rad" in (await refused(bench, stiffness=-100.0)).detail

    at_rig(data_dir, work)


def test_an_end_that_could_not_be_worked_out_is_unknown_and_tried_again(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.to("armed")
        designs, asked = Designs(bench), len(bench.rig.asked)
        designs.fails = True
        await bench.passed(0.1)
        problem = await refused(bench, stiffness=100.0)
        assert "is unknown: The tuning could not be computed" in problem.detail
        assert "wait" not in problem.document()
        assert len(bench.rig.asked) == asked
        designs.fails = False
        await bench.settled()
        await bench.passed(0.1)
        await bench.ask("jog", stiffness=100.0)
        assert isinstance(bench.rig.asked[-1], messages.Jog)

    at_rig(data_dir, work)
