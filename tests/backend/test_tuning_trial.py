"""A tuning tried in simulation: what it is tried on, and what the answer says. The jobs run on the spot."""

from pathlib import Path
from typing import Any

import pytest

from backend.compute import jobs
from backend.compute.pool import JobRefusedError
from backend.loop import messages
from backend.problem import Problem
from backend.session.tuning_trial import MOVE
from tests.backend.rig_bench import RigBench, at_rig
from vssea_core.scenario import Scenario

SINE = {"kind": "sine", "amplitude": 0.05, "frequency_hz": 0.5, "offset": 0.312}


class TrialWorker:
    """The simulation worker, doing its job at once; it keeps what it was asked."""

    def __init__(self) -> None:
        self.asked: list[tuple[Scenario, Scenario]] = []

    async def run(self, job: str, *arguments: Any, **_: Any) -> Any:
        assert job == "try_tuning"
        self.asked.append(arguments)  # type: ignore[arg-type]
        try:
            return jobs.try_tuning(*arguments)
        except ValueError as refusal:
            raise JobRefusedError(str(refusal)) from refusal


def with_worker(bench: RigBench) -> TrialWorker:
    worker = TrialWorker()
    bench.session.rig.trial._simulation = worker  # type: ignore[assignment]
    return worker


def test_a_holding_rig_is_tried_on_a_move_with_the_stiffness_and_the_limits_that_it_has(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        worker = with_worker(bench)
        await bench.to("armed")
        bench.rig.measure(5, stiffness=412.0)
        before, asked = bench.session.scenario, len(bench.rig.asked)
        answer = await bench.ask("try_tuning", by="page 2", changes={"observer.bandwidth": 110.0})
        ((present, candidate),) = worker.asked
        assert present.tuning == before.tuning
        assert candidate.model_copy(update={"tuning": present.tuning}) == present
        assert candidate.tuning.observer.bandwidth == 110.0  # type: ignore[union-attr]
        assert (present.reference, present.stiffness_reference.stiffness) == (MOVE, 412.0)
        assert (present.timing, present.sensors) == (before.timing, before.sensors)
        assert (present.actuator.motor.peak_torque, present.actuator.stiffness.peak_torque) == (70.0, 0.75)
        assert answer["ok"], answer
        assert answer["sentence"].startswith("peak error ")
        assert set(answer["metrics"]) >= {"peak_error", "rms_torque"}
        assert all(len(pair) == 2 for pair in answer["metrics"].values())
        assert (answer["limits"], answer["rig"]) == ([], "emulator")
        assert "available" in answer["margins"]
        assert (bench.session.scenario, len(bench.rig.asked)) == (before, asked)  # nothing was changed

    at_rig(data_dir, work)


def test_a_rig_that_follows_is_tried_on_what_it_follows(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        worker = with_worker(bench)
        await bench.to("armed")
        await bench.ask("set_reference", replace=SINE)
        await bench.ask("try_tuning")
        await bench.ask("follow")
        await bench.ask("try_tuning")
        await bench.ask("hold")
        await bench.ask("try_tuning")
        assert [present.reference.kind for present, _ in worker.asked] == ["move", "sine", "move"]
        assert worker.asked[1][0].initial.link_position == 0.312

    at_rig(data_dir, work)


@pytest.mark.parametrize("measured", [float("nan"), 2000.0])
def test_a_stiffness_that_is_not_known_or_not_allowed_is_not_tried_at(data_dir: Path, measured: float) -> None:
    async def work(bench: RigBench) -> None:
        worker = with_worker(bench)
        await bench.to("armed")
        bench.rig.measure(5, stiffness=measured)
        await bench.ask("try_tuning")
        assert worker.asked[0][0].stiffness_reference.stiffness == (900.0 if measured > 0.0 else 137.0)

    at_rig(data_dir, work)


def test_a_tuning_that_is_unstable_or_does_worse_is_not_ok_and_the_answer_says_why(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        with_worker(bench)
        await bench.to("armed")
        unstable = await bench.ask("try_tuning", changes={"controller.natural_frequency": 400.0})
        assert not unstable["ok"]
        assert "unstable" in unstable["sentence"]
        assert (unstable["metrics"], unstable["limits"]) == ({}, [])
        worse = await bench.ask("try_tuning", changes={"controller.natural_frequency": 3.0, "observer.bandwidth": 8.0})
        assert not worse["ok"]
        assert worse["sentence"].startswith("In simulation ")
        with pytest.raises(Problem, match=r"tuning.observer.bandwidth is -1.0; expected"):
            await bench.ask("try_tuning", changes={"observer.bandwidth": -1.0})
        assert not any(isinstance(command, messages.Install) for command in bench.rig.asked)

    at_rig(data_dir, work)


def test_a_simulated_session_tries_a_tuning_on_what_it_runs(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        worker = with_worker(bench)
        answer = await bench.ask("try_tuning", changes={"observer.bandwidth": 110.0})
        ((present, _),) = worker.asked
        assert (present.reference, answer["rig"]) == (bench.session.scenario.reference, None)
        assert present.disturbances.link == ()

    at_rig(data_dir, work)
