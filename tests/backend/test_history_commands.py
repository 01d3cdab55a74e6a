"""Undo, redo, save points and returns in a session that runs: whole parts, checked as any change, one history for all."""

import asyncio
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from backend.problem import Problem
from backend.session.journal import Change
from tests.backend.session_bench import SessionBench, on_bench
from vssea_core.scenario import Scenario, TimedChange
from vssea_core.scenarios import NOMINAL, REALISTIC

CHANGES: list[tuple[str, dict[str, Any]]] = [
    ("tune", {"changes": {"observer.bandwidth": 150.0}}),
    ("tune", {"changes": {"observer.kind": "velocity"}}),
    ("tune", {"changes": {"controller.kind": "sliding_mode"}}),
    ("tune", {"changes": {"controller.natural_frequency": 15.0}}),
    ("set_reference", {"replace": {"kind": "move", "target": 0.7}}),
    ("set_reference", {"changes": {"kind": "step"}}),
    ("set_stiffness", {"changes": {"stiffness": 300.0}}),
    ("set_disturbances", {"replace": {"link": [{"kind": "constant", "torque": 1.0}]}}),
    ("load_scenario", {"name": "realistic"}),
]


def at_bench(folder: Path, work: Any, scenario: Scenario = NOMINAL) -> None:
    async def run() -> None:
        async with on_bench(folder, scenario) as bench:
            await work(bench)

    asyncio.run(run())


def listed(bench: SessionBench) -> list[dict[str, Any]]:
    return bench.session.history.last(200)


def bandwidth(bench: SessionBench) -> float:
    return float(bench.session.scenario.tuning.observer.bandwidth)  # type: ignore[union-attr]


@settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(st.sampled_from(CHANGES), max_size=6))
def test_undo_walks_back_through_every_state_and_redo_forth_again(
    data_dir: Path, made: list[tuple[str, dict[str, Any]]]
) -> None:
    async def work(bench: SessionBench) -> None:
        states = [bench.session.scenario]
        for number, (command, arguments) in enumerate(made):
            try:
                await bench.ask(command, by=f"page {number}", **arguments)  # each by another page: no drag
            except Problem:
                continue
            if bench.session.scenario != states[-1]:
                states.append(bench.session.scenario)
        assert len(listed(bench)) == len(states) - 1
        for state in states[-2::-1]:
            await bench.ask("undo")
            assert bench.session.scenario == state
        with pytest.raises(Problem, match="nothing to undo"):
            await bench.ask("undo")
        for state in states[1:]:
            await bench.ask("redo")
            assert bench.session.scenario == state
        with pytest.raises(Problem, match="nothing to redo"):
            await bench.ask("redo")

    at_bench(data_dir, work)


def test_an_undo_says_whose_change_it_took_back(data_dir: Path) -> None:
    async def work(bench: SessionBench) -> None:
        await bench.ask("tune", by="page 2", changes={"observer.bandwidth": 150.0})
        answer = await bench.ask("undo", by="page 1")
        assert (answer["by"], answer["words"]) == ("page 2", ["g 100 → 150 rad/s"])
        event = bench.told_of("event")[-1]["event"]
        assert (event["text"], event["by"], event["kind"]) == (
            "took back the change of page 2: g 100 → 150 rad/s", "page 1", "tuning",
        )  # fmt: skip
        assert bandwidth(bench) == 100.0

    at_bench(data_dir, work)


def test_undo_is_a_change_as_any_other_to_loop_journal_and_pages(data_dir: Path) -> None:
    async def work(bench: SessionBench) -> None:
        first = await bench.ask("tune", changes={"observer.bandwidth": 150.0})
        await bench.turns(3)
        written = bench.session.ring.written
        answer = await bench.ask("undo")
        change = bench.diary.of(Change)[-1]
        assert answer["tuning_id"] == change.tuning_id == first["tuning_id"] + 1
        assert change.at_s == bench.session.ring.since(written).samples[0, 0]
        assert change.changes == {"observer.bandwidth": 100.0}
        document = bench.told_of("document")[-1]
        assert document["scenario"]["tuning"]["observer"]["bandwidth"] == 100.0
        message = bench.told_of("history")[-1]
        assert [entry["undone"] for entry in message["entries"]] == [True]
        assert (message["can_undo"], message["can_redo"]) == (False, True)

    at_bench(data_dir, work)


