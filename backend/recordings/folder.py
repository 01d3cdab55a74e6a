"""The folder of the recordings: which files there are, and which of them wait to be finished."""

import fcntl
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Metadata

from backend.recordings.recording_file import BEGINNING, HEAD, FinishedRecording, RecordingFile
from backend.recordings.scan import MAGIC, RECORD


@dataclass(frozen=True)
class Found:
    """One file: its size, when it was last written, and whether it has its end."""

    id: str
    path: Path
    size: int
    modified_s: float
    is_finished: bool


def recordings_in(folder: Path) -> dict[str, Found]:
    """Return the recordings of a folder by id, oldest first; one that vanishes meanwhile is left out."""
    found = []
    for path in folder.glob("*.mcap"):
        with suppress(OSError):
            status = path.stat()
            found.append(Found(path.stem, path, status.st_size, status.st_mtime, _is_finished(path)))
    return {each.id: each for each in sorted(found, key=lambda each: (each.modified_s, each.id))}


def head_of(path: Path) -> dict[str, str]:
    """Return what a file says of itself at its begin, {} if it is no recording."""
    with path.open("rb") as file:
        if file.read(len(MAGIC)) != MAGIC:
            return {}
        while len(begin := file.read(RECORD.size)) == RECORD.size:
            opcode, length = RECORD.unpack(begin)
            at = file.tell()
            if opcode == Opcode.CHUNK:
                return {}
            if opcode == Opcode.METADATA:
                record = Metadata.read(ReadDataStream(file))
                if record.name == HEAD:
                    return record.metadata
            file.seek(at + length)
    return {}


def recover(path: Path) -> bool:
    """Finish a recording that its writer could not; return whether that was done. Raises ValueError if it is none.

    One that another process writes is left, and so is one on a disk without room for its end.
    """
    try:
        RecordingFile.reopen(path).finish(reason="its writer was killed", recovered="true")
    except (FinishedRecording, OSError):
        return False
    return True


def sweep(folder: Path) -> None:
    """Remove beginnings that never became a recording."""
    for path in folder.glob(f"*{BEGINNING}"):
        with suppress(OSError), path.open("rb") as file:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            path.unlink()


def _is_finished(path: Path) -> bool:
    with path.open("rb") as file:
        file.seek(0, 2)
        if file.tell() < 2 * len(MAGIC):
            return False
        file.seek(-len(MAGIC), 2)
        return file.read() == MAGIC
