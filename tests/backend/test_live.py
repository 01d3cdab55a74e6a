"""The live websocket: telemetry without loss, replies by number, and what one page does to the others."""

import json
from itertools import pairwise

import httpx
import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect
from websockets.typing import Subprotocol

from tests.backend.frame_decoder import Decoded, decoded
from tests.backend.live_page import LivePage
from tests.backend.server import Server
from vssea_core.channels import CHANNELS, INDEX

TORQUE, TUNING_ID = INDEX["motor_torque"], INDEX["tuning_id"]


def frames_of(page: LivePage, count: int) -> list[Decoded]:
    return [decoded(page.next_frame()) for _ in range(count)]


def test_a_page_is_greeted_with_all_it_needs(server: Server, session: httpx.Client) -> None:
    with LivePage(server) as page:
        hello = page.hello
        assert page.socket.subprotocol == "vssea-1"
        assert (hello["type"], hello["protocol"]) == ("hello", 1)
        assert hello["you"].startswith("page ")
        assert hello["snapshot"]["state"] == "running"
        assert [channel["name"] for channel in hello["channels"]] == [channel.name for channel in CHANNELS]
        assert hello["document"]["scenario"] == session.get("/api/session").json()["scenario"]
        assert hello["events"][-1]["text"]


def test_history_comes_first_and_the_live_data_follow_without_a_gap(server: Server, session: httpx.Client) -> None:
    with LivePage(server) as before:  # half a second of data to look back on
        before.next_sample_after(lambda frame: frame.t0 > 0.5 and frame.epoch == before.hello["snapshot"]["epoch"])
    with LivePage(server, history_s=0.4) as page:
        frames = frames_of(page, 12)
        history = [frame for frame in frames if frame.flags & 1]
        assert sum(frame.samples for frame in history) == 400
        assert frames[: len(history)] == history
        assert len(history) < 12
        for one, next_one in pairwise(frames):
            assert next_one.sequence == one.sequence + one.samples


def test_nothing_is_lost_in_a_second_of_telemetry(server: Server, session: httpx.Client) -> None:
    with LivePage(server) as page:
        frames = frames_of(page, 40)
        assert sum(frame.samples for frame in frames) > 500
        for one, next_one in pairwise(frames):
            assert next_one.sequence == one.sequence + one.samples
            assert next_one.t0 == pytest.approx(one.t0 + one.samples * one.dt)
        for frame in frames:
            assert (frame.magic, frame.version, frame.channels, frame.dt) == (b"VSSE", 1, len(CHANNELS), 0.001)
            assert np.allclose(frame.values[0], frame.t0 + frame.dt * np.arange(frame.samples), atol=1e-5)


def test_replies_carry_the_number_of_their_command(server: Server, session: httpx.Client) -> None:
    with LivePage(server) as page:
        numbers = [page.send("ping") for _ in range(5)] + [page.send("nothing"), page.send("tune", changes={"a": 1})]
        replies = {reply["id"]: reply for reply in (page.next_message("reply") for _ in numbers)}
        assert [replies[number]["ok"] for number in numbers] == [True] * 5 + [False] * 2
        assert replies[numbers[0]]["result"] == {}
        assert replies[numbers[5]]["problem"]["status"] == 404
        assert replies[numbers[6]]["problem"]["errors"][0]["field"] == "tuning.a"


def test_a_tuning_shows_in_the_telemetry(server: Server, session: httpx.Client) -> None:
    with LivePage(server) as page:
        result = page.ask("tune", changes={"controller.natural_frequency": 26.0})["result"]
        assert result["applied"] == {"controller.natural_frequency": 26.0}
        page.next_sample_after(lambda frame: bool((frame.values[TUNING_ID] == result["tuning_id"]).any()))


def test_both_pages_hear_of_a_change_and_who_made_it(server: Server, session: httpx.Client) -> None:
    with LivePage(server) as one, LivePage(server) as other:
        one.ask("tune", changes={"observer.bandwidth": 133.0})
        for page in (one, other):
            document = page.next_message("document", lambda message: message["by"] == one.hello["you"])
            assert document["scenario"]["tuning"]["observer"]["bandwidth"] == 133.0
            event = page.next_message("event", lambda message: "133" in message["event"]["text"])["event"]
            assert (event["by"], event["kind"], event["severity"]) == (one.hello["you"], "tuning", "info")
            assert event["text"] == "g 100 → 133 rad/s"


def test_stop_from_a_second_page_takes_the_torque_off_for_all(server: Server, session: httpx.Client) -> None:
    with LivePage(server) as one, LivePage(server) as other:
        one.next_sample_after(lambda frame: bool(np.abs(frame.values[TORQUE]).max() > 0.05))
        assert other.ask("stop")["ok"]
        state = one.next_message("state", lambda message: message["snapshot"]["state"] == "stopped")["snapshot"]
        assert state["sentence"].startswith(f"Stopped by {other.hello['you']}")
        stopped = one.next_sample_after(lambda frame: bool((frame.values[TORQUE] == 0.0).all()))
        assert (decoded(one.next_frame()).values[TORQUE] == 0.0).all()
        assert stopped.samples


def test_a_new_epoch_begins_at_zero_in_a_frame_of_its_own(server: Server, session: httpx.Client) -> None:
    with LivePage(server) as page:
        epoch = page.hello["snapshot"]["epoch"]
        page.next_sample_after(lambda frame: frame.epoch == epoch)
        faster = page.hello["document"]["scenario"] | {"timing": {"sample_time_s": 0.0005, "compute_delay_samples": 0}}
        assert page.ask("load_scenario", scenario=faster)["ok"]
        first = page.next_sample_after(lambda frame: frame.epoch != epoch)
        assert (first.epoch, first.t0, first.dt) == (epoch + 1, 0.0, 0.0005)


@pytest.mark.parametrize(
    "message",
    ["{", "[]", '"stop"', "7", "{}", '{"command": 7}', b"\x00\x01", "x" * 300_000, "[" * 100_000],
    ids=["open", "list", "text", "number", "empty", "number as command", "bytes", "long", "deep"],
)
def test_what_is_no_command_closes_the_page_with_a_code_and_a_reason(
    server: Server, session: httpx.Client, message: str | bytes
) -> None:
    with LivePage(server) as page:
        page.socket.send(message)
        with pytest.raises(ConnectionClosed) as closed:
            page.next_message("never")
        assert closed.value.rcvd is not None
        assert (closed.value.rcvd.code, closed.value.rcvd.reason[:22]) == (1002, "Expected JSON commands")
    assert session.get("/api/health").json()["session"] == "running"


@pytest.mark.parametrize("number", [None, "seven", [1], 2**70])
def test_a_command_is_answered_whatever_its_number(server: Server, session: httpx.Client, number: object) -> None:
    with LivePage(server) as page:
        page.socket.send(json.dumps({"id": number, "command": "ping", "arguments": "none"}))
        assert page.next_message("reply")["id"] == number


@pytest.mark.parametrize("arguments", [[], [1], "text", 7, False])
def test_arguments_that_are_no_object_are_refused(server: Server, session: httpx.Client, arguments: object) -> None:
    with LivePage(server) as page:
        page.socket.send(json.dumps({"id": 1, "command": "pause", "arguments": arguments}))
        assert page.next_message("reply")["problem"]["status"] == 422


def test_an_unknown_subprotocol_is_refused(server: Server) -> None:
    with pytest.raises(InvalidStatus):
        connect(f"ws://127.0.0.1:{server.port}/api/live", subprotocols=[Subprotocol("vssea-0")], proxy=None)
