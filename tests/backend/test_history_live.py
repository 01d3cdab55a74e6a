"""The history over the wire: one for all pages, in the greeting, told as it changes, and over REST."""

from typing import Any

import httpx

from tests.backend.live_page import LivePage
from tests.backend.server import Server


def newest(message: dict[str, Any]) -> dict[str, Any]:
    return dict(message["entries"][-1])


def test_two_pages_share_one_history(server: Server, session: httpx.Client) -> None:
    with LivePage(server) as one, LivePage(server) as other:
        one.ask("tune", changes={"observer.bandwidth": 133.0})
        made = newest(other.next_message("history", lambda m: newest(m)["by"] == one.hello["you"]))
        assert (made["part"], made["changes"]) == ("tuning", {"observer.bandwidth": [100.0, 133.0]})
        result = other.ask("undo")["result"]
        assert (result["number"], result["by"]) == (made["number"], one.hello["you"])
        undone = one.next_message("history", lambda m: newest(m)["undone"])
        assert (newest(undone)["number"], undone["can_redo"]) == (made["number"], True)
        document = one.next_message("document", lambda m: m["by"] == other.hello["you"])
        assert document["scenario"]["tuning"]["observer"]["bandwidth"] == 100.0
        assert one.ask("redo")["ok"]
    with LivePage(server) as late:
        assert late.hello["history"] == session.get("/api/session/history", params={"last": 100}).json()
        assert late.hello["history"][-1]["undone"] is False
        assert (late.hello["can_undo"], late.hello["can_redo"]) == (True, False)


def test_a_return_to_an_unknown_entry_is_refused_in_words(session: httpx.Client) -> None:
    answer = session.post("/api/session/return_to", json={"number": 99_999})
    assert answer.status_code == 404
    assert "There is no entry 99999 in the history" in answer.json()["detail"]


def test_a_level_on_no_channel_is_refused_in_words(session: httpx.Client) -> None:
    source = {"kind": "level", "channel": "colour", "level": 1.0}
    answer = session.post("/api/session/arm_trigger", json={"source": source})
    assert answer.status_code == 422
    assert "'colour' is not a channel to trigger on" in answer.json()["detail"]


def test_the_samples_of_a_pin_are_in_its_recording(server: Server, session: httpx.Client) -> None:
    with LivePage(server) as page:
        page.next_sample_after(lambda frame: frame.t0 > 0.5)
        pin = page.ask("pin", seconds=0.3)["result"]
        try:
            assert page.next_message("pins")["pins"][-1] == pin
            assert pin["recording"] is not None
            assert pin["recording"] in [each["id"] for each in session.get("/api/recordings").json()["recordings"]]
        finally:
            page.ask("unpin", id=pin["id"])
