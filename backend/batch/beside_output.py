"""The parts of a batch that runs without a server: in a folder beside its output until that is whole.

One command at a time has them. The folder holds the document and how it was divided, so that the same command goes on where it
was ended.
"""

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from filelock import FileLock, Timeout

from backend.batch.folder import BatchFolder, Division
from backend.batch.result_jobs import export
from backend.batch.version import model_version

FORMS = {".parquet": "parquet", ".csv": "csv", ".arrow": "arrow"}


class OutputExists(ValueError):
    """Something stands where the output is to be written, and nobody has said that it may go."""


class BesideOutput:
    """The parts of the table that is to become `output`, in OUTPUT.parts.

    `samples` says whether any may be kept, `replace` whether an output that is there already may go.
    """

    def __init__(self, output: Path, samples: bool = True, replace: bool = False) -> None:
        self.output, self.path = output, output.with_name(f"{output.name}.parts")
        self.folder = BatchFolder(self.path)
        self._samples, self._replace = samples, replace

    @property
    def trajectories(self) -> Path:
        """Where the samples kept go."""
        return self.output.with_name(f"{self.output.stem}-trajectories{self.output.suffix}")

    def check(self) -> None:
        """Raise ValueError or OSError if the output has no folder to be in, OutputExists if it is there and has to stay."""
        folder = self.output.parent
        if not folder.is_dir():
            raise ValueError(
                f"{self.output} cannot be written: folder {folder} does not exist; make it, or write elsewhere"
            )
        with tempfile.TemporaryFile(dir=folder):
            pass  # a folder that takes a file now takes the parts
        for target in (self.output, self.trajectories) if self._samples else (self.output,):
            if target.is_dir():
                raise ValueError(f"{target} is a folder; expected the name of a file to write")
            if os.path.lexists(target) and not self._replace:
                raise OutputExists(f"{target} exists; add --force to replace it, or write elsewhere")

    @contextmanager
    def held(self) -> Iterator[None]:
        """Keep every other command away from the parts and the output. Raises ValueError while another has them, OSError."""
        lock = FileLock(f"{self.path}.lock", timeout=0)
        try:
            lock.acquire()
        except Timeout:
            raise ValueError(f"{self.path} is in use by another vssea batch; wait for it, or write elsewhere") from None
        try:
            yield
        finally:
            with suppress(OSError):
                Path(lock.lock_file).unlink()  # while it is still held: nobody else can hold the file that goes
            lock.release()

    def take_up(self, document: str, part_size: int) -> int:
        """Make the folder, or take up the one that is there, and return the runs of its parts.

        Raises ValueError if it is of another document or version, OSError.
        """
        if not self.path.exists():
            new = BatchFolder(self.path.with_name(f"{self.path.name}.new"))
            new.delete()
            new.create(document, Division(part_size, model_version()))
            new.path.rename(self.path)
            return part_size
        division = self.folder.division()
        if division is None or not self.folder.document_path.exists():
            raise ValueError(f"{self.path} is no folder of a batch's parts; remove it, or write elsewhere")
        if self.folder.document() != document:
            raise ValueError(f"{self.path} holds parts of another batch; remove it, or write elsewhere")
        if division.version != model_version():
            raise ValueError(
                f"{self.path} holds parts computed by another version of the model; remove it, or write elsewhere"
            )
        return division.part_size

    def finish(self) -> list[Path]:
        """Write the output, and the samples if any were kept, remove the parts, and return what was written.

        Raises OSError, OutputExists if somebody has written it meanwhile.
        """
        targets = {"results": self.output} | ({"trajectories": self.trajectories} if self.folder.trajectories() else {})
        written = {
            target: Path(export(str(self.path), what, FORMS[target.suffix.lower()], str(self.path))[1])
            for what, target in targets.items()
        }
        self.check()
        for target, whole in written.items():
            whole.chmod(0o666 & ~_umask())
            whole.replace(target)
        if self._samples and self._replace and self.trajectories not in written:
            self.trajectories.unlink(missing_ok=True)  # beside the new output those of an old one would mislead
        shutil.rmtree(self.path)
        return [*written]


def _umask() -> int:
    mask = os.umask(0o077)
    os.umask(mask)
    return mask
