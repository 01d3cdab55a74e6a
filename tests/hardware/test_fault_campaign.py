"""A short version of the fault campaign: page, server, control process, bus and emulated plant, broken one after the other.

The whole of it, with its figures: python -m benchmarks faults. The deadlines are tested in injected time elsewhere.
"""

from collections.abc import Iterator

import pytest

from benchmarks.rigs.breakages import BREAKAGES
from benchmarks.rigs.campaign import Bench, outcome

pytestmark = pytest.mark.real_time

SHORT = {
    "motor drive fault": "tracking",
    "link lost": "jogging",
    "stiffness end stop hit": "idle",
    "control process killed": "tracking",
    "browser gone": "jogging",
    "tab hidden": "tracking",
    "network cut": "changing stiffness",
    "web process killed": "jogging",
}
BY_NAME = {breakage.name: breakage for breakage in BREAKAGES}


@pytest.fixture(scope="module")
def bench() -> Iterator[Bench]:
    with Bench(rate_hz=250) as bench:
        yield bench


@pytest.mark.parametrize(("name", "activity"), SHORT.items(), ids=SHORT)
def test_whatever_breaks_the_torque_goes_off_and_stays_off(bench: Bench, name: str, activity: str) -> None:
    found = outcome(BY_NAME[name], activity, *bench.mended())
    assert found.safe_after_s is not None, found.row
    assert not found.re_armed, found.row
    assert found.state in ("fault", "stopped", "gone"), found.row
