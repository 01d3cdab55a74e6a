"""Pinned runs and the trigger of a session: what is kept, from when to when, and who is told."""

import asyncio
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from backend.problem import Problem
from backend.session.excerpt import Excerpt, ExcerptsInMemory
from backend.session.trigger_source import Arming
from tests.backend.session_bench import SessionBench, on_bench
from vssea_core.channels import INDEX
from vssea_core.scenario import Scenario
from vssea_core.scenarios import NOMINAL

AT_ONCE = NOMINAL.model_copy(update={"reference": NOMINAL.reference.model_copy(update={"fade_in_s": 0.0})})
LEVEL = {"kind": "level", "channel": "reference", "level": 0.001, "edge": "rising"}


class Recorded:
    def of_run(self, epoch: int) -> str | None:
        return f"run-{epoch}"


def at_bench(
    folder: Path, work: Callable[[SessionBench], Awaitable[None]], scenario: Scenario = AT_ONCE, **options: Any
) -> None:
    async def run() -> None:
        async with on_bench(folder, scenario, **({"recordings": Recorded()} | options)) as bench:
            await work(bench)

    asyncio.run(run())


async def watched(bench: SessionBench, turns: int, every: int = 50) -> None:
    """Turn the loop, looking every `every` samples as the session does ten times a second."""
    for _ in range(turns // every):
        await bench.turns(every)
        bench.session.trigger.watch()
        await settled(bench)


async def settled(bench: SessionBench) -> None:
    """Let what the session does beside, such as keeping a capture in a thread, come to its end."""
    await asyncio.sleep(0)
    while bench.session._tasks:
        await asyncio.gather(*bench.session._tasks, return_exceptions=True)
        await asyncio.sleep(0)


def pins(bench: SessionBench) -> list[dict[str, Any]]:
    return list(bench.session.pins.message()["pins"])


def trigger(bench: SessionBench) -> dict[str, Any]:
    return bench.session.trigger.message()


def test_a_pin_holds_the_last_seconds_of_the_run_with_their_figures(data_dir: Path) -> None:
    async def work(bench: SessionBench) -> None:
        await bench.turns(499)  # one was made by the load
        pin = await bench.ask("pin", by="page 2", seconds=0.2, label="slow")
        assert (pin["recording"], pin["kind"], pin["label"], pin["by"]) == ("run-1", "pin", "slow", "page 2")
        assert (pin["from_s"], pin["to_s"]) == (pytest.approx(0.299), pytest.approx(0.499))
        assert pin["period_s"] == 4.0
        error = bench.session.ring.since(299).samples[:, INDEX["error"]]
        assert pin["metrics"]["peak_error"] == np.abs(error).max()
        assert pins(bench) == [pin] == bench.told_of("pins")[-1]["pins"]

    at_bench(data_dir, work)


def test_a_span_before_now_can_be_pinned_and_one_after_cannot(data_dir: Path) -> None:
    async def work(bench: SessionBench) -> None:
        await bench.turns(499)
        pin = await bench.ask("pin", seconds=0.2, to_s=0.3)
        assert (pin["from_s"], pin["to_s"]) == (pytest.approx(0.1), 0.3)
        with pytest.raises(Problem, match="cannot be pinned up to"):
            await bench.ask("pin", seconds=0.2, to_s=0.6)

    at_bench(data_dir, work)


def test_a_pin_says_how_its_tuning_differs_from_the_one_before(data_dir: Path) -> None:
    async def work(bench: SessionBench) -> None:
        await bench.turns(50)
        first = await bench.ask("pin")
        await bench.ask("tune", changes={"observer.bandwidth": 150.0})
        second = await bench.ask("pin")
        assert (first["words"], second["words"]) == ((), ("g 100 → 150 rad/s",))
        assert second["label"] == "g 100 → 150 rad/s"

    at_bench(data_dir, work)


def test_pins_are_renamed_hidden_and_let_go(data_dir: Path) -> None:
    async def work(bench: SessionBench) -> None:
        await bench.turns(50)
        number = (await bench.ask("pin"))["id"]
        await bench.ask("change_pin", id=number, label="better")
        await bench.ask("change_pin", id=number, shown=False)
        assert [(pin["label"], pin["shown"]) for pin in pins(bench)] == [("better", False)]
        await bench.ask("unpin", id=number)
        assert pins(bench) == []
        for command in ("unpin", "change_pin"):
            with pytest.raises(Problem, match="no pinned run"):
                await bench.ask(command, id=number)

    at_bench(data_dir, work)


def test_pins_outlive_the_session(data_dir: Path) -> None:
    store = ExcerptsInMemory()

    async def pin(bench: SessionBench) -> None:
        await bench.turns(50)
        await bench.ask("pin", label="kept")

    async def look(bench: SessionBench) -> None:
        await bench.session.pins.load()
        assert [pin["label"] for pin in pins(bench)] == ["kept"]

    at_bench(data_dir, pin, excerpts=store)
    at_bench(data_dir, look, excerpts=store)


def test_what_is_not_recorded_cannot_be_pinned(data_dir: Path) -> None:
    async def work(bench: SessionBench) -> None:
        await bench.turns(10)
        with pytest.raises(Problem, match="not recorded"):
            await bench.ask("pin")

    at_bench(data_dir, work, recordings=None)


def test_a_run_without_samples_cannot_be_pinned(data_dir: Path) -> None:
    async def work(bench: SessionBench) -> None:
        await bench.ask("stop")
        await bench.turns(2)
        await bench.ask("reset")
        with pytest.raises(Problem, match="no samples yet"):
            await bench.ask("pin")

    at_bench(data_dir, work)


def test_a_level_captures_what_lies_around_it(data_dir: Path) -> None:
    async def work(bench: SessionBench) -> None:
        await bench.ask("arm_trigger", by="page 3", source=LEVEL, before_s=0.1, after_s=0.2)
        assert trigger(bench)["state"] == "armed"
        assert trigger(bench)["sentence"] == "Armed: waits for reference rising through 0.001 rad."
        await watched(bench, 150)
        assert trigger(bench)["state"] == "fired"
        await watched(bench, 150)
        found = trigger(bench)
        assert (found["state"], found["by"]) == ("captured", "page 3")
        values = bench.session.ring.since(0).samples[:, INDEX["reference"]]
        at_s = 0.001 * int(np.flatnonzero(values >= 0.001)[0])
        (excerpt,) = pins(bench)
        assert excerpt["at_s"] == pytest.approx(at_s)
        assert (excerpt["from_s"], excerpt["to_s"]) == (max(0.0, at_s - 0.1), pytest.approx(at_s + 0.2))
        assert (excerpt["kind"], excerpt["recording"]) == ("trigger", "run-1")
        assert excerpt["label"] == f"reference rising through 0.001 rad at {at_s:.3f} s"
        assert {key: found["excerpt"][key] for key in excerpt} == excerpt

    at_bench(data_dir, work)


def test_a_single_trigger_fires_once_and_a_repeated_one_again(data_dir: Path) -> None:
    step = {"kind": "step", "target": 0.01, "dwell_s": 0.2, "start_s": 0.05}
    often = NOMINAL.model_validate(NOMINAL.model_dump(mode="json") | {"reference": step})

    async def work(bench: SessionBench) -> None:
        for repeat, captures in ((False, 1), (True, 3)):
            before = len(pins(bench))
            await bench.ask("reset")
            await bench.ask("arm_trigger", source=LEVEL, before_s=0.02, after_s=0.02, repeat=repeat)
            await watched(bench, 1000)
            assert len(pins(bench)) - before == captures
            assert trigger(bench)["state"] == ("armed" if repeat else "captured")

    at_bench(data_dir, work, often)


def test_an_event_fires_and_one_from_before_does_not(data_dir: Path) -> None:
    async def work(bench: SessionBench) -> None:
        session = bench.session
        await watched(bench, 100)
        await bench.ask("arm_trigger", source={"kind": "event", "event": "disturbance"}, after_s=0.05)
        session.log.add("disturbance", "too early", "scenario", session.status.epoch, 0.01)
        session.log.add("tuning", "another kind", "page 1", session.status.epoch, 0.2)
        assert trigger(bench)["state"] == "armed"
        session.log.add("disturbance", "link disturbance on", "scenario", session.status.epoch, 0.1)
        assert trigger(bench)["state"] == "fired"
        await watched(bench, 100)
        assert pins(bench)[-1]["label"] == "link disturbance on at 0.100 s"

    at_bench(data_dir, work)


def test_a_run_that_ends_too_soon_is_captured_as_far_as_it_went(data_dir: Path) -> None:
    async def work(bench: SessionBench) -> None:
        await bench.ask("arm_trigger", source=LEVEL, before_s=0.1, after_s=5.0)
        await watched(bench, 200)
        assert trigger(bench)["state"] == "fired"
        await bench.ask("reset")
        await watched(bench, 50)
        (excerpt,) = pins(bench)
        assert excerpt["recording"] == "run-1"
        assert excerpt["to_s"] == pytest.approx(0.2, abs=0.01)

    at_bench(data_dir, work)


def test_disarmed_it_waits_no_longer(data_dir: Path) -> None:
    async def work(bench: SessionBench) -> None:
        await bench.ask("arm_trigger", source=LEVEL)
        await bench.ask("disarm_trigger")
        await watched(bench, 300)
        assert (trigger(bench)["state"], trigger(bench)["trigger"], pins(bench)) == ("off", None, [])

    at_bench(data_dir, work)


def test_what_is_armed_while_a_capture_is_being_kept_stays_armed(data_dir: Path) -> None:
    async def work(bench: SessionBench) -> None:
        await bench.ask("arm_trigger", source=LEVEL, after_s=0.0)
        await bench.turns(200)
        bench.session.trigger.watch()  # fires, and a thread begins to keep what was captured
        await bench.session.trigger.arm(Arming.model_validate({"source": LEVEL}), "page 2")
        await settled(bench)
        assert (trigger(bench)["state"], trigger(bench)["by"], len(pins(bench))) == ("armed", "page 2", 1)

    at_bench(data_dir, work)


def test_a_capture_that_cannot_be_kept_is_told(data_dir: Path) -> None:
    class Full(ExcerptsInMemory):
        def add(self, excerpt: Excerpt) -> Excerpt:
            raise Problem(507, "Disk full", "The disk is full; nothing was kept.")

    async def work(bench: SessionBench) -> None:
        await bench.ask("arm_trigger", source=LEVEL, after_s=0.0)
        await watched(bench, 200)
        assert trigger(bench)["state"] == "captured"
        assert trigger(bench)["sentence"].endswith("not kept: The disk is full; nothing was kept.")

    at_bench(data_dir, work, excerpts=Full())
