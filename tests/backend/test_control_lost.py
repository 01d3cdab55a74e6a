"""Control over a rig that ends: what it drove stops, whoever takes control next, and the sentence says why."""

import logging
from collections.abc import Awaitable, Callable
from pathlib import Path

import pytest

from backend.loop import messages
from backend.loop.messages import Done
from tests.backend.rig_bench import RigBench, at_rig

Ending = Callable[[RigBench], Awaitable[None]]


async def given_up(bench: RigBench) -> None:
    await bench.ask("release_control")


async def closed(bench: RigBench) -> None:
    bench.session.rig.leave(bench.keys["page 1"])


async def silent(bench: RigBench) -> None:
    bench.clock.now += 0.41
    bench.session.rig.watch()


async def silent_and_taken_by_another(bench: RigBench) -> None:
    bench.clock.now += 0.41
    await bench.ask("take_control", by="page 2")


ENDINGS = {
    given_up: "the operator giving up control",
    closed: "the operator's page closing",
    silent: "the operator's silence",
    silent_and_taken_by_another: "the operator's silence",
}


@pytest.mark.parametrize("ending", ENDINGS, ids=lambda ending: ending.__name__)
@pytest.mark.parametrize("state", ["homing", "armed", "running"])
def test_a_rig_under_torque_stops_as_control_ends_and_says_why(data_dir: Path, state: str, ending: Ending) -> None:
    async def work(bench: RigBench) -> None:
        await bench.to("armed")
        if state == "running":
            await bench.ask("jog", link=0.2)
        bench.rig.become(state)  # type: ignore[arg-type]
        stops = bench.session.flag.count
        await ending(bench)
        assert bench.session.flag.count == stops + 1
        if ending is not silent_and_taken_by_another:
            await bench.ask("take_control", by="page 2")  # another's signs of life come too late to keep it going
        bench.session.rig.watch()
        assert bench.session.flag.count == stops + 1  # and what he begins is not stopped again
        bench.rig.become("stopping", "Stopped on request. Reset to go on.", motion="braking")
        bench.rig.become("stopped", "Stopped on request. Reset to go on.", motion="drives off")
        assert bench.snapshot()["sentence"] == f"Stopped by {ENDINGS[ending]} at 0.0 s: drives off. Reset to go on"
        assert ENDINGS[ending] in bench.events("state")[-1]

    at_rig(data_dir, work)


@pytest.mark.parametrize("ending", ENDINGS, ids=lambda ending: ending.__name__)
@pytest.mark.parametrize("state", ["connected", "ready", "stopped", "fault"])
def test_a_rig_without_torque_is_left_as_it_is(data_dir: Path, state: str, ending: Ending) -> None:
    async def work(bench: RigBench) -> None:
        await bench.to("ready")
        bench.rig.become(state, "why")  # type: ignore[arg-type]
        stops = bench.session.flag.count
        await ending(bench)
        assert bench.session.flag.count == stops
        assert bench.session.status.stopped_by is None

    at_rig(data_dir, work)


def test_drives_that_are_just_being_switched_on_stop_too(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.to("ready")
        answered, stops = bench.switching.command, bench.session.flag.count

        async def leaving(command: messages.Command, limit_s: float = 2.0) -> Done:
            await closed(bench)  # while the command is under way, the rig still without torque
            return await answered(command, limit_s)

        bench.switching.command = leaving  # type: ignore[method-assign]
        await bench.ask("arm")
        assert bench.session.flag.count == stops + 1

    at_rig(data_dir, work)


def test_a_rig_that_is_handed_over_goes_on(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.to("armed")
        stops = bench.session.flag.count
        await bench.ask("hand_control", to="page 2")
        bench.session.rig.leave(bench.keys["page 1"])
        bench.session.rig.watch()
        assert bench.session.flag.count == stops
        assert bench.snapshot()["state"] == "armed"

    at_rig(data_dir, work)


def test_a_failed_task_of_the_server_stops_a_rig_but_no_simulation(
    data_dir: Path, caplog: pytest.LogCaptureFixture
) -> None:
    async def failing() -> None:
        raise RuntimeError("broken")

    async def work(bench: RigBench) -> None:
        session = bench.session
        stops = session.flag.count
        with caplog.at_level(logging.CRITICAL, "backend.session.session"):
            session.spawn(failing())
            await bench.settled()
        assert (session.flag.count, bench.snapshot()["state"]) == (stops, "fault")
        await bench.ask("reset")
        await bench.to("armed")
        with caplog.at_level(logging.CRITICAL, "backend.session.session"):
            session.spawn(failing())
            await bench.settled()
        assert (session.flag.count, bench.snapshot()["state"]) == (stops + 1, "fault")
        assert bench.events("fault")[-1] == "a task of the server failed: broken"
        bench.rig.become("stopped", "Stopped on request. Reset to go on.")
        assert bench.snapshot()["sentence"].startswith("Stopped by a failure in the server at ")

    at_rig(data_dir, work)
