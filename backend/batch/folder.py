"""The files of one batch: its document, how it is divided, and two files a part at most. A file that is there is whole."""

import json
import os
import re
import shutil
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path

from backend.batch.engine import PartFiles

DOCUMENT, DIVISION, ROWS, TRAJECTORIES = "batch.json", "parts.json", "part", "trajectories"
UNFINISHED, DAMAGED, DELETED = ".new", ".damaged", ".deleted"
PART = re.compile(rf"{ROWS}-(\d{{5,}})\.parquet")
OWN = re.compile(rf"({DOCUMENT}|{DIVISION}|({ROWS}|{TRAJECTORIES})-\d+\.parquet)({UNFINISHED}|{DAMAGED})?")


@dataclass(frozen=True)
class Division:
    """What all parts of a batch have in common: the runs of each but the last one, and the version that computes them."""

    part_size: int
    version: str


class BatchFolder:
    """The folder of a batch. Its methods block for a moment; the web process calls them in threads."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def create(self, document: str, division: Division) -> None:
        """Make the folder with the batch's document in it, and how it is divided. Raises OSError."""
        self.path.mkdir(parents=True)
        self._write(DIVISION, json.dumps(asdict(division)).encode())
        self._write(DOCUMENT, document.encode())

    def division(self) -> Division | None:
        """Return how it is divided, None if that is not told. Raises OSError."""
        try:
            told = json.loads((self.path / DIVISION).read_bytes())
            return Division(int(told["part_size"]), str(told["version"]))
        except (FileNotFoundError, ValueError, KeyError, TypeError):
            return None

    def begin_anew(self, division: Division) -> None:
        """Remove all parts, so that only those of another division are kept from now on. Raises OSError."""
        for number in self.parts():
            self.rows_of(number).unlink()
        for path in self.path.glob(f"{TRAJECTORIES}-*.parquet"):
            path.unlink()
        self._write(DIVISION, json.dumps(asdict(division)).encode())

    @property
    def document_path(self) -> Path:
        """Where the batch's document is."""
        return self.path / DOCUMENT

    def document(self) -> str:
        """Return the batch's document as JSON. Raises OSError."""
        return self.document_path.read_text("utf-8")

    def keep(self, number: int, files: PartFiles) -> int:
        """Keep a part and return its bytes; its rows come last, so that they stand for all of it. Raises OSError."""
        if files.trajectories:
            self._write(_name(TRAJECTORIES, number), files.trajectories)
        self._write(_name(ROWS, number), files.rows)
        return len(files.rows) + len(files.trajectories)

    def parts(self) -> list[int]:
        """Return the numbers of the parts that are there, in order."""
        found = (PART.fullmatch(path.name) for path in self.path.glob("part-*"))
        return sorted(int(match[1]) for match in found if match)

    def put_aside(self, number: int) -> None:
        """Let a part be missing whose files cannot be read; they stay under another name. Raises OSError."""
        for name in (_name(ROWS, number), _name(TRAJECTORIES, number)):
            if (self.path / name).exists():
                (self.path / name).replace(self.path / f"{name}{DAMAGED}")

    def rows_of(self, number: int) -> Path:
        """Return where the rows of a part are."""
        return self.path / _name(ROWS, number)

    def trajectories_of(self, number: int) -> Path:
        """Return where the samples of a part are, if any are kept."""
        return self.path / _name(TRAJECTORIES, number)

    def trajectories(self) -> list[Path]:
        """Return the files of samples of the parts that are there, in order."""
        paths = [self.trajectories_of(number) for number in self.parts()]
        return [path for path in paths if path.exists()]

    def size(self) -> int:
        """Return the bytes of all files."""
        return sum(path.stat().st_size for path in self.path.iterdir())

    def delete(self) -> None:
        """Remove all of it, if it is there. Raises OSError."""
        with suppress(FileNotFoundError):
            shutil.rmtree(self.path)

    def renamed(self, ending: str) -> "BatchFolder":
        """Give it, if it is there, a name with another ending, and return it under that. Raises OSError."""
        other = BatchFolder(self.path.with_name(self.path.name.removesuffix(DELETED) + ending))
        with suppress(FileNotFoundError):
            self.path.rename(other.path)
        return other

    def has_only_its_own(self) -> bool:
        """Return whether nobody has put another file into it. Raises OSError."""
        return all(OWN.fullmatch(path.name) for path in self.path.iterdir())

    def _write(self, name: str, content: bytes) -> None:
        unfinished = self.path / f"{name}{UNFINISHED}"
        with unfinished.open("wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        unfinished.replace(self.path / name)
        _sync_folder(self.path)


def _name(kind: str, number: int) -> str:
    return f"{kind}-{number:05d}.parquet"


def _sync_folder(folder: Path) -> None:
    if os.name == "nt":
        return  # there a folder cannot be opened, and needs no flush
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
