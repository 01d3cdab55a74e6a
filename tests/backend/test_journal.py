"""What a session tells its journal: every run, change, command and event, in the order in which they happen."""

import asyncio
import logging
from pathlib import Path
from typing import Any

import pytest

from backend.problem import Problem
from backend.session.events import Event
from backend.session.journal import Change, Run, Told
from tests.backend.session_bench import Diary, SessionBench, on_bench
from vssea_core.scenario import Scenario, TimedChange
from vssea_core.scenarios import NOMINAL

SEQUENCE = NOMINAL.model_copy(
    update={
        "sequence": (
            TimedChange(at_s=0.0, changes={"tuning.observer.bandwidth": 150.0}),
            TimedChange(at_s=0.02, changes={"stiffness_reference.stiffness": 400.0, "reference.kind": "move"}),
        )
    }
)


def at_bench(folder: Path, work: Any, scenario: Scenario = NOMINAL, **options: Any) -> Any:
    async def run() -> Any:
        async with on_bench(folder, scenario, **options) as bench:
            return await work(bench)

    return asyncio.run(run())


def test_a_run_is_told_with_its_epoch_and_the_scenario_as_it_stands_at_its_beginning(data_dir: Path) -> None:
    async def work(bench: SessionBench) -> None:
        (first,) = bench.diary.of(Run)
        assert (first.epoch, first.scenario, first.tuning_id) == (bench.session.status.epoch, NOMINAL, 1)
        await bench.ask("tune", changes={"observer.bandwidth": 150.0})
        await bench.ask("reset")
        again = bench.diary.of(Run)[-1]
        assert again.epoch == first.epoch + 1
        assert again.scenario.tuning.observer.bandwidth == 150.0  # type: ignore[union-attr]
        assert again.tuning_id == bench.session.status.tuning_id
        await bench.ask("load_scenario", name="realistic")
        assert (bench.diary.of(Run)[-1].epoch, bench.diary.of(Run)[-1].scenario.name) == (first.epoch + 2, "realistic")

    at_bench(data_dir, work)


def test_a_change_is_told_with_the_time_of_the_first_sample_that_it_makes(data_dir: Path) -> None:
    async def work(bench: SessionBench) -> None:
        await bench.turns(20)
        written = bench.session.ring.written
        answer = await bench.ask("tune", changes={"observer.bandwidth": 150.0})
        (change,) = bench.diary.of(Change)
        samples = bench.session.ring.since(written).samples
        assert change.at_s == samples[0, 0]
        assert change.tuning_id == answer["tuning_id"]
        assert (change.by, change.part, change.changes) == ("page 1", "tuning", {"observer.bandwidth": 150.0})
        assert change.words == ("g 100 → 150 rad/s",)
        assert change.document == bench.session.scenario.tuning.model_dump(mode="json")

    at_bench(data_dir, work)


def test_what_the_sequence_changes_is_told_part_by_part_after_its_run_began(data_dir: Path) -> None:
    async def work(bench: SessionBench) -> None:
        await bench.turns(30)
        run, *changes = [entry for entry in bench.diary.heard if isinstance(entry, Run | Change)]
        assert isinstance(run, Run)
        assert run.scenario == SEQUENCE
        assert [(c.at_s, c.by, c.part, c.epoch) for c in changes if isinstance(c, Change)] == [
            (0.0, "sequence", "tuning", run.epoch),
            (0.02, "sequence", "stiffness_reference", run.epoch),
            (0.02, "sequence", "reference", run.epoch),
        ]
        await bench.ask("reset")
        assert bench.diary.of(Run)[-1].scenario == SEQUENCE

    at_bench(data_dir, work, SEQUENCE)


def test_a_refused_command_is_told_with_its_reason_and_changes_nothing(data_dir: Path) -> None:
    async def work(bench: SessionBench) -> None:
        for name, arguments in (("tune", {"changes": {"observer.bandwidth": 1e9}}), ("fly", {}), ("step", {})):
            with pytest.raises(Problem) as problem:
                await bench.ask(name, **arguments)
            told = bench.diary.of(Told)[-1]
            assert (told.command, told.arguments, told.by, told.ok) == (name, arguments, "page 1", False)
            assert told.problem == problem.value.detail
        assert bench.diary.of(Change) == []

    at_bench(data_dir, work)


def test_a_stop_is_told_too(data_dir: Path) -> None:
    async def work(bench: SessionBench) -> None:
        await bench.turns(5)
        await bench.ask("stop", by="page 7")
        (told,) = bench.diary.of(Told)
        assert (told.command, told.by, told.ok, told.epoch) == ("stop", "page 7", True, bench.session.status.epoch)
        assert told.at_s == pytest.approx(0.005, abs=1e-9)

    at_bench(data_dir, work)


def test_the_journal_hears_every_event_that_pages_hear(data_dir: Path) -> None:
    async def work(bench: SessionBench) -> None:
        await bench.ask("pause")
        await bench.ask("reset")
        told = [message["event"] for message in bench.told_of("event")]
        assert [event.document() for event in bench.diary.of(Event)][-len(told) :] == told
        assert told

    at_bench(data_dir, work)


def test_a_journal_that_fails_harms_nothing(data_dir: Path, caplog: pytest.LogCaptureFixture) -> None:
    class Broken(Diary):
        def __init__(self) -> None:
            super().__init__()
            self.begin = self.change = self.command = self.event = self.fail  # type: ignore[assignment]

        def fail(self, what: Any) -> None:
            raise OSError("disk full")

    async def work(bench: SessionBench) -> None:
        await bench.ask("tune", changes={"observer.bandwidth": 150.0})
        assert bench.session.scenario.tuning.observer.bandwidth == 150.0  # type: ignore[union-attr]

    with caplog.at_level(logging.CRITICAL):
        at_bench(data_dir, work, journal=Broken())
