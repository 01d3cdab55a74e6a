"""A session on a rig, against a scripted control process: going there and back, who may do what, and what is told."""

from pathlib import Path
from typing import Any

import pytest

from backend.loop import messages
from backend.presets.last import read_last
from backend.problem import Problem
from backend.session.control_link import RIG_ENTRY
from backend.session.journal import Change, Run, Told
from backend.session.rig_scenario import cautious_tuning
from tests.backend.rig_bench import EMULATOR, HOLD, RigBench, Shelf, at_rig
from vssea_core.actuator.parameters import Actuator
from vssea_core.control.tuning import PositionObserver
from vssea_core.scenarios import NOMINAL, REALISTIC
from vssea_core.signals.documents import SineReference

SINE = {"kind": "sine", "amplitude": 0.2, "frequency_hz": 0.5, "offset": 0.312}
MOVES: dict[str, dict[str, Any]] = {
    "home_stiffness": {}, "arm": {}, "follow": {}, "jog": {"link": 0.2}, "go_to": {"position": 0.1, "speed": 0.2},
    "tune": {"changes": {"observer.bandwidth": 90.0}}, "set_reference": {"replace": SINE},
    "set_stiffness": {"changes": {"stiffness": 300.0}}, "set_disturbances": {"replace": {}},
    "apply_preset": {"name": "none"}, "undo": {}, "redo": {}, "return_to": {"number": 1}, "reset": {}, "disconnect_rig": {},
}  # fmt: skip


async def refused(bench: RigBench, command: str, by: str = "page 1", **arguments: Any) -> Problem:
    with pytest.raises(Problem) as refusal:
        await bench.ask(command, by, **arguments)
    return refusal.value


# ---- there and back


