"""Reading a recording: samples as arrays, documents by topic; finished, being written, or cut off."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.records import Chunk, Message
from mcap.stream_reader import CRCValidationError, breakup_chunk, get_chunk_data_stream
from numpy.typing import NDArray

from backend.recordings.chunks import NS, Place
from backend.recordings.layout import FIELD_INDEX, MESSAGE, TELEMETRY
from backend.recordings.recording_file import ENDING, HEAD
from backend.recordings.scan import RECORD, holds_samples, scan

SAME_INSTANT_S = 1e-9
"""Times are k T in floating point: a span to 5.1 s has the sample at 5.1000000000000005 s."""
ANOTHER_INSTANT_S = 2.0 * SAME_INSTANT_S
"""Added to the end of a span, this begins the next one."""
DAMAGE = (CRCValidationError, McapError, ValueError, zstandard.ZstdError)


@dataclass(frozen=True)
class Block:
    """Samples of one channel list: `rows` (n, channels), their sample numbers modulo 2^32 (n,)."""

    numbers: NDArray[np.int64]
    rows: NDArray[np.float64]

    def gaps(self) -> NDArray[np.intp]:
        """Return the rows before which samples are missing."""
        return np.flatnonzero(np.diff(self.numbers) % 2**32 != 1) + 1


class Recording:
    """A recording's file, opened for reading. Raises ValueError if it is none; damaged chunks are left out and counted."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.status = path.stat()  # before it is looked through: what grows meanwhile is a later state
        self.damaged = 0
        found = scan(path)
        if HEAD not in found.metadata:
            raise ValueError(
                f"{path.name} is not a recording of this program: it lacks the record that says what it is"
            )
        self.head = found.metadata[HEAD]
        self.ending = found.metadata.get(ENDING)
        self.is_finished = found.is_finished
        self.begin_ns = int(self.head["begin_ns"])
        self._blocks = [place for place in found.places if holds_samples(place)]
        self._documents = [place for place in found.places if place.channel != TELEMETRY]

    @property
    def samples(self) -> int:
        """Number of samples."""
        return sum(place.messages for place in self._blocks)

    @property
    def last_number(self) -> int:
        """Sample number of the last sample; one less than the first one's of an empty recording."""
        first = int(self.head.get("first_sample", 0))
        if not self._blocks:
            return first - 1
        with self.path.open("rb") as file:
            data = self._data(file, self._blocks[-1])
        if data is None:
            return first - 1 + self.samples
        return first + (int(np.frombuffer(data, MESSAGE)["sequence"][-1]) - first) % 2**32

    @property
    def span(self) -> tuple[float, float]:
        """First and last time [s]; (0, 0) of an empty recording."""
        if not self._blocks:
            return 0.0, 0.0
        return (self._blocks[0].start_ns - self.begin_ns) / NS, (self._blocks[-1].end_ns - self.begin_ns) / NS

    def count(self, from_s: float = -np.inf, to_s: float = np.inf) -> int:
        """Return about how many samples a span has, told from where its chunks begin and end."""
        total = 0.0
        for place in self._blocks:
            begin, end = (place.start_ns - self.begin_ns) / NS, (place.end_ns - self.begin_ns) / NS
            if begin >= from_s and end <= to_s:
                total += place.messages
            elif end >= from_s and begin <= to_s:
                total += place.messages * (min(end, to_s) - max(begin, from_s)) / (end - begin)
        return round(total)

    def read(self, channels: list[str], from_s: float = -np.inf, to_s: float = np.inf) -> Block:
        """Return the samples of a span, both ends included. Raises ValueError for a channel that there is not."""
        parts = [_columns(records, channels) for records in self.blocks(from_s, to_s)]
        if not parts:
            return Block(np.empty(0, np.int64), np.empty((0, len(channels))))
        numbers = np.concatenate([records for records, _ in parts])
        return Block(numbers, np.concatenate([rows for _, rows in parts]))

    def blocks(self, from_s: float = -np.inf, to_s: float = np.inf) -> Any:
        """Yield the span's samples as message records (n,), chunk by chunk."""
        time = f"value{FIELD_INDEX['time']}"
        low_s, high_s = from_s - SAME_INSTANT_S, to_s + SAME_INSTANT_S
        with self.path.open("rb") as file:
            for place in self._blocks:
                if (place.end_ns - self.begin_ns) / NS < low_s or (place.start_ns - self.begin_ns) / NS > high_s:
                    continue
                data = self._data(file, place)
                if data is None:
                    continue
                records = np.frombuffer(data, MESSAGE)
                inside = (records[time] >= low_s) & (records[time] <= high_s)
                if inside.all():
                    yield records
                elif inside.any():
                    yield records[inside]

    def documents(self, channel: int) -> list[dict[str, Any]]:
        """Return the contents of all JSON messages of a channel, in the order of time."""
        contents: list[tuple[int, int, dict[str, Any]]] = []
        with self.path.open("rb") as file:
            for place in self._documents:
                if place.channel != channel:
                    continue
                chunk = self._chunk(file, place)
                try:
                    records = breakup_chunk(chunk, validate_crc=True)
                except DAMAGE:
                    self.damaged += 1
                    continue
                contents += [(r.log_time, r.sequence, json.loads(r.data)) for r in records if isinstance(r, Message)]
        told = [content for _, _, content in sorted(contents, key=lambda item: item[:2])]
        # What a writer wrote just before it was killed is told to the next one again.
        return list({content.get("n", -1 - place): content for place, content in enumerate(told)}.values())

    def _data(self, file: IO[bytes], place: Place) -> bytes | None:
        try:
            stream, size = get_chunk_data_stream(self._chunk(file, place), validate_crc=True)
        except DAMAGE:
            self.damaged += 1
            return None
        return stream.read(size)

    @staticmethod
    def _chunk(file: IO[bytes], place: Place) -> Chunk:
        file.seek(place.offset + RECORD.size)
        return Chunk.read(ReadDataStream(file))


def _columns(records: np.ndarray, channels: list[str]) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    unknown = [name for name in channels if name not in FIELD_INDEX]
    if unknown:
        raise ValueError(f"a recording has no channel {unknown[0]!r}; known: {', '.join(FIELD_INDEX)}")
    rows = np.empty((len(records), len(channels)))
    for number, name in enumerate(channels):
        rows[:, number] = records[f"value{FIELD_INDEX[name]}"]
    return records["sequence"].astype(np.int64), rows
