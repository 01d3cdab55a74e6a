"""A session goes to a rig and back, against a scripted control process that may also die."""

from pathlib import Path
from typing import Any

import pytest

from backend.loop import messages
from backend.presets.last import read_last
from backend.problem import Problem
from backend.session.control_link import RIG_ENTRY
from backend.session.journal import Run
from backend.session.rig_scenario import cautious_tuning
from tests.backend.rig_bench import EMULATOR, RigBench, Shelf, at_rig, refusal_of
from vssea_core.actuator.parameters import Actuator
from vssea_core.control.tuning import PositionObserver
from vssea_core.scenarios import NOMINAL, REALISTIC


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
        problem = await refusal_of(bench, "connect_rig", rig="emulator")
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
        problem = await refusal_of(bench, "connect_rig", rig="nobody")
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
        problem = await refusal_of(bench, "connect_rig", rig="emulator")
        assert (problem.status, problem.detail) == (503, "The control process does not answer. The simulation is back.")
        assert bench.snapshot()["state"] == "running"
        assert bench.events("fault") == []

    at_rig(data_dir, work)


def test_disconnecting_brings_back_what_ran_and_history_begins_anew_both_ways(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.ask("tune", changes={"observer.bandwidth": 90.0})
        before, epoch = bench.session.scenario, bench.session.status.epoch
        await bench.ask("connect_rig", rig="emulator")
        assert (await refusal_of(bench, "undo")).title == "Nothing to undo"
        assert [entry["save_point"] for entry in bench.session.history.last(200)] == ["start"]
        assert any(message.get("anew") for message in bench.told_of("history"))
        await bench.ask("tune", changes={"observer.bandwidth": 80.0})
        await bench.ask("disconnect_rig")
        assert [type(said) for said in bench.switching.farewells] == [messages.Disconnect]
        assert bench.session.scenario == before
        assert bench.snapshot()["state"] == "running"
        assert bench.snapshot()["control"] == {"needed": False, "operator": None, "asking": [], "expires_in_s": None}
        assert bench.session.status.epoch > epoch + 1  # the rig's run, then one of the simulation
        assert (await refusal_of(bench, "undo")).title == "Nothing to undo"
        assert bench.diary.of(Run)[-1].rig == "simulated"
        assert bench.events("state")[-1] == "Running, tracking sine 0.50 rad, 0.25 Hz"
        assert (await refusal_of(bench, "arm")).title == "No rig"

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
        assert (await refusal_of(bench, "arm")).status == 503
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
        assert "No node answers" in (await refusal_of(bench, "reset")).detail
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
