import io
import os
import signal
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.records import Message
from mcap.stream_reader import StreamReader
from mcap_protobuf.decoder import DecoderFactory

from backend.recordings.chunks import Document
from backend.recordings.folder import recover, sweep
from backend.recordings.layout import COLUMNS_KEPT, EVENTS, FIELDS, SCENARIO, TELEMETRY
from backend.recordings.reader import Recording
from backend.recordings.recording_file import FinishedRecording, RecordingFile
from tests.backend.recorded import samples

HEAD = {"id": "run", "begin_ns": "1700000000000000000", "first_sample": "0", "part": "1"}
NAMES = [field.name for field in FIELDS]


def written(path: Path, chunks: int = 4, each: int = 250) -> RecordingFile:
    file = RecordingFile.create(path, HEAD)
    file.append_documents([Document(SCENARIO, 0.0, {"n": 1, "at_s": 0.0, "scenario": {"name": "nominal"}})])
    for number in range(chunks):
        file.append_samples(samples(each, start=number * each), number * each)
    return file


def test_public_reader_gets_every_sample_to_the_bit(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    written(path).finish(reason="done")
    expected = samples(1000)[:, COLUMNS_KEPT]
    with path.open("rb") as stream:
        messages = list(
            make_reader(stream, decoder_factories=[DecoderFactory()]).iter_decoded_messages(topics=["/telemetry"])
        )
    read = np.array([[getattr(decoded, name) for name in NAMES] for _, _, _, decoded in messages])
    assert read.tobytes() == expected.tobytes()
    assert [message.log_time for _, _, message, _ in messages] == [
        1700000000000000000 + 1000000 * n for n in range(1000)
    ]


def test_units_and_symbols_are_in_the_file(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    written(path).finish()
    with path.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    assert summary.channels[TELEMETRY].metadata["motor_torque"] == "N·m"
    assert "θ_l, link [rad]" in summary.schemas[TELEMETRY].data.decode("utf-8", "ignore")
    assert summary.schemas[EVENTS].name == "foxglove.Log"


@given(cut=st.integers(0, 100_000))
@settings(max_examples=60, deadline=None)
def test_a_file_cut_anywhere_keeps_all_whole_chunks(tmp_path_factory: pytest.TempPathFactory, cut: int) -> None:
    path = tmp_path_factory.mktemp("cut") / "run.mcap"
    written(path, chunks=6, each=50).close()
    begin = RecordingFile.create(path.with_name("empty.mcap"), HEAD)
    begin.close()
    content = path.read_bytes()
    length = begin.size + cut % (len(content) - begin.size + 1)
    path.write_bytes(content[:length])
    whole = _messages_before_the_end(content[:length])
    assert recover(path) is True
    read = Recording(path)
    assert read.is_finished
    assert read.samples == whole
    assert read.read(NAMES).rows.tobytes() == samples(whole)[:, COLUMNS_KEPT].tobytes()
    with path.open("rb") as stream:
        assert sum(1 for _ in make_reader(stream).iter_messages(topics=["/telemetry"])) == whole


def _messages_before_the_end(content: bytes) -> int:
    """Telemetry messages that the public reader finds before it runs into the torn end."""
    count = 0
    try:
        for record in StreamReader(io.BytesIO(content)).records:
            count += isinstance(record, Message) and record.channel_id == TELEMETRY
    except Exception:  # noqa: BLE001 - whatever a torn record makes of the reader
        return count
    return count


def test_a_reopened_file_goes_on_and_is_one(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    written(path, chunks=2).close()
    again = RecordingFile.reopen(path)
    again.append_samples(samples(250, start=500), 500)
    again.finish()
    assert Recording(path).read(NAMES).rows.tobytes() == samples(750)[:, COLUMNS_KEPT].tobytes()
    with pytest.raises(FinishedRecording):
        RecordingFile.reopen(path)


def test_a_torn_index_at_the_end_is_written_anew(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    written(path).finish()
    content = path.read_bytes()
    path.write_bytes(content[:-40])
    assert recover(path) is True
    assert recover(path) is False
    assert Recording(path).samples == 1000


def test_missing_samples_are_gaps(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    file = RecordingFile.create(path, HEAD)
    file.append_samples(samples(100), 0)
    file.append_samples(samples(100, start=150), 150)
    file.finish()
    read = Recording(path)
    assert read.read(["time"]).gaps().tolist() == [100]
    assert read.last_number == 249


def test_a_damaged_chunk_costs_only_itself(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    written(path).finish()
    content = bytearray(path.read_bytes())
    place = Recording(path)._blocks[1]
    content[place.offset + place.length - 20] ^= 0xFF
    path.write_bytes(content)
    read = Recording(path)
    assert len(read.read(["time"]).rows) == 750
    assert read.damaged == 1


def test_a_full_disk_leaves_what_was_written_whole(tmp_path: Path) -> None:
    import resource

    path = tmp_path / "run.mcap"
    file = written(path)
    before = file.size
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    try:
        resource.setrlimit(resource.RLIMIT_FSIZE, (before + 1000, limit[1]))
        with pytest.raises(OSError, match="too large"):
            file.append_samples(samples(250, start=1000), 1000)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limit)
        signal.signal(signal.SIGXFSZ, handler)
    assert os.path.getsize(path) == before  # noqa: PTH202 - of what is on disk
    file.finish()
    assert Recording(path).samples == 1000


def test_a_file_is_a_recording_from_its_first_byte_on(tmp_path: Path) -> None:
    torn = tmp_path / "run.mcap.beginning"
    torn.write_bytes(b"\x89MC")
    sweep(tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("content", [b"", b"not a recording", b"\x89MCAP0\r\n"])
def test_another_file_is_refused_with_a_sentence(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "other.mcap"
    path.write_bytes(content)
    with pytest.raises(ValueError, match=r"other\.mcap is not a recording"):
        Recording(path)
