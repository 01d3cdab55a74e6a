"""Who may do what on a rig: control is asked for, handed over, kept by a key, and lost in silence."""

from pathlib import Path
from typing import Any

import pytest

from backend.loop import messages
from backend.problem import Problem
from backend.session.journal import Told
from tests.backend.rig_bench import SINE, RigBench, at_rig, refusal_of

MOVES: dict[str, dict[str, Any]] = {
    "home_stiffness": {}, "arm": {}, "follow": {}, "jog": {"link": 0.2}, "go_to": {"position": 0.1, "speed": 0.2},
    "tune": {"changes": {"observer.bandwidth": 90.0}}, "set_reference": {"replace": SINE},
    "set_stiffness": {"changes": {"stiffness": 300.0}}, "set_disturbances": {"replace": {}},
    "apply_preset": {"name": "none"}, "undo": {}, "redo": {}, "return_to": {"number": 1}, "reset": {}, "disconnect_rig": {},
}  # fmt: skip


@pytest.mark.parametrize("command", MOVES)
def test_what_moves_a_rig_needs_control_and_the_answer_says_who_has_it(data_dir: Path, command: str) -> None:
    async def work(bench: RigBench) -> None:
        await bench.to("armed")
        asked = len(bench.rig.asked)
        problem = await refusal_of(bench, command, by="page 2", **MOVES[command])
        assert (problem.status, problem.title) == (403, "Not in control")
        assert "page 1" in problem.detail
        assert len(bench.rig.asked) == asked
        told = bench.diary.of(Told)[-1]
        assert (told.command, told.by, told.ok, told.problem) == (command, "page 2", False, problem.detail)

    at_rig(data_dir, work)


def test_anybody_may_stop_hold_disarm_and_let_go_also_when_nobody_is_in_control(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.to("armed")
        await bench.ask("jog", link=0.2)
        bench.clock.now += 1.0
        stops = bench.session.flag.count
        await bench.ask("hold", by="page 2")
        await bench.ask("jog", by="page 2")
        await bench.call("disarm", "REST", None)
        await bench.call("stop", "REST", None)
        assert bench.session.flag.count == stops + 1
        assert [type(command) for command in bench.rig.asked[-3:]] == [messages.Hold, messages.Jog, messages.Disarm]

    at_rig(data_dir, work)


@pytest.mark.parametrize(
    ("command", "arguments"),
    [("pause", {}), ("resume", {}), ("step", {}), ("set_pace", {"factor": 1.0}), ("load_scenario", {"name": "nominal"}),
     ("connect_rig", {"rig": "emulator"})],
)  # fmt: skip
def test_what_only_a_simulation_can_do_is_refused_in_a_sentence(
    data_dir: Path, command: str, arguments: dict[str, Any]
) -> None:
    async def work(bench: RigBench) -> None:
        await bench.ask("connect_rig", rig="emulator")
        problem = await refusal_of(bench, command, **arguments)
        assert (problem.status, problem.title) == (409, "Not on a rig")
        assert problem.detail.endswith("rig emulator is connected; disconnect it first.")

    at_rig(data_dir, work)


def test_a_saved_actuator_is_not_loaded_on_a_rig(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.ask("connect_rig", rig="emulator")
        with pytest.raises(Problem, match="for the simulation"):
            await bench.session.presets.load_plant("any", None, "REST")

    at_rig(data_dir, work)


def test_control_is_taken_asked_for_handed_over_and_given_up_and_pages_see_it(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.ask("connect_rig", rig="emulator")
        assert (await refusal_of(bench, "take_control", by="page 2")).status == 403
        await bench.ask("ask_control", by="page 2")
        assert bench.snapshot()["control"]["asking"] == ["page 2"]
        assert (await refusal_of(bench, "hand_control", to="page 7")).status == 404
        lease = bench.beats()[1]
        await bench.ask("hand_control", to="page 2")
        assert bench.beats()[1] == lease + 1
        control = bench.told_of("state")[-1]["snapshot"]["control"]
        assert (control["operator"], control["asking"]) == ("page 2", [])
        assert (await refusal_of(bench, "renew_control")).status == 403
        await bench.ask("renew_control", by="page 2")
        await bench.ask("release_control", by="page 2")
        assert bench.snapshot()["control"]["operator"] is None
        assert bench.events("control") == [
            "page 2 asks page 1 for control", "page 1 handed control to page 2", "page 2 gave up control",
        ]  # fmt: skip

    at_rig(data_dir, work)


def test_a_caller_without_a_page_proves_control_by_its_key_and_a_page_name_proves_nothing(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        answer = await bench.call("connect_rig", "REST", None, rig="emulator")
        key = answer["key"]
        bench.clock.now += 4.9
        await bench.call("renew_control", "REST", key)
        await bench.call("home_stiffness", "REST", key)
        for by, other in (("page 1", None), ("REST", None), ("REST", "guess"), ("page 1", bench.keys["page 1"])):
            with pytest.raises(Problem, match="REST is in control"):
                await bench.call("arm", by, other)
        assert (await bench.call("take_control", "REST", key, expires_s=2.0))["key"] == key
        bench.clock.now += 2.0
        with pytest.raises(Problem, match="Nobody is in control"):
            await bench.call("arm", "REST", key)
        with pytest.raises(Problem, match="expires_s"):
            await bench.call("take_control", "REST", None, expires_s=6.0)

    at_rig(data_dir, work)


def test_a_silent_operator_is_told_of_once(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.ask("connect_rig", rig="emulator")
        for _ in range(8):
            bench.clock.now += 0.1
            bench.session.rig.watch()
        assert bench.events("control") == ["page 1 was silent for 0.4 s and lost control"]

    at_rig(data_dir, work)


def test_a_caller_whose_rig_took_long_to_connect_has_control_with_the_key_of_the_answer(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        opened = bench.session.rig.connection._open

        async def slow(*arguments: Any) -> None:
            await opened(*arguments)
            bench.clock.now += 20.0

        bench.session.rig.connection._open = slow  # type: ignore[method-assign]
        answer = await bench.call("connect_rig", "REST", None, rig="emulator")
        await bench.call("home_stiffness", "REST", answer["key"])
        assert bench.snapshot()["control"]["operator"] == "REST"

    at_rig(data_dir, work)
