"""Margins: python-control on frequency data, the border of eigenvalues, simulations, and Bode's integral."""

import math

import control
import numpy as np
import pytest

from tests.core.operating_points import OBSERVERS, realistic, with_actuator_gain
from vssea_core.analysis.certify import certify
from vssea_core.analysis.loop import System, loop_model
from vssea_core.analysis.margins import BreakMargins, margins
from vssea_core.analysis.operating_point import OperatingPoint
from vssea_core.control.tuning import Observer, PositionObserver, SlidingMode, Tuning, VelocityObserver

PERIOD = 1e-3
CASES = {
    "velocity": realistic(VelocityObserver(), delay=0, lag_s=0.0),
    "velocity, delay": realistic(VelocityObserver(bandwidth=200.0)),
    "position": realistic(PositionObserver(), delay=0),
    "position, soft": realistic(PositionObserver(bandwidth=60.0), stiffness=50.0),
    "heavy link": realistic(PositionObserver(), link_inertia=1.4),
    "differences": realistic(VelocityObserver(bandwidth=50.0, velocity_source="difference")),
}
cases = pytest.mark.parametrize("point", CASES.values(), ids=CASES)


def breaks(point: OperatingPoint) -> list[tuple[BreakMargins, System]]:
    loop = loop_model(point)
    found = margins(loop)
    assert found.plant is not None
    assert found.limiter is not None
    return [(found.plant, loop.broken_at_plant()), (found.limiter, loop.broken_at_limiter())]


def frequency_data(system: System, points: int = 2000) -> tuple[control.FrequencyResponseData, np.ndarray]:
    w = np.geomspace(1.0, 0.9999 * math.pi / PERIOD, points)
    return control.frd(control.ss(*system, PERIOD)(np.exp(1j * w * PERIOD)), w, smooth=True), w


@cases
def test_gain_and_phase_margins_are_those_of_python_control_on_frequency_data(point: OperatingPoint) -> None:
    for found, system in breaks(point):
        data, _ = frequency_data(system)
        gains, phases, _, gains_at, phases_at, _ = control.stability_margins(data, returnall=True)
        up, down = gains[gains > 1.0], gains[gains < 1.0]
        if len(up):
            assert found.gain_up <= up.min() * (1.0 + 1e-6)
            assert found.gain_up == pytest.approx(up.min(), rel=1e-5) or found.gain_up_frequency > 3141.0
        if len(down):
            assert found.gain_down == pytest.approx(down.max(), rel=1e-5)
            assert found.gain_down_frequency == pytest.approx(gains_at[gains < 1.0][np.argmax(down)], rel=1e-5)
        assert found.phase == pytest.approx(math.radians(np.abs(phases).min()), rel=1e-5)
        assert found.crossovers == pytest.approx(sorted(phases_at), rel=1e-6)


@cases
def test_disk_margin_and_its_guarantees_are_those_of_python_control(point: OperatingPoint) -> None:
    for found, system in breaks(point):
        _, w = frequency_data(system)
        disk, gain_db, phase_degrees = control.disk_margins(control.ss(*system, PERIOD), w, skew=0.0)
        assert found.disk == pytest.approx(disk, rel=1e-5)
        assert found.disk <= disk * (1.0 + 1e-9)
        if disk < 2.0:
            assert 20.0 * math.log10(found.disk_gain[1]) == pytest.approx(gain_db, rel=1e-5)
        assert math.degrees(found.disk_phase) == pytest.approx(phase_degrees, rel=1e-5)


@cases
def test_at_a_gain_margin_the_loop_closed_again_sits_on_the_unit_circle(point: OperatingPoint) -> None:
    for found, (A, B, C, _) in breaks(point):
        for gain, at in (
            (found.gain_up, found.gain_up_frequency),
            (found.gain_down, found.gain_down_frequency),
        ):
            if math.isfinite(gain) and gain > 0.0:
                multipliers = np.linalg.eigvals(A - gain * B @ C)
                border = multipliers[np.argmin(np.abs(multipliers - np.exp(1j * at * PERIOD)))]
                assert abs(border) == pytest.approx(1.0, abs=1e-7)
                between = np.linalg.eigvals(A - (0.5 + 0.5 * gain) * B @ C)
                assert np.abs(between).max() < 1.0, "stable from 1 up to the margin"


@cases
def test_no_rotation_or_gain_within_the_disk_reaches_the_border(point: OperatingPoint) -> None:
    for found, system in breaks(point):
        low, high = found.disk_gain
        assert found.gain_up >= high * (1.0 - 1e-9)
        assert found.gain_down <= low * (1.0 + 1e-9)
        assert found.phase >= found.disk_phase * (1.0 - 1e-9)
        S = 1.0 / (1.0 + frequency_data(system)[0].frdata[0, 0])
        assert np.abs(S).max() <= found.sensitivity_peak * (1.0 + 1e-9)


@pytest.mark.parametrize("observer", OBSERVERS.values(), ids=OBSERVERS)
@pytest.mark.parametrize("side", ["gain_up", "gain_down"])
def test_a_drive_that_gives_that_much_torque_is_the_border_in_simulation(observer: Observer, side: str) -> None:
    """One per cent inside the margin the nonlinear simulation decays, one per cent outside it grows."""
    point = realistic(observer)
    found = margins(loop_model(point)).plant
    assert found is not None
    gain = getattr(found, side)
    outward = 1.01 if side == "gain_up" else 1.0 / 1.01
    inside, outside = (certify(with_actuator_gain(point, gain * step)) for step in (1.0 / outward, outward))
    assert inside.seen_growth < 0.0 < outside.seen_growth
    assert inside.agreed
    assert outside.agreed


@cases
def test_the_sensitivity_obeys_bodes_integral(point: OperatingPoint) -> None:
    """The integral of ln|S| over the unit circle is pi times the logs of the unstable open poles: there is no free lunch."""
    for _, system in breaks(point):
        A = system[0]
        open_poles = np.abs(np.linalg.eigvals(A))
        unstable = open_poles[
            open_poles > 1.0 + 1e-4
        ]  # the observer's integrators sit on the circle, split by rounding
        angle = np.concatenate([np.geomspace(1e-7, 0.05, 20000), np.linspace(0.05, math.pi, 40000)[1:]])
        L = control.ss(*system, PERIOD)(np.exp(1j * angle))
        integral = np.trapezoid(-np.log(np.abs(1.0 + L)), angle)
        assert integral == pytest.approx(math.pi * np.sum(np.log(unstable)), abs=2e-3)


def test_an_unstable_loop_is_told_to_have_no_margins() -> None:
    found = margins(loop_model(realistic(link_inertia=3.0)))
    assert not found.stable
    assert found.plant is None
    assert found.limiter is None
    assert found.note is not None
    assert "unstable" in found.note
    assert found.document()["plant"] is None


def test_sliding_mode_is_judged_inside_its_layer_and_says_so() -> None:
    point = realistic()
    sliding = point.tuning.model_copy(update={"controller": SlidingMode()})
    found = margins(loop_model(OperatingPoint(sliding, point.timing, 200.0, point.plant)))
    assert found.stable
    assert found.note is not None
    assert "inside its boundary layer only" in found.note


def test_sgn_has_no_margins_and_the_reason_is_given() -> None:
    point = realistic()
    sgn = Tuning(controller=SlidingMode(switch="sgn"))
    with pytest.raises(ValueError, match="sgn has no linearisation"):
        loop_model(OperatingPoint(sgn, point.timing, 200.0, point.plant))
