"""The recorder of a running server: what pages received is in the file, and nothing that is killed costs samples."""

import os
import signal
from pathlib import Path

import httpx
import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from backend.recordings.layout import CHANGES, COMMANDS, EVENTS, SCENARIO
from backend.recordings.reader import Recording
from tests.backend.frame_decoder import decoded
from tests.backend.live_page import LivePage
from tests.backend.server import Server, until
from vssea_core.channels import CHANNELS


def folder_of(server: Server) -> Path:
    return server.errors.parent / "recordings"


def recording_of(server: Server, epoch: int) -> Recording:
    """The recording of a run, once it is complete."""

    def look() -> Recording | None:
        for path in folder_of(server).glob("*.mcap"):
            found = Recording(path)
            if found.head["epoch"] == str(epoch) and found.is_finished:
                return found
        return None

    found = until(look)
    assert found is not None
    return found


def test_a_recording_has_what_a_page_received_to_the_bit(server: Server, session: httpx.Client) -> None:
    with LivePage(server) as page:
        frames = [decoded(page.next_frame()) for _ in range(60)]
        epoch = frames[-1].epoch
        page.ask("tune", changes={"observer.bandwidth": 130.0})
        page.ask("reset")
    frames = [frame for frame in frames if frame.epoch == epoch]
    received = np.concatenate([frame.values for frame in frames], axis=1)
    path = recording_of(server, epoch).path
    first = int(Recording(path).head["first_sample"])
    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        messages = {m.sequence: d for _, _, m, d in reader.iter_decoded_messages(topics=["/telemetry"])}
    start = frames[0].sequence
    assert start >= first
    kept = [[getattr(messages[n], c.name) for n in range(start, start + received.shape[1])] for c in CHANNELS]
    assert np.array(kept, np.float32).tobytes() == np.ascontiguousarray(received).tobytes()


def test_tunings_commands_scenario_and_events_are_in_the_recording(server: Server, session: httpx.Client) -> None:
    with LivePage(server) as page:
        epoch = page.hello["snapshot"]["epoch"]
        page.ask("tune", changes={"observer.bandwidth": 131.0})
        page.ask("tune", changes={"observer.bandwidth": -1.0})
        page.next_message("event", lambda message: "131" in message["event"]["text"])
        page.ask("reset")
    found = recording_of(server, epoch)
    assert found.documents(SCENARIO)[0]["scenario"]["name"] == "nominal"
    (change,) = found.documents(CHANGES)
    assert change["document"]["observer"]["bandwidth"] == 131.0
    rows = found.read(["time", "tuning_id"]).rows
    since = rows[rows[:, 1] == change["tuning_id"], 0]
    assert since[0] == pytest.approx(change["at_s"])
    told = [(command["command"], command["ok"]) for command in found.documents(COMMANDS)]
    assert ("tune", True) in told
    assert ("tune", False) in told
    assert "g 100 → 131 rad/s" in [event["message"] for event in found.documents(EVENTS)]


def test_a_killed_writer_costs_no_sample(server: Server, session: httpx.Client) -> None:
    with LivePage(server) as page:
        epoch = page.hello["snapshot"]["epoch"]
        page.next_sample_after(lambda frame: frame.epoch == epoch and frame.t0 > 0.8)
        before = server.children()["recorder"]
        os.kill(before, signal.SIGKILL)
        page.next_message("event", lambda message: "started anew" in message["event"]["text"])
        until(lambda: server.children().get("recorder", before) != before)
        newest = page.next_sample_after(lambda frame: frame.t0 > 2.0)
        until(lambda: (recording := _open_recording(server, epoch)) and recording.span[1] > newest.t0)
        page.ask("reset")
    found = recording_of(server, epoch)
    read = found.read(["time"])
    assert len(read.gaps()) == 0
    assert read.rows[0, 0] == 0.0


def _open_recording(server: Server, epoch: int) -> Recording | None:
    for path in folder_of(server).glob("*.mcap"):
        found = Recording(path)
        if found.head["epoch"] == str(epoch):
            return found
    return None


def test_a_killed_server_leaves_a_recording_that_the_next_start_lists(tmp_path: Path) -> None:
    server = Server(tmp_path).wait_until_running()
    try:
        until(lambda: (found := _open_recording(server, 1)) and found.samples > 500)
        children = list(server.children().values())
        server.process.kill()
        for pid in children:
            os.kill(pid, signal.SIGKILL)
        server.process.wait()
        (path,) = folder_of(server).glob("*.mcap")
        assert not Recording(path).is_finished
        samples = Recording(path).samples
    finally:
        server.kill()
    again = Server(tmp_path, port=server.port).wait_until_running()
    try:
        until(lambda: Recording(path).is_finished)
        assert Recording(path).samples == samples
        assert (Recording(path).ending or {})["recovered"] == "true"
    finally:
        again.terminate()


def test_recording_can_be_off(tmp_path: Path) -> None:
    server = Server(tmp_path, VSSEA_RECORDING="false").wait_until_running()
    try:
        with LivePage(server) as page:
            assert page.hello["recorder"]["state"] == "off"
            page.next_sample_after(lambda frame: frame.t0 > 0.5)
        assert not list(folder_of(server).glob("*.mcap"))
    finally:
        server.terminate()
