"""The margins of the tuning in force: told after each change, the newest question answered, and why if there are none."""

from typing import Any

import httpx
import pytest

from tests.backend.live_page import LivePage
from tests.backend.server import Server, until


def margins_after(page: LivePage, tuning_id: int) -> dict[str, Any]:
    """The margins of this tuning or a later one."""
    return page.next_message("margins", lambda message: message["tuning_id"] >= tuning_id)


def tune(page: LivePage, **changes: Any) -> int:
    reply = page.ask("tune", changes={name.replace("__", "."): value for name, value in changes.items()})
    assert reply["ok"], reply
    return int(reply["result"]["tuning_id"])


def test_each_tuning_is_followed_by_its_margins(server: Server, session: httpx.Client) -> None:
    with LivePage(server) as page:
        calm = margins_after(page, tune(page, observer__bandwidth=60.0))
        lively = margins_after(page, tune(page, observer__bandwidth=200.0))
    assert calm["available"]
    assert calm["stable"]
    assert lively["figures"]["estimate_bandwidth"] > calm["figures"]["estimate_bandwidth"]
    assert lively["robustness"]["delay_s"] < calm["robustness"]["delay_s"]


def test_they_are_what_the_analysis_says_of_the_same_loop(server: Server, session: httpx.Client) -> None:
    with LivePage(server) as page:
        told = margins_after(page, tune(page, observer__bandwidth=150.0))
    report = session.post("/api/analysis").json()
    for part in ("stable", "poles", "robustness", "warning", "figures", "true", "stiffness", "sample_time_s"):
        assert told[part] == report[part], part


def test_another_stiffness_is_answered_though_the_tuning_stays(server: Server, session: httpx.Client) -> None:
    with LivePage(server) as page:
        before = margins_after(page, tune(page, observer__bandwidth=110.0))
        assert page.ask("set_stiffness", changes={"stiffness": 400.0})["ok"]
        after = page.next_message("margins", lambda message: message["stiffness"] == 400.0)
    assert after["tuning_id"] == before["tuning_id"]
    assert after["robustness"]["margins"]["plant"]["gain_up"] != before["robustness"]["margins"]["plant"]["gain_up"]


def test_of_many_changes_the_newest_is_answered_and_never_an_older_one_after_it(
    server: Server, session: httpx.Client
) -> None:
    with LivePage(server) as page:
        sent = [page.send("tune", changes={"observer.bandwidth": float(g)}) for g in range(101, 121)]
        replies = [page.next_message("reply", lambda reply, n=number: reply["id"] == n) for number in sent]  # type: ignore[misc]
        last = replies[-1]["result"]["tuning_id"]
        seen = [message["tuning_id"] for message in page.passed_over("margins")]
        seen.append(margins_after(page, last)["tuning_id"])
    assert seen == sorted(seen)
    assert seen[-1] == last


def test_a_new_page_finds_the_newest_margins_in_its_greeting(server: Server, session: httpx.Client) -> None:
    with LivePage(server) as page:
        told = margins_after(page, tune(page, observer__bandwidth=130.0))
    with LivePage(server) as late:
        assert late.hello["margins"] == told


@pytest.mark.parametrize("switch", ["sgn", "super_twisting"])
def test_a_controller_without_a_linear_loop_says_why_there_are_none(
    server: Server, session: httpx.Client, switch: str
) -> None:
    with LivePage(server) as page:
        number = tune(page, controller__kind="sliding_mode", controller__switch=switch)
        told = margins_after(page, number)
    assert told["available"] is False
    assert "no linearisation" in told["reason"]
    assert set(told) == {"type", "tuning_id", "stiffness", "available", "reason"}


def test_what_the_actuator_truly_has_is_told_as_factors(server: Server, session: httpx.Client) -> None:
    inertia = session.get("/api/session").json()["scenario"]["actuator"]["link"]["inertia"]
    with LivePage(server) as page:
        told = margins_after(page, tune(page, model__link_inertia=0.8 * inertia))
    assert told["true"]["link_inertia"] == pytest.approx(1.25)
    assert told["true"]["motor_inertia"] == pytest.approx(1.0)


def test_a_thin_margin_comes_with_a_sentence(server: Server, session: httpx.Client) -> None:
    session.post("/api/session/load_scenario", json={"name": "realistic"}).raise_for_status()
    with LivePage(server) as page:
        told = margins_after(page, tune(page, observer__bandwidth=330.0))
    assert told["warning"]["sentence"].startswith("unstable if")
    until(lambda: session.get("/api/session").json()["tuning_id"] >= told["tuning_id"])
