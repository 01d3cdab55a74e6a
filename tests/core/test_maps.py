"""Maps, bandwidth sets and worst cases: consistent with the analysis of single points, and cancelled when asked."""

import math
from itertools import pairwise

import numpy as np
import pytest

from tests.core.operating_points import OBSERVERS, realistic
from vssea_core.analysis.axes import AXES, changed
from vssea_core.analysis.bandwidth_sets import LeastMargins, bandwidth_sets
from vssea_core.analysis.certify import certify
from vssea_core.analysis.loop import loop_model
from vssea_core.analysis.maps import map_axis, margin_map, stability_map
from vssea_core.analysis.margins import margins
from vssea_core.analysis.prepared_rows import PreparedRows
from vssea_core.analysis.progress import Cancelled
from vssea_core.analysis.worst_case import worst_case
from vssea_core.control.prepared import prepare
from vssea_core.control.tuning import Observer, SlidingMode, VelocityObserver

observers = pytest.mark.parametrize("observer", OBSERVERS.values(), ids=OBSERVERS)
PAIRS = [
    ("spring", "link_inertia"),
    ("stiffness", "bandwidth"),
    ("bandwidth", "stiffness"),
    ("motor_inertia", "delay_s"),
    ("delay_s", "motor_inertia"),
    ("poles", "bandwidth"),
    ("link_inertia", "poles"),
    ("torque_lag_s", "link_damping"),
]


@observers
@pytest.mark.parametrize(("x", "y"), PAIRS)
def test_every_cell_is_what_the_analysis_of_that_point_says(observer: Observer, x: str, y: str) -> None:
    point = realistic(observer)
    across, up = map_axis(x, 4), map_axis(y, 3)
    stability, found = stability_map(point, across, up), margin_map(point, across, up)
    for row, value in enumerate(up.values):
        for column, other in enumerate(across.values):
            loop = loop_model(changed(point, {x: other, y: value}))
            assert stability.stable[row, column] == loop.stable
            assert stability.growth[row, column] == pytest.approx(math.log(loop.radius) / 1e-3, rel=1e-6, abs=1e-3)
            single = margins(loop)
            if single.plant is None or single.limiter is None:
                assert math.isnan(found.disk[row, column])
                continue
            both = (single.plant, single.limiter)
            assert found.disk[row, column] == pytest.approx(min(each.disk for each in both), rel=1e-5)
            assert found.phase[row, column] == pytest.approx(min(each.phase for each in both), rel=1e-6)
            assert found.delay_s[row, column] == pytest.approx(min(each.delay_s for each in both), rel=1e-6)
            assert found.gain_up[row, column] == pytest.approx(min(each.gain_up for each in both), rel=1e-6)
            assert found.gain_down[row, column] == pytest.approx(max(each.gain_down for each in both), rel=1e-6)


def test_workers_change_nothing() -> None:
    point = realistic()
    axes = map_axis("spring", 7), map_axis("link_inertia", 5)
    assert np.array_equal(stability_map(point, *axes, workers=1).growth, stability_map(point, *axes, workers=3).growth)


def test_swapping_the_axes_transposes_the_map() -> None:
    point = realistic(VelocityObserver())
    one, other = map_axis("stiffness", 5), map_axis("bandwidth", 6)
    assert stability_map(point, one, other).growth == pytest.approx(stability_map(point, other, one).growth.T, abs=1e-6)


def test_more_delay_never_raises_the_delay_margin() -> None:
    found = margin_map(realistic(VelocityObserver()), map_axis("delay_s", 8, 0.0, 1.5e-3), map_axis("stiffness", 2))
    assert np.all(np.diff(found.delay_s, axis=1) < 0.0)


def test_a_link_of_twice_the_inertia_leaves_islands_of_bandwidth() -> None:
    """Theory, section 6: there is no single border in g; simulations agree inside each island and in the gap."""
    point = realistic(VelocityObserver())
    (found,) = bandwidth_sets(point, [200.0], [{"link_inertia": 2.0}]).sets
    assert len(found.intervals) == 2, found.intervals
    (low, edge), (lower_border, _) = found.intervals
    heavy = changed(point, {"link_inertia": 2.0})
    for g, stable in (
        (math.sqrt(low * edge), True),
        (math.sqrt(edge * lower_border), False),
        (2.0 * lower_border, True),
    ):
        seen = certify(changed(heavy, {"bandwidth": g}))
        assert seen.predicted_stable is stable
        assert seen.agreed, (g, seen.reason)
    assert bandwidth_sets(point, [200.0]).sets[0].intervals == ((5.0, 1000.0),), "without mismatch no border at all"


@observers
def test_every_end_of_a_bandwidth_interval_is_a_border(observer: Observer) -> None:
    point = changed(realistic(observer), {"stiffness": 50.0})
    (found,) = bandwidth_sets(point, [50.0], [{"link_inertia": 2.0}]).sets
    heavy = changed(point, {"link_inertia": 2.0})
    for low, high in found.intervals:
        for inside, outside in ((low, low / 1.004), (high, high * 1.004)):
            assert loop_model(changed(heavy, {"bandwidth": inside})).stable
            if 5.0 < inside < 1000.0:
                assert not loop_model(changed(heavy, {"bandwidth": outside})).stable


