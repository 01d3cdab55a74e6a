"""What is kept of a fault: 2 s before and 1 s after it, as an excerpt of the recording; in injected time."""

from pathlib import Path
from typing import Any

import pytest

from backend.session.excerpt import ExcerptsInMemory
from tests.backend.rig_bench import RigBench, at_rig
from vssea_core.channels import INDEX


class Recorded:
    def of_run(self, epoch: int) -> str | None:
        return f"run-{epoch}"


RECORDED: dict[str, Any] = {"recordings": Recorded()}


def faults(bench: RigBench) -> list[dict[str, Any]]:
    return [pin for pin in bench.session.pins.message()["pins"] if pin["kind"] == "fault"]


async def measured(bench: RigBench, duration_s: float, **channels: float) -> None:
    """Let the rig measure on while the session watches."""
    for _ in range(round(duration_s / 0.1)):
        bench.rig.measure(50, **channels)
        await bench.passed(0.1)


def test_a_rig_is_measured_on_and_two_seconds_before_and_one_after_a_fault_are_kept(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.to("armed")
        await measured(bench, 5.0, error=0.001)
        bench.rig.fail(4)
        await measured(bench, 0.5, error=0.05)
        bench.rig.state = "stopped"
        bench.rig.fail(1)  # of the same cause: it belongs to the first
        await measured(bench, 0.4, error=0.05)
        assert faults(bench) == []
        await measured(bench, 0.3, error=0.05)
        (kept,) = faults(bench)
        assert (kept["from_s"], kept["at_s"], kept["to_s"]) == (
            pytest.approx(3.0),
            pytest.approx(5.0),
            pytest.approx(6.0),
        )
        assert (kept["recording"], kept["shown"]) == (f"run-{bench.rig.epoch}", False)
        assert kept["label"].startswith("Fault 4: The link encoder has been silent")
        assert kept["metrics"]["peak_error"] == 0.05
        assert bench.told_of("pins")[-1]["pins"] == bench.session.pins.message()["pins"]
        assert bench.events("pin") == ["kept of the fault: 3.000 s to 6.000 s of this recording"]
        await measured(bench, 2.0)
        assert len(faults(bench)) == 1

    at_rig(data_dir, work, **RECORDED)


def test_a_fault_of_which_no_more_samples_come_is_kept_to_the_last_one(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.to("armed")
        await measured(bench, 1.0)
        bench.switching.die()
        await bench.passed(0.3)
        assert faults(bench) == []
        await bench.passed(0.3)
        (kept,) = faults(bench)
        assert (kept["from_s"], kept["to_s"]) == (0.0, pytest.approx(1.0, abs=0.003))

    at_rig(data_dir, work, **RECORDED)


def test_a_fault_of_the_simulation_is_kept_too(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        load = [{"kind": "constant", "torque": 200.0}]
        await bench.ask("set_disturbances", replace={"link": load})
        assert bench.switching.simulation is not None
        for _ in range(3000):
            bench.switching.simulation.turn()
        assert bench.snapshot()["state"] == "fault"
        await bench.passed(0.6)
        (kept,) = faults(bench)
        newest = bench.session.ring.latest()
        assert newest is not None
        assert kept["to_s"] == pytest.approx(float(newest[INDEX["time"]]), abs=0.002)
        assert kept["label"].startswith("Fault: Diverged")

    at_rig(data_dir, work, **RECORDED)


def test_the_newest_twenty_faults_are_kept_and_triggers_and_pins_stay_beside_them(data_dir: Path) -> None:
    store = ExcerptsInMemory()

    async def work(bench: RigBench) -> None:
        await bench.to("armed")
        await measured(bench, 0.2)
        await bench.ask("pin", label="mine")
        pins = bench.session.pins
        for number in range(22):
            await pins.keep_capture(f"fault {number}", "session", bench.rig.epoch, 0.0, 0.1, 0.05, kind="fault")
        await pins.keep_capture("captured", "page 1", bench.rig.epoch, 0.0, 0.1, 0.05)
        labels = [excerpt.label for excerpt in store.list()]
        assert labels == ["mine", *(f"fault {number}" for number in range(2, 22)), "captured"]

    at_rig(data_dir, work, excerpts=store, **RECORDED)


def test_a_trigger_on_a_rig_still_sees_what_comes_after_a_fault(data_dir: Path) -> None:
    async def work(bench: RigBench) -> None:
        await bench.to("armed")
        await measured(bench, 1.0)
        source = {"kind": "event", "event": "fault"}
        await bench.ask("arm_trigger", source=source, before_s=0.5, after_s=0.5)
        bench.rig.fail(4)
        bench.session.trigger.watch()
        assert bench.session.trigger.message()["state"] == "fired"
        await measured(bench, 0.6)
        bench.session.trigger.watch()
        await bench.settled()
        excerpt = bench.session.trigger.message()["excerpt"]
        assert excerpt["to_s"] == pytest.approx(1.5)

    at_rig(data_dir, work, **RECORDED)
