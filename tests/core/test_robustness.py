"""Borders around a tuning, the warning they give, and the certificate by simulation."""

import math
from dataclasses import replace

import pytest

from tests.core.operating_points import OBSERVERS, realistic
from vssea_core.analysis.axes import changed
from vssea_core.analysis.certify import certify
from vssea_core.analysis.loop import loop_model
from vssea_core.analysis.margins import BreakMargins, margins
from vssea_core.analysis.operating_point import OperatingPoint
from vssea_core.analysis.robustness import FACTORS, Robustness, StableRange, robustness
from vssea_core.analysis.warning import ThinMargin, warning
from vssea_core.control.tuning import Observer, VelocityObserver

observers = pytest.mark.parametrize("observer", OBSERVERS.values(), ids=OBSERVERS)


def with_factor(point: OperatingPoint, name: str, factor: float) -> OperatingPoint:
    return replace(point, plant=point.plant.scaled(**{name: factor}))


@observers
@pytest.mark.parametrize("name", FACTORS)
def test_the_loop_is_stable_up_to_the_border_and_unstable_behind_it(observer: Observer, name: str) -> None:
    point = realistic(observer)
    found = getattr(robustness(point), name)
    for border, outward in ((found.below, 1.0 / 1.002), (found.above, 1.002)):
        if border is None:
            continue
        assert not loop_model(with_factor(point, name, border * outward)).stable
        for share in (0.2, 0.4, 0.6, 0.8, 1.0):
            assert loop_model(with_factor(point, name, border**share)).stable


@observers
@pytest.mark.parametrize("delay", [0, 1])
def test_the_delay_border_of_the_eigenvalues_is_the_delay_margin(observer: Observer, delay: int) -> None:
    """A fraction of a sample changes the hold as well, so the margin, a pure phase, differs by some tenths of a per cent."""
    found = robustness(realistic(observer, delay))
    assert found.margins.plant is not None
    assert found.delay_s == pytest.approx(found.margins.plant.delay_s, rel=5e-3)


def test_at_a_whole_number_of_samples_the_delay_margin_is_exact() -> None:
    """A bandwidth is looked for whose delay margin is just two samples; there the eigenvalues are on the circle."""
    low, high = 100.0, 300.0
    for _ in range(40):
        middle = math.sqrt(low * high)
        found = margins(loop_model(realistic(VelocityObserver(bandwidth=middle), delay=0))).plant
        assert found is not None
        low, high = (middle, high) if found.delay_s > 2e-3 else (low, middle)
    point = realistic(VelocityObserver(bandwidth=low), delay=0)
    assert loop_model(replace(point, plant=point.plant.with_delay(2e-3))).radius == pytest.approx(1.0, abs=1e-8)


@observers
def test_simulations_agree_on_either_side_of_a_border(observer: Observer) -> None:
    point = realistic(observer)
    found = robustness(point)
    for name in FACTORS:
        border = getattr(found, name).above
        if border is None:
            continue
        for step, stable in ((0.96, True), (1.04, False)):
            seen = certify(with_factor(point, name, border * step))
            assert seen.predicted_stable is stable
            assert seen.agreed, (name, step, seen.reason)
            assert seen.seen_growth == pytest.approx(seen.predicted_growth, rel=0.1, abs=0.1)


def test_an_unstable_tuning_has_no_borders() -> None:
    found = robustness(realistic(link_inertia=3.0))
    assert found.link_inertia is None
    assert found.delay_s is None
    assert found.document()["link_inertia"] is None
    told = warning(found)
    assert told is not None
    assert "unstable" in told.sentence


def ample() -> Robustness:
    wide = StableRange(0.2, 5.0)
    numbers = BreakMargins(4.0, 300.0, 0.2, 30.0, 1.0, 100.0, 0.01, 100.0, 1.0, 100.0, 1.2, 100.0, (100.0,))
    found = margins(loop_model(realistic()))
    return Robustness(
        wide, wide, wide, 0.01, replace(found, plant=numbers, limiter=replace(numbers, gain_down=0.0)), 1e-3
    )


THIN: dict[str, tuple[dict[str, object], str]] = {
    "heavier": ({"link_inertia": StableRange(0.3, 1.18)}, "unstable if the link is 18 % heavier than assumed"),
    "lighter": ({"link_inertia": StableRange(0.9, 2.0)}, "unstable if the link is 10 % lighter than assumed"),
    "softer": ({"spring_constant": StableRange(0.88, None)}, "unstable if the spring is 12 % softer than assumed"),
    "stiffer": ({"spring_constant": StableRange(None, 1.05)}, "unstable if the spring is 5 % stiffer than assumed"),
    "later": ({"delay_s": 7.5e-4}, "unstable if the torque comes 0.75 ms (0.75 samples) later"),
}


@pytest.mark.parametrize(("changes", "sentence"), THIN.values(), ids=THIN)
def test_a_thin_margin_is_told_in_one_plain_sentence_with_its_direction(
    changes: dict[str, object], sentence: str
) -> None:
    told = warning(replace(ample(), **changes))
    assert told is not None
    assert told.sentence == sentence
    assert 0.0 < told.share < 1.0


def test_ample_margins_give_no_warning() -> None:
    assert warning(ample()) is None


def test_the_nearest_of_several_dangers_is_told() -> None:
    both = replace(ample(), link_inertia=StableRange(0.5, 1.2), spring_constant=StableRange(0.97, 2.0))
    told = warning(both)
    assert isinstance(told, ThinMargin)
    assert told.concerns == "spring_constant"


def test_gain_phase_and_saturation_have_sentences_of_their_own() -> None:
    found = ample()
    plant, limiter = found.margins.plant, found.margins.limiter
    assert plant is not None
    assert limiter is not None
    for changes, concerns in (
        ({"plant": replace(plant, gain_up=1.2)}, "gain"),
        ({"plant": replace(plant, phase=0.1)}, "phase"),
        ({"limiter": replace(limiter, gain_down=0.8)}, "saturation"),
    ):
        told = warning(replace(found, margins=replace(found.margins, **changes)))
        assert told is not None
        assert told.concerns == concerns


@observers
def test_more_mismatch_brings_the_warning(observer: Observer) -> None:
    """Stepping the true link inertia towards its border, the warning comes before the loop is lost, and names the link."""
    border = robustness(realistic(observer)).link_inertia
    assert border is not None
    assert border.above is not None
    told = warning(robustness(changed(realistic(observer), {"link_inertia": border.above / 1.1})))
    assert told is not None
    assert told.concerns == "link_inertia"
    assert "heavier" in told.sentence
