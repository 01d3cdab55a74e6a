"""Changes by hand while a sequence runs: what the page says is what the loop runs, whatever came before and comes after."""

import asyncio
from collections.abc import Sequence
from pathlib import Path

import pytest

from tests.backend.session_bench import SessionBench, on_bench
from vssea_core.scenario import TimedChange
from vssea_core.scenarios import NOMINAL

SCENARIO = NOMINAL.model_copy(
    update={
        "sequence": (
            TimedChange(at_s=0.02, changes={"tuning.observer.bandwidth": 60.0}),
            TimedChange(at_s=0.06, changes={"stiffness_reference.stiffness": 220.0}),
            TimedChange(at_s=0.10, changes={"tuning.controller.natural_frequency": 15.0}),
        )
    }
)


@pytest.mark.parametrize("at", [(5,), (30,), (5, 30), (30, 80), (5, 30, 80, 105)])
def test_a_change_by_hand_holds_through_the_rest_of_the_sequence(tmp_path: Path, at: Sequence[int]) -> None:
    async def run() -> None:
        async with on_bench(tmp_path, SCENARIO) as bench:
            done = 0
            for number, samples in enumerate(at):
                await bench.turns(samples - done)
                done = samples
                await bench.ask("tune", changes={"observer.bandwidth": 120.0 + number})
                _agree(bench)
            await bench.turns(130 - done)
            _agree(bench)
            expected = 120.0 + len(at) - 1 if at[-1] > 20 else 60.0  # the sequence has the last word at its time
            assert bench.session.scenario.tuning.observer.bandwidth == expected
            assert bench.session.scenario.stiffness_reference.stiffness == 220.0

    asyncio.run(run())


def test_entries_are_told_once_and_by_their_own_place(tmp_path: Path) -> None:
    async def run() -> None:
        async with on_bench(tmp_path, SCENARIO) as bench:
            await bench.turns(30)
            await bench.ask("set_stiffness", changes={"stiffness": 210.0})
            await bench.turns(100)
            told = [
                message["event"]["text"] for message in bench.told_of("event") if message["event"]["kind"] == "sequence"
            ]
            assert told == ["g 100 → 60 rad/s", "k 210 → 220 N·m/rad", "p 20 → 15 rad/s"]

    asyncio.run(run())


def _agree(bench: SessionBench) -> None:
    loop = bench.link.loop._loop
    assert loop is not None
    for part in ("tuning", "reference", "stiffness_reference", "disturbances"):
        assert getattr(loop.scenario, part) == getattr(bench.session.scenario, part)
