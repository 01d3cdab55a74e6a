"""What a rig is asked for, and what is told of it: limits, waiting references, states in words, news at once."""

from pathlib import Path
from typing import Any

from backend.loop import messages
from backend.session.journal import Change, Told
from tests.backend.rig_bench import HOLD, SINE, RigBench, at_rig, refusal_of
from vssea_core.signals.documents import SineReference


def test_stiffness_disturbances_jogs_and_moves_beyond_the_rigs_limits_never_reach_it(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.to("armed")
        asked = len(bench.rig.asked)
        load = [{"kind": "constant", "torque": 3.0}]
        for command, arguments, words in (
            ("set_stiffness", {"changes": {"stiffness": 950.0}}, "expected 25 to 900 N·m/rad, the rig's limits"),
            ("set_stiffness", {"replace": {"kind": "move", "stiffness": 100.0, "target": 21.0}}, "target is 21"),
            ("set_disturbances", {"replace": {"link": load}}, "only torque that the motor adds"),
            ("set_disturbances", {"replace": {"stiffness_motor": load}}, "only torque that the motor adds"),
            ("set_disturbances", {"replace": {"motor": [{"kind": "constant", "torque": 40.0}] * 2}}, "at most 70 N·m"),
            ("jog", {"link": 0.9}, "at most 0.8 rad/s"),
            ("jog", {"stiffness": -500.0}, "at most 400"),
            ("go_to", {"position": 1.7, "speed": 0.2}, "expected -1.6 to 1.6 rad"),
            ("go_to", {"position": 1.0, "speed": 2.0}, "at most 0.8 rad/s"),
        ):
            problem = await refusal_of(bench, command, **arguments)
            assert words in problem.detail
        assert len(bench.rig.asked) == asked
        await bench.ask("set_disturbances", replace={"motor": load})
        assert bench.session.scenario.disturbances.motor
        # Undo puts whole parts in force: it is checked as any change.
        await bench.ask("set_stiffness", changes={"stiffness": 300.0})

    at_rig(data_dir, work)


def test_a_reference_waits_until_it_is_followed_and_the_journal_knows_what_the_link_followed(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.to("armed")

        def journal() -> list[tuple[str, Any]]:
            return [(change.by, change.document) for change in bench.diary.of(Change) if change.part == "reference"]

        assert journal()[-1][1] == HOLD.model_dump(mode="json")
        count = len(journal())
        await bench.ask("set_reference", replace=SINE)
        assert bench.session.scenario.reference == SineReference(**SINE)
        assert len(journal()) == count  # only stored
        await bench.ask("follow")
        assert bench.snapshot()["sentence"] == "Running: tracking"
        assert journal()[-1][0] == "page 1"
        assert journal()[-1][1]["amplitude"] == 0.2
        await bench.ask("set_reference", changes={"amplitude": 0.3})
        assert journal()[-1][1]["amplitude"] == 0.3  # followed: in force at once
        await bench.ask("hold")
        assert journal()[-1][1] == HOLD.model_dump(mode="json")
        assert bench.session.scenario.reference.amplitude == 0.3  # type: ignore[union-attr]  # what is wanted stays
        await bench.ask("set_reference", changes={"amplitude": 0.1})
        assert journal()[-1][1] == HOLD.model_dump(mode="json")

    at_rig(data_dir, work)


def test_the_documents_stiffness_is_the_one_in_force(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.to("armed")
        assert bench.session.scenario.stiffness_reference.stiffness == 137.0
        document = bench.told_of("document")[-1]
        assert document["scenario"]["stiffness_reference"]["stiffness"] == 137.0
        await bench.ask("set_stiffness", changes={"stiffness": 200.0})  # a change, not what stood there before arming
        assert isinstance(bench.rig.asked[-1], messages.SetStiffness)

    at_rig(data_dir, work)


def test_arming_that_is_refused_answers_409_with_the_reasons(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.ask("connect_rig", rig="emulator")
        bench.rig.refusals[messages.Arm] = "not homed; the link moves"
        problem = await refusal_of(bench, "arm")
        assert (problem.status, problem.title, problem.detail) == (409, "Cannot arm", "not homed; the link moves")
        assert problem.document()["reasons"] == ["not homed"]

    at_rig(data_dir, work)


def test_a_jog_carries_when_it_was_sent_and_is_two_lines_of_the_log(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.to("armed")
        for _ in range(10):
            await bench.ask("jog", link=0.3)
            assert bench.rig.asked[-1] == messages.Jog(0.3, 0.0, bench.clock.now)
            await bench.passed(0.1)
        await bench.ask("jog")
        assert bench.events("rig")[-2:] == ["jogging: link 0.30 rad/s", "jog let go"]
        jogs = [told for told in bench.diary.of(Told) if told.command == "jog"]
        assert [told.arguments for told in jogs] == [{"link": 0.3}, {}]
        assert not [told for told in bench.diary.of(Told) if told.command == "renew_control"]

    at_rig(data_dir, work)


def test_every_state_of_a_rig_has_a_sentence_with_what_to_do(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        def sentence() -> str:
            return str(bench.snapshot()["sentence"])

        await bench.ask("connect_rig", rig="emulator")
        assert sentence() == "Connected: drives off, not homed. Home the stiffness axis to arm"
        await bench.ask("home_stiffness")
        assert sentence() == "Ready: drives off, homed. Arm to hold the link where it is"
        await bench.ask("arm")
        assert sentence() == "Armed: holding 0.312 rad"
        await bench.ask("jog", link=0.3)
        assert sentence() == "Running: jogging 0.30 rad/s"
        await bench.ask("stop", by="page 2")
        bench.rig.become("stopping", "Stopped on request. Reset to go on.", motion="braking")
        assert sentence().startswith("Stopping: braking")
        bench.rig.become("stopped", "Stopped on request. Reset to go on.", motion="drives off")
        assert sentence() == "Stopped by page 2 at 0.0 s: drives off. Reset to go on"
        await bench.ask("reset")
        assert bench.snapshot()["state"] == "ready"
        bench.rig.become("stopped", "The operator's page has been silent. Take control and Reset to go on.")
        assert sentence().startswith("Stopped at 0.0 s: The operator's page has been silent.")
        bench.rig.fail(4, stands=True)
        assert sentence().startswith("Fault 4: The link encoder has been silent for 10 cycles.")
        problem = await refusal_of(bench, "reset")
        assert (problem.status, problem.title) == (409, "Cannot reset")
        assert bench.snapshot()["rig"]["faults"][0]["number"] == 4
        states = {event["text"] for event in bench.session.log.last(200) if event["kind"] == "fault"}
        assert any(text.startswith("Fault 4: ") for text in states)

    at_rig(data_dir, work)


def test_what_a_rig_cannot_know_is_null_in_the_snapshot_and_not_a_number_that_json_lacks(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        import json

        await bench.ask("connect_rig", rig="emulator")
        bench.rig.measure(20, link_disturbance=float("nan"), stiffness=float("nan"))
        snapshot = bench.snapshot()
        items = {item["name"]: item["value"] for item in snapshot["metrics"]["items"]}
        assert (items["observer_error"], items["peak_error"], snapshot["stiffness"]) == (None, 0.0, None)
        json.dumps(snapshot, allow_nan=False)

    at_rig(data_dir, work)


def test_news_of_the_rig_reach_pages_at_once_and_figures_with_the_next_state(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.ask("connect_rig", rig="emulator")
        told = len(bench.told_of("state"))
        bench.rig.become("connected", cycles=500, round_trip_us=260.0)
        assert len(bench.told_of("state")) == told
        assert bench.snapshot()["rig"]["bus"]["cycles"] == 500
        bench.rig.become("connected", cannot_arm=("not homed", "the link moves"))
        assert len(bench.told_of("state")) == told + 1

    at_rig(data_dir, work)