def test_an_undo_that_is_refused_changes_nothing(data_dir: Path) -> None:
    async def work(bench: SessionBench) -> None:
        await bench.ask("set_stiffness", by="page 1", changes={"stiffness": 300.0})
        before = (listed(bench), bench.session.scenario, bench.session.status.tuning_id)

        async def refuse(*_: Any, **__: Any) -> Any:
            raise Problem(503, "Not computed", "The tuning could not be computed.")

        bench.session.design.run = refuse  # type: ignore[method-assign]
        with pytest.raises(Problem, match="could not be computed"):
            await bench.ask("undo")
        assert (listed(bench), bench.session.scenario, bench.session.status.tuning_id) == before

    at_bench(data_dir, work)


def test_a_return_is_one_change_over_all_parts_and_can_be_undone(data_dir: Path) -> None:
    async def work(bench: SessionBench) -> None:
        saved = await bench.ask("save_point", name="good")
        good = bench.session.scenario
        for number, (command, arguments) in enumerate([*CHANGES[:3], *CHANGES[4:8]]):
            await bench.ask(command, by=f"page {number}", **arguments)
        bad = bench.session.scenario
        entries = len(listed(bench))
        epoch = bench.session.status.epoch
        await bench.ask("return_to", number=saved["number"])
        assert bench.session.scenario == good
        assert bench.session.status.epoch == epoch  # time goes on
        assert len(listed(bench)) == entries + 1
        assert (listed(bench)[-1]["part"], listed(bench)[-1]["undone"]) == ("scenario", False)
        await bench.ask("undo")
        assert bench.session.scenario == bad

    at_bench(data_dir, work)


def test_a_return_leads_to_the_state_after_any_entry_also_an_undone_one(data_dir: Path) -> None:
    async def work(bench: SessionBench) -> None:
        for number, value in enumerate((110.0, 120.0, 130.0)):
            await bench.ask("tune", by=f"page {number}", changes={"observer.bandwidth": value})
        await bench.ask("undo")
        await bench.ask("undo")
        await bench.ask("return_to", number=3)
        assert bandwidth(bench) == 130.0
        await bench.ask("return_to", number=1)
        assert bandwidth(bench) == 110.0
        assert [entry["changes"] for entry in listed(bench)[-2:]] == [
            {"observer.bandwidth": [110.0, 130.0]}, {"observer.bandwidth": [130.0, 110.0]},
        ]  # fmt: skip
        with pytest.raises(Problem, match="There is no entry 99"):
            await bench.ask("return_to", number=99)

    at_bench(data_dir, work)


def test_undo_crosses_the_load_of_another_scenario(data_dir: Path) -> None:
    async def work(bench: SessionBench) -> None:
        await bench.ask("tune", changes={"observer.bandwidth": 150.0})
        tuned, epoch = bench.session.scenario, bench.session.status.epoch
        await bench.ask("load_scenario", name="realistic")
        assert listed(bench)[-1]["words"] == ["scenario nominal → realistic"]
        await bench.ask("undo")
        assert bench.session.scenario == tuned
        assert bench.session.status.epoch == epoch + 2
        await bench.ask("undo")
        assert bench.session.scenario == NOMINAL
        await bench.ask("redo")
        await bench.ask("redo")
        assert bench.session.scenario == REALISTIC

    at_bench(data_dir, work)


def test_an_edited_rig_is_an_entry_with_its_fields_in_words(data_dir: Path) -> None:
    async def work(bench: SessionBench) -> None:
        document = NOMINAL.model_dump(mode="json")
        document["actuator"]["link"]["inertia"] = 0.2
        await bench.ask("load_scenario", scenario=document)
        (entry,) = listed(bench)
        assert entry["changes"] == {"actuator.link.inertia": [0.1, 0.2]}
        assert "0.1 → 0.2 kg·m²" in entry["words"][0]
        await bench.ask("undo")
        assert bench.session.scenario == NOMINAL

    at_bench(data_dir, work)


def test_a_scenario_loaded_as_it_is_is_no_change(data_dir: Path) -> None:
    async def work(bench: SessionBench) -> None:
        await bench.ask("load_scenario", name="nominal")
        assert listed(bench) == []

    at_bench(data_dir, work)


def test_what_the_sequence_changes_is_not_in_the_history_and_a_reset_keeps_it(data_dir: Path) -> None:
    sequence = (TimedChange(at_s=0.005, changes={"stiffness_reference.stiffness": 400.0}),)

    async def work(bench: SessionBench) -> None:
        await bench.ask("tune", changes={"observer.bandwidth": 150.0})
        await bench.turns(20)
        assert [entry["part"] for entry in listed(bench)] == ["tuning"]
        await bench.ask("reset")
        await bench.ask("undo")
        assert bench.session.scenario.tuning == NOMINAL.tuning
        await bench.ask("reset")
        assert bench.session.scenario.tuning == NOMINAL.tuning

    at_bench(data_dir, work, NOMINAL.model_copy(update={"sequence": sequence}))
