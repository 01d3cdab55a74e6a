"""One core stays free of the workers while a rig is under torque, and is given back; the setter is injected."""

import os
import sys
from pathlib import Path

import pytest

from backend.session.spare_core import SpareCore, bind_process
from tests.backend.rig_bench import RigBench, at_rig


class Machine:
    def __init__(self, cores: int = 4) -> None:
        self.cores, self.workers = frozenset(range(cores)), [11, 12]
        self.bound: dict[int, frozenset[int]] = {}
        self.refuses: set[int] = set()
        self.calls = 0

    def bind(self, pid: int, cores: frozenset[int]) -> None:
        self.calls += 1
        if pid in self.refuses:
            raise PermissionError
        self.bound[pid] = cores

    def spare(self) -> SpareCore:
        return SpareCore(lambda: self.workers, self.bind, self.cores)


def test_workers_leave_a_core_free_also_those_that_start_later_and_get_it_back() -> None:
    machine = Machine()
    spare = machine.spare()
    assert spare.core is None
    spare.keep()
    machine.workers.append(13)
    spare.keep()
    assert machine.bound == dict.fromkeys((11, 12, 13), frozenset({0, 1, 2}))
    assert (spare.core, machine.calls) == (3, 3)  # each once
    machine.workers.remove(11)
    spare.give_back()
    assert (machine.bound[12], machine.bound[13], spare.core) == (machine.cores, machine.cores, None)
    assert machine.bound[11] == frozenset({0, 1, 2})  # it is no more


def test_another_process_with_the_number_of_one_that_ended_is_bound_too() -> None:
    machine = Machine()
    spare = machine.spare()
    spare.keep()
    machine.workers = [12]
    spare.keep()
    machine.workers = [11, 12]
    spare.keep()
    assert machine.calls == 3


def test_where_it_is_refused_or_there_is_one_core_everything_goes_on() -> None:
    machine = Machine()
    machine.refuses = {11, 12}
    spare = machine.spare()
    spare.keep()
    spare.give_back()
    assert spare.core is None
    single = Machine(1)
    single.spare().keep()
    assert single.calls == 0


@pytest.mark.parametrize(("state", "kept"), [("armed", True), ("running", True), ("homing", True), ("stopping", True),
                                             ("ready", False), ("stopped", False), ("fault", False)])  # fmt: skip
def test_a_core_is_kept_free_in_the_states_with_torque_and_the_snapshot_says_so(
    data_dir: Path, state: str, kept: bool
) -> None:
    async def work(bench: RigBench) -> None:
        machine = Machine()
        bench.session.rig.cores = machine.spare()
        await bench.to("ready")
        bench.rig.become("homing")  # whatever was before
        assert bench.snapshot()["loop"]["free_core"] == 3
        bench.rig.become("ready")
        bench.rig.become(state)  # type: ignore[arg-type]
        assert bench.snapshot()["loop"]["free_core"] == (3 if kept else None)
        await bench.ask("disconnect_rig")
        assert bench.snapshot()["loop"]["free_core"] is None
        assert set(machine.bound.values()) == {machine.cores}

    at_rig(data_dir, work)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="Linux only")
def test_a_process_is_bound_with_all_its_threads() -> None:
    import threading

    cores = os.sched_getaffinity(0)
    done = threading.Event()
    seen: list[set[int]] = []
    asked = threading.Event()

    def look() -> None:
        asked.wait(10.0)
        seen.append(os.sched_getaffinity(0))
        done.set()

    thread = threading.Thread(target=look)
    thread.start()
    try:
        bind_process(os.getpid(), {min(cores)})
        asked.set()
        assert done.wait(10.0)
        assert seen == [{min(cores)}] == [os.sched_getaffinity(0)]
    finally:
        bind_process(os.getpid(), cores)
        thread.join()
