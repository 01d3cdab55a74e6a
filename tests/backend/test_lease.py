"""The operator's lease in injected time: one holder, who lives by renewals; STOP and its like need none."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from backend.problem import Problem
from backend.session.command_audit import CommandAudit
from backend.session.heartbeat import Heartbeat
from backend.session.operator_lease import LONGEST_LEASE_S, OperatorLease, Party
from backend.telemetry.beats import LEASE, LEASE_S, WEB, Beats
from tests.injected_clock import Clock

ONE, TWO = Party("key-1", "page 1"), Party("key-2", "page 2")
CALLER = Party("key-3", "REST", LONGEST_LEASE_S)


def leased(party: Party = ONE) -> tuple[OperatorLease, Clock]:
    clock = Clock()
    lease = OperatorLease(clock)
    lease.take(party)
    return lease, clock


@pytest.mark.parametrize(("party", "length_s"), [(ONE, 0.4), (CALLER, 5.0)])
def test_a_lease_ends_when_it_is_not_renewed_for_its_length(party: Party, length_s: float) -> None:
    lease, clock = leased(party)
    clock.now += length_s - 0.001
    assert lease.holds(party.key)
    lease.renew(party.key)
    clock.now += length_s - 0.001
    assert lease.holder == party
    clock.now += 0.002
    assert (lease.holder, lease.left_s, lease.holds(party.key)) == (None, None, False)
    assert lease.expired() == party
    assert lease.expired() is None


def test_a_lease_that_ended_is_not_renewed_but_taken_anew() -> None:
    lease, clock = leased()
    clock.now += LEASE_S
    with pytest.raises(Problem, match="Nobody is in control") as refusal:
        lease.renew(ONE.key)
    assert refusal.value.status == 403
    lease.take(TWO)
    assert lease.holder == TWO


def test_nobody_takes_renews_or_releases_what_another_holds() -> None:
    lease, _ = leased()
    for attempt in (lambda: lease.take(TWO), lambda: lease.renew(TWO.key), lambda: lease.release(TWO.key),
                    lambda: lease.hand(TWO.key, TWO), lambda: lease.check(None)):  # fmt: skip
        with pytest.raises(Problem, match="page 1 is in control") as refusal:
            attempt()
        assert (refusal.value.status, refusal.value.title) == (403, "Not in control")
        assert refusal.value.members == {"operator": "page 1"}
    assert lease.holder == ONE


def test_who_asks_is_listed_until_it_is_given_control_or_leaves() -> None:
    lease, _ = leased()
    assert lease.ask(TWO) == ONE
    lease.ask(CALLER)
    assert [party.name for party in lease.asking] == ["page 2", "REST"]
    lease.hand(ONE.key, TWO)
    assert (lease.holder, lease.asking) == (TWO, [CALLER])
    assert not lease.leave(CALLER.key)
    assert lease.asking == []
    with pytest.raises(Problem, match="in control already"):
        lease.ask(TWO)


def test_a_page_that_closes_ends_its_lease_at_once() -> None:
    lease, _ = leased()
    assert lease.leave(ONE.key)
    assert lease.holder is None
    assert lease.expired() is None  # it was told already
    with pytest.raises(Problem, match="take it"):
        lease.ask(TWO)


@given(
    st.lists(
        st.tuples(st.sampled_from(["take", "renew", "release", "ask", "leave", "wait"]), st.sampled_from([ONE, TWO]))
    )
)
def test_at_most_one_party_is_in_control_and_never_without_a_sign_of_life(steps: list[tuple[str, Party]]) -> None:
    clock = Clock()
    lease = OperatorLease(clock)
    alive: dict[str, float] = {}
    for what, party in steps:
        try:
            if what == "wait":
                clock.now += 0.15
            elif what in ("take", "ask"):
                getattr(lease, what)(party)
            else:
                getattr(lease, what)(party.key)
            if what in ("take", "renew"):
                alive[party.key] = clock.now
        except Problem:
            pass
        assert not (lease.holds(ONE.key) and lease.holds(TWO.key))
        for key, heard_at in alive.items():
            assert not lease.holds(key) or clock.now - heard_at < LEASE_S


async def test_the_operator_is_not_kept_alive_by_the_server_but_a_caller_with_a_longer_lease_is() -> None:
    lease, clock = leased()
    heart = Heartbeat(lease)
    beats = Beats(heart.begin())
    try:
        heart.turn()
        assert (beats.count(WEB), beats.count(LEASE)) == (1, 0)
        heart.beat_operator()
        assert beats.count(LEASE) == 1
        lease.release(ONE.key)
        lease.take(CALLER)
        seen = []
        for _ in range(104):  # of 50 ms
            before = beats.count(LEASE)
            heart.turn()
            seen.append(beats.count(LEASE) > before)
            clock.now += 0.05
        lasted_s = 0.05 * (max(number for number, beat in enumerate(seen) if beat) + 1) + LEASE_S
        assert lasted_s == pytest.approx(LONGEST_LEASE_S, abs=0.051)
        assert seen == sorted(seen, reverse=True)
    finally:
        beats.close()
        await heart.end()


def test_the_journal_hears_of_begin_and_end_of_a_jog_and_of_no_sign_of_life() -> None:
    clock = Clock()
    audit = CommandAudit(clock)
    heard = []
    for link in [0.3] * 20 + [0.2] * 20 + [0.0] * 3 + [0.3]:
        clock.now += 0.1
        heard.append(audit.is_news("jog", {"link": link}, "page 1", None))
        assert not audit.is_news("renew_control", {}, "page 1", None)
        assert audit.is_news("hold", {}, "page 1", None)
    assert [number for number, news in enumerate(heard) if news] == [0, 40, 43]
    assert audit.is_news("jog", {"link": 0.3}, "page 2", "page 1 is in control")
    assert not audit.is_news("jog", {"link": 0.3}, "page 2", "page 1 is in control")
    clock.now += 1.0
    assert audit.is_news("jog", {"link": 0.3}, "page 1", None)  # another one, after a silence
