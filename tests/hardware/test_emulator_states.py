"""The power state machine of the emulated drives against the transitions that CiA 402 numbers."""

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from backend.emulator.cia402 import STATUS_BITS, State, controlled

D, R, S, E, Q, X, F = (
    State.DISABLED, State.READY, State.SWITCHED_ON, State.ENABLED, State.QUICK_STOP, State.REACTION, State.FAULT,
)  # fmt: skip
# Rows: state; columns: shutdown, switch on, enable operation, disable voltage, quick stop.
TABLE = {
    State.NOT_READY: (State.NOT_READY,) * 5,
    D: (R, D, D, D, D),
    R: (R, S, S, D, D),
    S: (R, S, E, D, D),
    E: (R, S, E, D, Q),
    Q: (Q, Q, Q, D, Q),
    X: (X,) * 5,
    F: (F,) * 5,
}
words = st.integers(0, 0xFFFF)


def column(word: int) -> int:
    """The standard's patterns, bit by bit: fault reset, enable, quick stop, voltage, switch on."""
    enable, quick_stop, voltage, switch_on = word >> 3 & 1, word >> 2 & 1, word >> 1 & 1, word & 1
    if not voltage:
        return 3
    if not quick_stop:
        return 4
    if not switch_on:
        return 0
    return 2 if enable else 1


@pytest.mark.parametrize("state", State)
def test_every_controlword_leads_where_the_standard_says(state: State) -> None:
    for word in range(0x10000):
        after, resets = controlled(state, word, word, 2, False)
        assert after is TABLE[state][column(word)], (state, hex(word))
        assert not resets  # the same word as before has no edge


@given(before=words, word=words)
def test_a_fault_is_left_only_by_a_rising_edge_of_bit_7_and_to_switch_on_disabled(before: int, word: int) -> None:
    rises = bool(word & 0x80) and not before & 0x80
    assert controlled(F, word, before, 2, fault_stands=False) == ((D, True) if rises else (F, False))


@given(before=words, word=words)
def test_a_fault_is_not_left_while_its_cause_stands(before: int, word: int) -> None:
    assert controlled(F, word, before, 2, fault_stands=True) == (F, False)


@pytest.mark.parametrize("option", [0, 1, 2, 5, 6])
def test_operation_is_reached_only_from_switched_on_or_by_a_new_command_in_a_quick_stop_that_stays(option: int) -> None:
    for state, before, word in itertools.product(State, range(16), range(16)):
        after, _ = controlled(state, word, before, option, False)
        allowed = state in (E, S) or (state is Q and option in (5, 6) and column(before) != 2)
        assert (after is E) == (column(word) == 2 and allowed)


@given(st.lists(words, max_size=30))
def test_no_word_that_disables_voltage_leaves_power_on(sequence: list[int]) -> None:
    state, before = D, 0
    for word in sequence:
        state, _ = controlled(state, word, before, 2, False)
        before = word
        if not word & 0x02:
            assert state is D


def test_the_statuswords_of_all_states_differ_in_the_bits_that_the_standard_masks() -> None:
    masks = {State.NOT_READY: 0x4F, D: 0x4F, X: 0x4F, F: 0x4F}
    for state, bits in STATUS_BITS.items():
        matching = [other for other, seen in STATUS_BITS.items() if seen & masks.get(state, 0x6F) == bits]
        assert matching == [state]
