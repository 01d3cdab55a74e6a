"""Finding one's way in a recording without its index: record by record, up to the first torn one."""

import struct
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO

import numpy as np
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Chunk, Metadata
from mcap.stream_reader import get_chunk_data_stream

from backend.recordings.chunks import INDEX_ENTRY, Place, index_record
from backend.recordings.layout import MESSAGE, RECORD_HEAD, TELEMETRY

MAGIC = b"\x89MCAP0\r\n"
RECORD = struct.Struct("<BQ")
CHUNK_HEAD = struct.Struct("<QQQII")  # start, end, size, crc, length of the compression's name
INDEX_HEAD = struct.Struct("<HI")


@dataclass
class Scan:
    """What a file holds: chunks, metadata, where its last whole record ends, and whether it has its index."""

    places: list[Place] = field(default_factory=list)
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    metadata_places: list[tuple[str, int, int]] = field(default_factory=list)
    end: int = 0
    is_finished: bool = False
    missing_index: bytes = b""
    """Index of the last chunk, if the file ends between the two."""


def scan(path: Path) -> Scan:
    """Walk through the records of a recording. Raises ValueError if it is no MCAP file."""
    found = Scan()
    size = path.stat().st_size
    with path.open("rb") as file:
        if file.read(len(MAGIC)) != MAGIC:
            raise ValueError(f"{path.name} is not a recording: it does not begin as an MCAP file")
        found.end = len(MAGIC)
        pending: Place | None = None
        while (content_at := found.end + RECORD.size) <= size:
            file.seek(found.end)
            opcode, length = RECORD.unpack(file.read(RECORD.size))
            if content_at + length > size:
                break
            if opcode == Opcode.CHUNK:
                pending = _chunk_place(file, found.end, length)
            elif opcode == Opcode.MESSAGE_INDEX and pending is not None:
                channel, entries = INDEX_HEAD.unpack(file.read(INDEX_HEAD.size))
                found.places.append(_indexed(pending, channel, entries // INDEX_ENTRY.itemsize, RECORD.size + length))
                pending = None
            elif opcode == Opcode.METADATA:
                record = Metadata.read(ReadDataStream(file))
                found.metadata[record.name] = record.metadata
                found.metadata_places.append((record.name, found.end, RECORD.size + length))
            elif opcode == Opcode.DATA_END:
                file.seek(-len(MAGIC), 2)
                found.is_finished = file.read() == MAGIC  # else its index is torn, and is written anew
                break
            found.end = content_at + length
        if pending is not None:
            found.missing_index = _index_of(file, pending)
            entries = (len(found.missing_index) - RECORD.size - INDEX_HEAD.size) // INDEX_ENTRY.itemsize
            channel = INDEX_HEAD.unpack_from(found.missing_index, RECORD.size)[0]
            found.places.append(_indexed(pending, channel, entries, len(found.missing_index)))
    return found


def _chunk_place(file: IO[bytes], offset: int, length: int) -> Place:
    start, end, size, _, name = CHUNK_HEAD.unpack(file.read(CHUNK_HEAD.size))
    file.seek(name, 1)
    (compressed,) = struct.unpack("<Q", file.read(8))
    return Place(start, end, offset, RECORD.size + length, 0, 0, 0, compressed, size)


def _indexed(place: Place, channel: int, messages: int, length: int) -> Place:
    return Place(
        place.start_ns,
        place.end_ns,
        place.offset,
        place.length,
        length,
        channel,
        messages,
        place.compressed,
        place.size,
    )


def _index_of(file: IO[bytes], place: Place) -> bytes:
    """Return the message index of a chunk, from its content."""
    file.seek(place.offset + RECORD.size)
    stream, size = get_chunk_data_stream(Chunk.read(ReadDataStream(file)), validate_crc=True)
    data = stream.read(size)
    channel, entries, at = TELEMETRY, [], 0
    while at < size:
        _, length = RECORD.unpack_from(data, at)
        channel, _, log_time = struct.unpack_from("<HIQ", data, at + RECORD_HEAD)
        entries.append((log_time, at))
        at += RECORD_HEAD + length
    return index_record(channel, np.array(entries, INDEX_ENTRY))


def holds_samples(place: Place) -> bool:
    """Return whether a chunk is a plain block of telemetry samples."""
    return place.channel == TELEMETRY and place.size == place.messages * MESSAGE.itemsize
