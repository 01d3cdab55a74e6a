"""Chunks of a recording: samples or documents as MCAP message records, compressed, with the index that readers need."""

import json
import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import zstandard
from mcap.data_stream import RecordBuilder
from mcap.records import Chunk, Message

from backend.recordings.layout import COLUMNS_KEPT, MESSAGE, TELEMETRY, empty_messages
from backend.telemetry.ring import Samples
from vssea_core.channels import INDEX

LEVEL = 1
NS = 1e9
OPCODE_MESSAGE_INDEX = 0x07
INDEX_ENTRY = np.dtype([("log_time", "<u8"), ("offset", "<u8")])


@dataclass(frozen=True)
class Place:
    """Where one chunk is in the file and what it holds."""

    start_ns: int
    end_ns: int
    offset: int
    length: int
    index_length: int
    channel: int
    messages: int
    compressed: int
    size: int


@dataclass(frozen=True)
class Document:
    """A JSON message: the channel it belongs to, the time of the run [s], and its content."""

    channel: int
    at_s: float
    content: dict[str, Any]


def log_time_ns(begin_ns: int, at_s: Any) -> Any:
    """Return the log time of a time of the run: scalar or array."""
    return begin_ns + np.rint(np.asarray(at_s) * NS).astype(np.int64)


def sample_records(samples: Samples, first: int, begin_ns: int) -> np.ndarray:
    """Return samples (n, ring.COLUMNS) from sample number `first` on as message records (n,)."""
    messages = empty_messages(len(samples))
    messages["sequence"] = (first + np.arange(len(samples))) & 0xFFFFFFFF
    messages["log_time"] = messages["publish_time"] = log_time_ns(begin_ns, samples[:, INDEX["time"]])
    for number, column in enumerate(COLUMNS_KEPT):
        messages[f"value{number}"] = samples[:, column]
    return messages


def sample_chunk(records: np.ndarray, offset: int) -> tuple[bytes, Place]:
    """Return a chunk of telemetry and its index as bytes for position `offset` of the file, and its place."""
    entries = np.empty(len(records), INDEX_ENTRY)
    entries["log_time"] = records["log_time"]
    entries["offset"] = np.arange(len(records)) * MESSAGE.itemsize
    return _chunk(records.tobytes(), TELEMETRY, entries, offset)


def document_chunk(documents: Sequence[Document], begin_ns: int, sequence: int, offset: int) -> tuple[bytes, Place]:
    """Return a chunk of documents of one channel, in the order of time."""
    builder = RecordBuilder()
    entries = np.empty(len(documents), INDEX_ENTRY)
    for number, document in enumerate(documents):
        time_ns = int(log_time_ns(begin_ns, document.at_s))
        entries[number] = (time_ns, builder.count)
        content = json.dumps(document.content, ensure_ascii=False, allow_nan=False).encode()
        Message(document.channel, time_ns, content, time_ns, (sequence + number) & 0xFFFFFFFF).write(builder)
    return _chunk(builder.end(), documents[0].channel, entries, offset)


def index_record(channel: int, entries: np.ndarray) -> bytes:
    """Return the message index of one chunk."""
    content = struct.pack("<HI", channel, entries.nbytes) + entries.tobytes()
    return struct.pack("<BQ", OPCODE_MESSAGE_INDEX, len(content)) + content


def _chunk(data: bytes, channel: int, entries: np.ndarray, offset: int) -> tuple[bytes, Place]:
    times = entries["log_time"]
    compressed = zstandard.ZstdCompressor(level=LEVEL).compress(data)
    builder = RecordBuilder()
    chunk = Chunk("zstd", compressed, int(times.max()), int(times.min()), zlib.crc32(data), len(data))
    chunk.write(builder)
    record, index = builder.end(), index_record(channel, entries)
    place = Place(
        chunk.message_start_time, chunk.message_end_time, offset, len(record), len(index), channel, len(entries),
        len(compressed), len(data),
    )  # fmt: skip
    return record + index, place
