"""A recording while it is written: append-only, readable at any moment, and finished with an index.

What is on disk is a row of whole records and at most one torn one, whatever happens to the process: each chunk is written
with one call. `reopen` cuts off what is torn and goes on.
"""

import fcntl
import json
from collections.abc import Sequence
from contextlib import ExitStack
from itertools import groupby
from pathlib import Path
from typing import IO

from mcap.data_stream import RecordBuilder
from mcap.records import Channel, Header, Metadata, Schema

from backend.recordings.chunks import Document, Place, document_chunk, sample_chunk, sample_records
from backend.recordings.layout import FIELDS, JSON_SCHEMAS, TELEMETRY, TOPICS, telemetry_schema
from backend.recordings.scan import MAGIC, Scan, scan
from backend.recordings.summary_section import summary_section
from backend.telemetry.ring import Samples

LIBRARY = "vssea"
BEGINNING = ".beginning"
HEAD, ENDING = "recording", "ending"
"""Names of the metadata records at begin and end."""


class FinishedRecording(ValueError):
    """The file has its index already: there is nothing to append to."""


class RecordingFile:
    """Writes one recording. Every method raises OSError if the disk refuses; what was written before stays whole."""

    def __init__(self, path: Path, file: IO[bytes], found: Scan) -> None:
        self.path, self.head = path, found.metadata[HEAD]
        self._file, self._found = file, found
        self._offset = found.end
        self.begin_ns = int(self.head["begin_ns"])
        self._sequences = dict.fromkeys(TOPICS, 0)
        for place in found.places:
            self._sequences[place.channel] += place.messages

    @classmethod
    def create(cls, path: Path, head: dict[str, str]) -> "RecordingFile":
        """Begin a recording; `head` becomes its metadata and needs `begin_ns`, the log time of t = 0."""
        path.parent.mkdir(parents=True, exist_ok=True)
        builder = RecordBuilder()
        Header("", LIBRARY).write(builder)
        Metadata(HEAD, head).write(builder)
        for record in declarations():
            record.write(builder)
        beginning = path.with_name(f"{path.name}{BEGINNING}")
        with ExitStack() as undo:
            file = undo.enter_context(beginning.open("w+b", buffering=0))
            undo.callback(beginning.unlink, missing_ok=True)
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            _write(file, MAGIC + builder.end())
            beginning.rename(path)  # under its own name a file is a recording from its first byte on
            undo.pop_all()
        return cls(path, file, scan(path))

    @classmethod
    def reopen(cls, path: Path) -> "RecordingFile":
        """Go on with an unfinished recording; a torn record at its end is cut off.

        Raises FinishedRecording, BlockingIOError if another process writes it, ValueError if it never became a recording.
        """
        with ExitStack() as undo:
            file = undo.enter_context(path.open("r+b", buffering=0))
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            found = scan(path)
            if found.is_finished:
                raise FinishedRecording(f"{path.name} is finished")
            if HEAD not in found.metadata:
                raise ValueError(f"{path.name} ends before its recording begins")
            file.truncate(found.end)
            file.seek(found.end)
            undo.pop_all()
        recording = cls(path, file, found)
        if found.missing_index:
            recording._append(found.missing_index)
        return recording

    @property
    def size(self) -> int:
        """Bytes written."""
        return self._offset

    @property
    def samples(self) -> int:
        """Samples written."""
        return self._sequences[TELEMETRY]

    def append_samples(self, samples: Samples, first: int) -> None:
        """Write consecutive samples (n, ring.COLUMNS), n > 0, from sample number `first` on, as one chunk."""
        content, place = sample_chunk(sample_records(samples, first, self.begin_ns), self._offset)
        self._append(content, place)

    def append_documents(self, documents: Sequence[Document]) -> None:
        """Write JSON messages, one chunk a channel."""
        for channel, group in groupby(sorted(documents, key=lambda d: (d.channel, d.at_s)), key=lambda d: d.channel):
            content, place = document_chunk(list(group), self.begin_ns, self._sequences[channel], self._offset)
            self._append(content, place)

    @property
    def descriptor(self) -> int:
        """The open file's descriptor."""
        return self._file.fileno()

    def finish(self, **ending: str) -> None:
        """Write the index at the end, with `ending` as metadata, and close."""
        builder = RecordBuilder()
        Metadata(ENDING, ending).write(builder)
        content = builder.end()
        self._found.metadata_places.append((ENDING, self._offset, len(content)))
        self._append(content)
        self._append(summary_section(self._found, declarations(), self._offset))
        self.close()

    def close(self) -> None:
        """Leave the file as it is."""
        self._file.close()

    def _append(self, content: bytes, place: Place | None = None) -> None:
        try:
            _write(self._file, content)
        except OSError:
            self._file.truncate(self._offset)  # half a record would end the file for every reader
            self._file.seek(self._offset)
            raise
        self._offset += len(content)
        if place is not None:
            self._found.places.append(place)
            self._sequences[place.channel] += place.messages


def declarations() -> list[Schema | Channel]:
    """Return the schemas and channels of every recording."""
    units = {field.name: field.unit for field in FIELDS if field.unit}
    records: list[Schema | Channel] = [
        Schema(TELEMETRY, telemetry_schema(), "protobuf", "vssea.Telemetry"),
        Channel(TELEMETRY, TOPICS[TELEMETRY], "protobuf", units, TELEMETRY),
    ]
    for channel, (name, schema) in JSON_SCHEMAS.items():
        records.append(Schema(channel, json.dumps(schema).encode(), "jsonschema", name))
        records.append(Channel(channel, TOPICS[channel], "json", {}, channel))
    return records


def _write(file: IO[bytes], content: bytes) -> None:
    view = memoryview(content)
    while view:
        view = view[file.write(view) :]
