"""After a fault the tuning goes back to the last that ran 5 s with the loops closed; in injected time."""

from pathlib import Path

import pytest

from backend.loop import messages
from backend.session.good_tuning import PROVED_S, GoodTuning
from tests.backend.rig_bench import RigBench, at_rig
from tests.injected_clock import Clock
from vssea_core.control.tuning import PositionObserver, Tuning

A, B = (Tuning(observer=PositionObserver(bandwidth=bandwidth)) for bandwidth in (80.0, 160.0))


def armed(tuning: Tuning = A) -> tuple[GoodTuning, Clock]:
    clock = Clock()
    good = GoodTuning(clock)
    for state in ("connected", "ready", "armed"):
        assert not good.enter(state, tuning)  # type: ignore[arg-type]
    return good, clock


@pytest.mark.parametrize(("after_s", "expected"), [(PROVED_S - 0.01, None), (PROVED_S, A)])
def test_a_tuning_is_good_once_it_ran_five_seconds_without_a_fault(after_s: float, expected: Tuning | None) -> None:
    good, clock = armed()
    clock.now += after_s
    good.watch()
    assert good.last == expected


def test_a_fault_asks_for_the_good_tuning_only_where_another_one_was_being_tried() -> None:
    good, clock = armed()
    assert not good.enter("fault", A)  # none has proved itself yet
    for state in ("ready", "armed"):
        good.enter(state, A)  # type: ignore[arg-type]
    clock.now += PROVED_S
    good.install(B)
    clock.now += 1.0
    good.enter("running", B)  # moving is no new beginning
    assert good.enter("fault", B)
    assert good.last == A
    assert not good.enter("fault", A)


def test_moving_and_holding_are_one_stretch_and_a_quiet_end_of_a_trial_is_no_fault_of_it() -> None:
    good, clock = armed()
    for state in ("running", "armed"):
        clock.now += PROVED_S / 2.0
        good.enter(state, A)  # type: ignore[arg-type]
    assert good.last == A
    good.install(B)
    clock.now += 1.0
    good.enter("stopping", B)
    good.enter("ready", B)
    assert not good.enter("fault", B)


def test_a_good_tuning_keeps_its_rank_through_a_fault() -> None:
    good, clock = armed()
    clock.now += PROVED_S
    good.install(B)
    clock.now += PROVED_S
    assert not good.enter("fault", B)
    assert good.last == B


def test_braking_before_the_fault_does_not_hide_it_and_time_with_the_drives_off_proves_nothing() -> None:
    good, clock = armed()
    clock.now += PROVED_S
    good.install(B)
    good.enter("stopping", B)
    clock.now += 2 * PROVED_S
    assert good.enter("fault", B)
    good.enter("ready", B)
    clock.now += 2 * PROVED_S
    assert not good.enter("fault", B)  # the drives were off: not the tuning's doing
    assert good.last == A


def test_a_session_goes_back_to_the_good_tuning_as_a_change_and_stays_at_fault(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.to("armed")
        await bench.passed(PROVED_S + 0.1)
        proved = bench.session.scenario.tuning
        await bench.ask("tune", changes={"observer.bandwidth": 170.0})
        await bench.passed(1.0)
        asked = len(bench.rig.asked)
        bench.rig.fail(18)
        await bench.settled()
        install = bench.rig.asked[asked]
        assert isinstance(install, messages.Install)
        assert install.tuning == proved == bench.session.scenario.tuning
        assert bench.snapshot()["state"] == "fault"
        assert len(bench.rig.asked) == asked + 1  # no reset, nothing armed
        entry = bench.session.history.last(1)[0]
        assert (entry["by"], entry["part"], entry["words"]) == ("session", "tuning", ["g 170 → 100 rad/s"])
        assert bench.told_of("document")[-1]["tuning_id"] == install.tuning_id == bench.snapshot()["tuning_id"]
        assert any(text.startswith("back to the last tuning that ran 5 s") for text in bench.events("tuning"))

    at_rig(data_dir, work)


def test_a_simulation_keeps_the_tuning_that_diverged(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.ask("reset")
        await bench.passed(PROVED_S + 0.1)
        await bench.ask("tune", changes={"observer.bandwidth": 90.0})
        tuning = bench.session.scenario.tuning
        await bench.ask("set_disturbances", replace={"link": [{"kind": "constant", "torque": 200.0}]})
        assert bench.switching.simulation is not None
        for _ in range(3000):
            bench.switching.simulation.turn()
        await bench.settled()
        assert (bench.snapshot()["state"], bench.session.scenario.tuning) == ("fault", tuning)

    at_rig(data_dir, work)
