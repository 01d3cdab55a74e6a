"""The drive's state machine, over every status word, goal and previous control word."""

from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from backend.rigs.canopen.cia402 import ENABLE, FAULT_RESET, QUICK_STOP, DriveState, Goal, drive_state, step
from backend.rigs.canopen.emergency import error_words, fault_of
from backend.rigs.faults import HOT, MOTOR_DRIVE

# CiA 402's table of states: bits that count, and what they are.
TABLE = {
    DriveState.NOT_READY: (0b1001111, 0b0000000),
    DriveState.SWITCH_ON_DISABLED: (0b1001111, 0b1000000),
    DriveState.READY: (0b1101111, 0b0100001),
    DriveState.SWITCHED_ON: (0b1101111, 0b0100011),
    DriveState.OPERATION_ENABLED: (0b1101111, 0b0100111),
    DriveState.QUICK_STOP: (0b1101111, 0b0000111),
    DriveState.FAULT_REACTION: (0b1001111, 0b0001111),
    DriveState.FAULT: (0b1001111, 0b0001000),
}
STATUS_WORDS = range(0x80)  # higher bits are no part of the state
CONTROL_WORDS = range(0x100)
FAULTS = (DriveState.FAULT, DriveState.FAULT_REACTION)
EVERYTHING = list(product(STATUS_WORDS, Goal, CONTROL_WORDS))
WORDS_OF = {
    state: next(word for word in STATUS_WORDS if word & mask == value) for state, (mask, value) in TABLE.items()
}


def may_enable(control_word: int) -> bool:
    return bool(control_word & 0b1000)


def test_every_status_word_is_the_one_state_of_the_table() -> None:
    for word in range(0x10000):
        states = [state for state, (mask, value) in TABLE.items() if word & mask == value]
        assert len(states) <= 1
        assert drive_state(word) is (states[0] if states else DriveState.UNKNOWN)


def test_operation_is_asked_for_only_towards_the_goal_enabled() -> None:
    asked = {
        (drive_state(status), goal) for status, goal, before in EVERYTHING if may_enable(step(status, goal, before)[0])
    }
    assert asked == {
        (DriveState.SWITCHED_ON, Goal.ENABLED),
        (DriveState.QUICK_STOP, Goal.ENABLED),
        (DriveState.OPERATION_ENABLED, Goal.ENABLED),
        (DriveState.OPERATION_ENABLED, Goal.KEPT),
    }


def test_bit_7_rises_only_on_request_and_only_in_fault() -> None:
    for status, goal, before in EVERYTHING:
        word = step(status, goal, before).control_word
        risen = bool(word & FAULT_RESET) and not before & FAULT_RESET
        assert bool(word & FAULT_RESET) == risen, "a level is no edge"
        if goal is Goal.RESET and drive_state(status) is DriveState.FAULT and not before & FAULT_RESET:
            assert word == FAULT_RESET
        else:
            assert not risen


def test_a_request_to_reset_makes_one_edge_even_if_the_bit_was_high() -> None:
    status, goal, before = WORDS_OF[DriveState.FAULT], Goal.RESET, FAULT_RESET
    words = []
    for _ in range(6):
        before, _, state, goal = step(status, goal, before)
        assert state == "fault"
        words.append(before)
    assert words == [0, FAULT_RESET, 0, 0, 0, 0]


def test_a_fault_ends_the_wish_to_be_enabled() -> None:
    for status, goal, before in EVERYTHING:
        if drive_state(status) in FAULTS:
            after = step(status, goal, before)
            assert after.goal in (Goal.DISABLED, Goal.RESET)
            assert after.state == "fault"
            assert after.control_word in (0, FAULT_RESET)


@pytest.mark.parametrize("state", [s for s in DriveState if s is not DriveState.OPERATION_ENABLED])
def test_a_drive_that_left_operation_by_itself_is_not_enabled_again(state: DriveState) -> None:
    status = WORDS_OF.get(state, 0x01)
    assert drive_state(status) is state
    word, _, axis, goal = step(status, Goal.KEPT, ENABLE)
    assert not may_enable(word)
    assert goal in (Goal.DISABLED, Goal.STOPPED)
    assert axis != "enabled"


def test_a_drive_that_holds_by_its_own_quick_stop_goes_on_holding() -> None:
    word, _, axis, goal = step(WORDS_OF[DriveState.QUICK_STOP], Goal.KEPT, ENABLE)
    assert (word, axis, goal) == (QUICK_STOP, "stopping", Goal.STOPPED)


@given(st.lists(st.sampled_from([*WORDS_OF.values(), 0x01]), min_size=1, max_size=30), st.sampled_from(list(Goal)))
def test_whatever_the_drive_does_after_a_fault_it_stays_off_until_a_new_goal(words: list[int], goal: Goal) -> None:
    _, _, _, goal = step(WORDS_OF[DriveState.FAULT], goal, ENABLE)
    before = 0
    for status in words:
        before, _, axis, goal = step(status, goal, before)
        assert not may_enable(before)
        assert axis != "enabled"


def test_the_way_to_operation_takes_the_three_words_of_the_standard() -> None:
    goal, before, words = Goal.ENABLED, 0, []
    for state in (
        DriveState.SWITCH_ON_DISABLED,
        DriveState.READY,
        DriveState.SWITCHED_ON,
        DriveState.OPERATION_ENABLED,
    ):
        before, _, axis, goal = step(WORDS_OF[state], goal, before)
        words.append((before, axis))
    assert words == [(0x06, "enabling"), (0x07, "enabling"), (0x0F, "enabling"), (0x0F, "enabled")]
    assert goal is Goal.KEPT


def test_a_drive_that_holds_is_enabled_without_letting_go_however_long_it_takes() -> None:
    goal, before = Goal.ENABLED, QUICK_STOP
    for _ in range(5):
        before, _, axis, goal = step(WORDS_OF[DriveState.QUICK_STOP], goal, before)
        assert (before, axis) == (ENABLE, "enabling")
    assert step(WORDS_OF[DriveState.OPERATION_ENABLED], goal, before).state == "enabled"


def test_stopping_keeps_power_on_and_lowers_the_quick_stop_bit() -> None:
    for state in (DriveState.OPERATION_ENABLED, DriveState.QUICK_STOP):
        assert step(WORDS_OF[state], Goal.STOPPED, ENABLE)[:3] == (QUICK_STOP, state, "stopping")


def test_disabling_takes_the_voltage_off_in_every_state() -> None:
    assert {
        step(status, Goal.DISABLED, before).control_word for status, before in product(STATUS_WORDS, CONTROL_WORDS)
    } == {0}


@pytest.mark.parametrize(
    ("code", "words"),
    [
        (0x2310, "0x2310 over-current"),
        (0x7310, "0x7310 sensor"),
        (0x6320, "0x6320 software of the device"),
        (0x8130, "0x8130 the heartbeat of this computer stayed away"),
        (0xFF07, "0xFF07 specific to this device"),
        (0xB000, "0xB000 unknown error"),
        (0x0000, ""),
    ],
)
def test_an_error_code_has_words(code: int, words: str) -> None:
    assert error_words(code) == words


def test_only_the_codes_of_temperature_are_over_temperature() -> None:
    hot = {code >> 12 for code in range(0x1000, 0x10000) if fault_of(code, MOTOR_DRIVE) is HOT}
    assert hot == {4}