def test_asking_for_margins_or_for_more_plants_only_takes_away() -> None:
    point = realistic()
    plain = bandwidth_sets(point, [200.0], [{"link_inertia": 1.5}]).sets[0].intervals
    asked = bandwidth_sets(point, [200.0], [{"link_inertia": 1.5}], LeastMargins(disk=0.2)).sets[0].intervals
    more = bandwidth_sets(point, [200.0], [{"link_inertia": 1.5}, {"link_inertia": 0.5}]).sets[0].intervals
    assert plain

    def within(parts: tuple[tuple[float, float], ...], g: float) -> bool:
        return any(low <= g <= high for low, high in parts)

    for fewer in (asked, more):
        assert fewer != plain
        for low, high in fewer:
            assert within(plain, low * 1.003)
            assert within(plain, high / 1.003)
        assert all(a[1] < b[0] for a, b in pairwise(fewer))


@pytest.mark.parametrize("criterion", ["growth", "disk"])
def test_the_worst_case_is_no_better_than_any_point_of_a_grid(criterion: str) -> None:
    point = realistic(VelocityObserver())
    box = {"link_inertia": (0.8, 1.5), "spring": (0.8, 1.2), "delay_s": (0.0, 5e-4)}
    found = worst_case(point, box, criterion)  # type: ignore[arg-type]
    for link in (0.8, 1.1, 1.5):
        for spring in (0.8, 1.0, 1.2):
            for delay in (0.0, 2.5e-4, 5e-4):
                there = changed(point, {"link_inertia": link, "spring": spring, "delay_s": delay})
                loop = loop_model(there)
                if criterion == "growth":
                    assert found.growth >= math.log(loop.radius) / 1e-3 - 1e-6
                else:
                    single = margins(loop)
                    assert single.plant is not None
                    assert found.disk is not None
                    assert found.disk <= single.plant.disk * (1.0 + 1e-6)
    at = loop_model(changed(point, found.values))
    assert found.growth == pytest.approx(math.log(at.radius) / 1e-3)
    assert found.evaluations > 100
    assert all(low <= found.values[name] <= high for name, (low, high) in box.items())


def test_a_worst_case_that_is_unstable_is_seen_in_simulation() -> None:
    point = realistic()
    found = worst_case(point, {"link_inertia": (0.6, 2.2), "spring": (0.8, 1.25)})
    assert not found.stable
    assert found.disk is None
    assert certify(changed(point, found.values)).agreed


def test_cancelling_stops_between_rows_and_gives_nothing() -> None:
    point = realistic()
    told: list[float] = []

    def stop_halfway(share: float) -> bool:
        told.append(share)
        return share < 0.5

    with pytest.raises(Cancelled, match="cancelled after 5"):
        stability_map(point, map_axis("spring", 5), map_axis("link_inertia", 20), stop_halfway)
    assert told == sorted(told)
    assert told[0] == 0.0
    assert len(told) <= 12
    with pytest.raises(Cancelled):
        worst_case(point, {"link_inertia": (0.9, 1.1)}, progress=lambda share: False)
    with pytest.raises(Cancelled):
        bandwidth_sets(point, [100.0, 200.0], progress=lambda share: share == 0.0)


def test_progress_ends_at_one() -> None:
    told: list[float] = []
    margin_map(realistic(), map_axis("spring", 2), map_axis("link_inertia", 3), lambda share: not told.append(share))
    assert told[-1] == 1.0


def test_bad_requests_are_refused_in_one_sentence() -> None:
    point = realistic()
    axis = map_axis("spring", 3)
    with pytest.raises(ValueError, match="expected one of spring"):
        map_axis("mass", 3)
    with pytest.raises(ValueError, match="expected two different ones"):
        stability_map(point, axis, axis)
    with pytest.raises(ValueError, match="ascending range above zero"):
        map_axis("bandwidth", 3, 0.0, 10.0)
    with pytest.raises(ValueError, match="expected at least 1"):
        map_axis("bandwidth", 0)
    with pytest.raises(ValueError, match="use fewer values"):
        stability_map(point, map_axis("spring", 1000), map_axis("link_inertia", 1000))
    with pytest.raises(ValueError, match="does not change the plant"):
        bandwidth_sets(point, [200.0], [{"poles": 10.0}])
    with pytest.raises(ValueError, match="box is empty"):
        worst_case(point, {})
    with pytest.raises(ValueError, match="expected an ascending range"):
        worst_case(point, {"spring": (1.2, 0.8)})


def test_every_axis_has_a_range_in_which_a_map_can_be_made() -> None:
    for name, axis in AXES.items():
        assert axis.low < axis.high
        other = "link_inertia" if name != "link_inertia" else "spring"
        found = stability_map(realistic(), map_axis(name, 3), map_axis(other, 2))
        assert np.isfinite(found.growth).all()
        document = found.document()
        assert len(document["growth"]) == 2
        assert document["x"]["label"] == axis.label


def test_a_map_of_sliding_mode_says_where_it_holds() -> None:
    point = realistic()
    sliding = point.tuning.model_copy(update={"controller": SlidingMode()})
    found = stability_map(
        type(point)(sliding, point.timing, 200.0, point.plant), map_axis("poles", 2), map_axis("spring", 2)
    )
    assert found.note is not None
    assert "boundary layer" in found.note


def test_poles_and_bandwidth_are_prepared_apart_and_put_together_to_the_bit() -> None:
    point = realistic()
    across, up = map_axis("poles", 4), map_axis("bandwidth", 3)
    rows = PreparedRows(point, across, up)
    assert rows.separable, "else every cell is prepared, which takes ten times as long"
    for index, g in enumerate(up.values):
        for found, p in zip(rows.of_row(index), across.values, strict=True):
            assert np.array_equal(found, prepare(changed(point, {"poles": p, "bandwidth": g}).tuning, 1e-3))
