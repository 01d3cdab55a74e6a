"""A recording that is written in one go: under its name it is there whole, or not at all."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from backend.recordings.recording_file import BEGINNING, RecordingFile


@contextmanager
def whole_file(target: Path, head: dict[str, str], reason: str) -> Iterator[RecordingFile]:
    """Give a recording to write to; at the end it is finished, for `reason`, and takes its place at `target`."""
    unfinished = target.with_name(f"{target.stem}.new{BEGINNING}")
    file = RecordingFile.create(unfinished, head)
    try:
        yield file
        file.finish(reason=reason, lost="0")
        unfinished.replace(target)
    finally:
        file.close()
        unfinished.unlink(missing_ok=True)