def test_a_rig_is_connected_with_a_scenario_made_of_its_file(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.ask("connect_rig", rig="emulator")
        (connect,) = bench.rig.asked
        assert isinstance(connect, messages.Connect)
        scenario = connect.scenario
        assert scenario == bench.session.scenario
        assert (scenario.sensors.link_bits, scenario.sensors.motor_counts, scenario.sensors.stiffness_counts) == (
            17, 16384, 16384,
        )  # fmt: skip
        assert not scenario.sensors.velocities
        assert (scenario.timing.sample_time_s, scenario.timing.compute_delay_samples) == (0.002, 1)
        assert (scenario.reference.kind, scenario.disturbances.link) == ("jog", ())
        assert scenario.tuning == REALISTIC.tuning
        snapshot = bench.snapshot()
        assert snapshot["state"] == "connected"
        assert (snapshot["rig"]["kind"], snapshot["rig"]["label"], snapshot["rig"]["name"]) == (
            "emulated", "emulated rig", "emulator",
        )  # fmt: skip
        assert snapshot["rig"]["limits"] == EMULATOR.limits.model_dump()
        assert snapshot["control"] == {"needed": True, "operator": "page 1", "asking": [], "expires_in_s": 0.4}
        assert "begins with the tuning that was in force" in bench.events("rig")[-1]
        run = bench.diary.of(Run)[-1]
        assert (run.scenario, run.rig, run.epoch) == (scenario, "emulated", bench.rig.epoch)

    at_rig(data_dir, work)


def test_a_tuning_without_a_position_observer_is_passed_over_with_a_word(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.ask("connect_rig", rig="emulator")
        assert bench.session.scenario.tuning == cautious_tuning(500.0, Actuator())
        words = bench.events("rig")[-1]
        assert "begins with a cautious tuning" in words
        assert "no position observer" in words

    at_rig(data_dir, work, scenario=NOMINAL)


def test_the_preset_of_the_rigs_file_goes_first_and_a_missing_one_is_told(data_dir: Path) -> None:
    rig = EMULATOR.model_copy(update={"preset": "slow"})

    async def work(bench: RigBench) -> None:
        slow = REALISTIC.tuning.model_copy(update={"observer": PositionObserver(bandwidth=55.0)})
        await bench.ask("tune", replace=slow.model_dump(mode="json"))
        await bench.ask("save_preset", name="slow")
        await bench.ask("tune", changes={"observer.bandwidth": 100.0})
        await bench.ask("connect_rig", rig="emulator")
        assert bench.session.scenario.tuning == slow
        assert bench.session.document()["preset"]["name"] == "slow"
        await bench.ask("disconnect_rig")
        await bench.ask("delete_preset", name="slow")

    at_rig(data_dir, work, rigs=Shelf(rig))

    async def without(bench: RigBench) -> None:
        await bench.ask("connect_rig", rig="emulator")
        assert "not with preset slow" in bench.events("rig")[-1]

    at_rig(data_dir / "other", without, rigs=Shelf(rig))


def test_a_refused_rig_leaves_the_simulation_with_the_sentence(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.ask("tune", changes={"observer.bandwidth": 90.0})
        before = bench.session.scenario
        sentence = "The CAN bus cannot be opened. Start the adapter, and connect again."
        bench.switching.refuses[messages.Connect] = sentence
        problem = await refused(bench, "connect_rig", rig="emulator")
        assert (problem.status, problem.detail) == (409, f"{sentence} The simulation is back.")
        snapshot = bench.snapshot()
        assert (snapshot["state"], snapshot["rig"]["kind"], snapshot["rig"]["connected"]) == (
            "running",
            "simulated",
            False,
        )
        assert bench.session.scenario == before
        assert bench.switching.started == [RIG_ENTRY, "simulation"]
        assert bench.switching.simulation is not None
        assert snapshot["control"]["operator"] is None
        await bench.ask("pause")  # a simulation as any
        assert bench.snapshot()["state"] == "paused"
        problem = await refused(bench, "connect_rig", rig="nobody")
        assert problem.status == 404
        assert bench.snapshot()["state"] == "paused"  # refused before anything ended

    at_rig(data_dir, work)


def test_a_control_process_that_dies_while_it_connects_is_an_answer_and_no_fault(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        opened = bench.session.rig.connection._open

        async def dying(*arguments: Any) -> None:
            await opened(*arguments)
            bench.switching.die()
            raise Problem(503, "No answer", "The control process does not answer.")

        bench.session.rig.connection._open = dying  # type: ignore[method-assign]
        problem = await refused(bench, "connect_rig", rig="emulator")
        assert (problem.status, problem.detail) == (503, "The control process does not answer. The simulation is back.")
        assert bench.snapshot()["state"] == "running"
        assert bench.events("fault") == []

    at_rig(data_dir, work)


def test_disconnecting_brings_back_what_ran_and_history_begins_anew_both_ways(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.ask("tune", changes={"observer.bandwidth": 90.0})
        before, epoch = bench.session.scenario, bench.session.status.epoch
        await bench.ask("connect_rig", rig="emulator")
        assert (await refused(bench, "undo")).title == "Nothing to undo"
        assert [entry["save_point"] for entry in bench.session.history.last(200)] == ["start"]
        assert any(message.get("anew") for message in bench.told_of("history"))
        await bench.ask("tune", changes={"observer.bandwidth": 80.0})
        await bench.ask("disconnect_rig")
        assert [type(said) for said in bench.switching.farewells] == [messages.Disconnect]
        assert bench.session.scenario == before
        assert bench.snapshot()["state"] == "running"
        assert bench.snapshot()["control"] == {"needed": False, "operator": None, "asking": [], "expires_in_s": None}
        assert bench.session.status.epoch > epoch + 1  # the rig's run, then one of the simulation
        assert (await refused(bench, "undo")).title == "Nothing to undo"
        assert bench.diary.of(Run)[-1].rig == "simulated"
        assert bench.events("state")[-1] == "Running, tracking sine 0.50 rad, 0.25 Hz"
        assert (await refused(bench, "arm")).title == "No rig"

    at_rig(data_dir, work)


def test_what_runs_on_a_rig_is_not_begun_with_at_the_next_start(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        session = bench.session
        await session.kept.read()
        await bench.ask("tune", changes={"observer.bandwidth": 90.0})
        simulated = session.scenario
        await bench.ask("connect_rig", rig="emulator")  # what waited to be kept is kept before
        await bench.ask("tune", changes={"observer.bandwidth": 80.0})
        await session.kept.now()
        last = read_last(session.presets.presets.database, session.presets.presets)
        assert last is not None
        assert last.scenario == simulated

    at_rig(data_dir, work)


def test_a_page_that_goes_while_a_rig_connects_does_not_tear_the_session_apart(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        import asyncio

        asked = asyncio.create_task(bench.ask("connect_rig", rig="emulator"))
        for _ in range(1000):
            if bench.snapshot()["state"] == "starting":
                break
            await asyncio.sleep(0)
        asked.cancel()
        with pytest.raises(asyncio.CancelledError):
            await asked
        async with bench.session.turn:
            assert bench.session.rig.connected
            assert bench.snapshot()["state"] == "connected"

    at_rig(data_dir, work)


# ---- who may do what


@pytest.mark.parametrize("command", MOVES)
def test_what_moves_a_rig_needs_control_and_the_answer_says_who_has_it(data_dir: Path, command: str) -> None:
    async def work(bench: RigBench) -> None:
        await bench.to("armed")
        asked = len(bench.rig.asked)
        problem = await refused(bench, command, by="page 2", **MOVES[command])
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
        problem = await refused(bench, command, **arguments)
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
        assert (await refused(bench, "take_control", by="page 2")).status == 403
        await bench.ask("ask_control", by="page 2")
        assert bench.snapshot()["control"]["asking"] == ["page 2"]
        assert (await refused(bench, "hand_control", to="page 7")).status == 404
        lease = bench.beats()[1]
        await bench.ask("hand_control", to="page 2")
        assert bench.beats()[1] == lease + 1
        control = bench.told_of("state")[-1]["snapshot"]["control"]
        assert (control["operator"], control["asking"]) == ("page 2", [])
        assert (await refused(bench, "renew_control")).status == 403
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


# ---- what a rig is asked for


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
            problem = await refused(bench, command, **arguments)
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
        problem = await refused(bench, "arm")
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


# ---- states in words


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
        problem = await refused(bench, "reset")
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


# ---- when the control process dies


def test_a_dead_control_process_is_a_fault_and_reset_connects_anew(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.ask("save_preset", name="slow")
        await bench.to("armed")
        await bench.ask("tune", changes={"observer.bandwidth": 90.0})
        bench.switching.die()
        snapshot = bench.snapshot()
        assert snapshot["state"] == "fault"
        assert "the drives stop the rig by their own watchdogs" in snapshot["sentence"]
        assert snapshot["rig"]["connected"]
        assert (await refused(bench, "arm")).status == 503
        await bench.ask("reset")
        assert bench.snapshot()["state"] == "connected"
        (connect,) = bench.rig.asked
        assert isinstance(connect, messages.Connect)
        assert connect.scenario.tuning.observer.bandwidth == 90.0  # type: ignore[union-attr]

    at_rig(data_dir, work, rigs=Shelf(EMULATOR.model_copy(update={"preset": "slow"})))


def test_after_a_dead_control_process_a_reset_may_fail_and_be_tried_again_or_the_rig_be_left(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        simulated = bench.session.scenario
        await bench.to("armed")
        bench.switching.die()
        bench.switching.refuses[messages.Connect] = "No node answers"
        assert "No node answers" in (await refused(bench, "reset")).detail
        assert bench.snapshot()["state"] == "fault"
        assert "does not answer" in bench.snapshot()["sentence"]
        bench.switching.refuses.clear()
        await bench.ask("take_control")
        await bench.ask("reset")
        assert bench.snapshot()["state"] == "connected"
        bench.switching.die()
        await bench.ask("disconnect_rig")
        assert bench.snapshot()["state"] == "running"
        assert bench.session.scenario == simulated

    at_rig(data_dir, work)
