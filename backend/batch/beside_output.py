"""The parts of a batch that runs without a server: in a folder beside its output until that is whole.

One command at a time has them. The folder holds the document and how it was divided, so that the same command goes on where it
was ended.
"""

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from filelock import FileLock, Timeout

from backend.batch.folder import BatchFolder, Division
from backend.batch.result_jobs import export
from backend.batch.version import model_version

FORMS = {".parquet": "parquet", ".csv": "csv", ".arrow": "arrow"}


class BesideOutput:
    """The parts of the table that is to become `output`, in OUTPUT.parts."""

    def __init__(self, output: Path) -> None:
        self.output, self.path = output, output.with_name(f"{output.name}.parts")
        self.folder = BatchFolder(self.path)

    @property
    def trajectories(self) -> Path:
        """Where the samples kept go."""
        return self.output.with_name(f"{self.output.stem}-trajectories{self.output.suffix}")

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
        """Write the output, and the samples if any were kept, remove the parts, and return what was written. Raises OSError."""
        targets = {"results": self.output} | ({"trajectories": self.trajectories} if self.folder.trajectories() else {})
        for what, target in targets.items():
            _, written = export(str(self.path), what, FORMS[target.suffix], str(self.path))
            Path(written).chmod(0o666 & ~_umask())
            Path(written).replace(target)
        if "trajectories" not in targets:
            self.trajectories.unlink(missing_ok=True)  # of an earlier batch with this output
        shutil.rmtree(self.path)
        return [*targets.values()]


def _umask() -> int:
    mask = os.umask(0o077)
    os.umask(mask)
    return mask
