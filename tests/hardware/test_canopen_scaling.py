"""Between SI at the gear side and a drive's units."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from backend.rigs.canopen.scaling import INT16_MAX, LinkPosition, MotorPosition, TorqueScale, wrapped
from tests.hardware.fake_rig import GEAR_RATIO, RIG_FILE

signs = st.sampled_from([1, -1])
torques = st.floats(-200.0, 200.0)


def scale(sign: int = 1, limit: float = 74.0) -> TorqueScale:
    return TorqueScale(0.533, GEAR_RATIO, 0.7, sign, limit)


@given(torques, signs)
def test_what_is_sent_is_within_half_a_unit_or_at_the_limit(torque: float, sign: int) -> None:
    there = scale(sign)
    units = there.units(torque)
    unit = 0.533 * GEAR_RATIO * 0.7 / 1000.0
    if abs(torque) <= there.limit * unit:
        assert abs(there.torque(units) - torque) <= 0.5 * unit * (1.0 + 1e-9)
    else:
        assert units == math.copysign(there.limit, sign * torque)
    assert abs(there.torque(units)) <= 74.0 * (1.0 + 1e-9)


def test_a_rated_motor_torque_is_a_thousand_units_with_the_sign_of_the_file() -> None:
    assert scale().units(0.533 * 70.0) == 1000
    assert scale(-1).units(0.533 * 70.0) == -1000
    assert scale(-1).torque(-1000) == pytest.approx(0.533 * 70.0)


@pytest.mark.parametrize("torque", [math.inf, 1e30])
def test_too_much_saturates_and_no_number_is_no_torque(torque: float) -> None:
    assert scale().units(torque) == -scale().units(-torque) == scale().limit
    assert scale(limit=1e9).units(torque) == INT16_MAX
    assert scale().units(math.nan) == 0


@given(st.integers(-(2**31), 2**31 - 1), st.lists(st.integers(-(2**30), 2**30), max_size=20), signs)
def test_the_motor_position_goes_on_beyond_the_wrap_around_of_its_counter(
    start: int, moves: list[int], sign: int
) -> None:
    drive = RIG_FILE.motor.model_copy(update={"sign": sign})
    counter = MotorPosition(drive, GEAR_RATIO)
    counts = start
    for move in [0, *moves]:
        counts += move
        raw = wrapped(counts, 1 << 32)
        assert counter.take(raw) == pytest.approx(sign * math.tau * counts / (16384 * GEAR_RATIO), abs=1e-9)


@given(
    st.integers(-60_000, 60_000),
    st.lists(st.integers(-60_000, 60_000), max_size=20),
    signs,
    st.integers(0, 131_071),
    st.sampled_from(["single turn", "word"]),
)
def test_the_link_position_has_its_zero_and_sign_and_no_jump_at_the_turn(
    start: int, moves: list[int], sign: int, zero: int, kind: str
) -> None:
    link = RIG_FILE.link.model_copy(update={"sign": sign, "zero": zero})
    counter, counts = LinkPosition(link), start
    for move in [0, *moves]:
        counts += move
        raw = (counts + zero) % (131_072 if kind == "single turn" else 1 << 32)
        assert counter.take(raw) == pytest.approx(sign * math.tau * counts / 131_072, abs=1e-9)


def test_a_link_encoder_of_16_bits_wraps_at_its_word() -> None:
    counter = LinkPosition(RIG_FILE.link.model_copy(update={"bits": 16, "counts_per_turn": 100_000}))
    assert counter.take(30_000) == pytest.approx(math.tau * 0.3)
    assert counter.take(-30_000) == pytest.approx(math.tau * 0.35536)


def test_a_drive_without_rated_torque_is_refused() -> None:
    with pytest.raises(ValueError, match="says nothing"):
        TorqueScale.of(RIG_FILE.motor, 0, GEAR_RATIO)
