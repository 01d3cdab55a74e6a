"""Which server runs the batches of a folder: one at a time, whose process is named in a file beside the lock."""

import logging
import os
from contextlib import suppress
from pathlib import Path

from filelock import FileLock, Timeout

from backend.problem import Problem

logger = logging.getLogger(__name__)
LOCK, PROCESS = "server.lock", "server.process"


class FolderLock:
    """The lock of one folder; it ends with the process that has it. Its methods block for a moment."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._lock = FileLock(folder / LOCK, timeout=0, thread_local=False)  # taken and given back in any thread

    def take(self) -> None:
        """Have the folder for this process. Raises Problem if another one has it, or if it cannot be written."""
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            self._lock.acquire()
            (self._folder / PROCESS).write_text(str(os.getpid()))
        except Timeout:
            raise self._of_another() from None
        except NotImplementedError:
            logger.warning("%s knows no locks: see to it that only one server uses it", self._folder)
        except OSError as error:
            self._lock.release()
            raise Problem(507, "Not kept", f"{self._folder} cannot be written: {error.strerror or error}.") from error

    def give_back(self) -> None:
        """Leave the folder to others."""
        self._lock.release()

    def _of_another(self) -> Problem:
        number = ""
        with suppress(OSError, ValueError):
            number = f" (process {int((self._folder / PROCESS).read_text())})"
        return Problem(
            409,
            "Run by another server",
            f"The batches in {self._folder} are run by another server{number}; stop it, or give this one a folder of its own "
            "with VSSEA_DATA_DIR or VSSEA_BATCHES_DIR.",
        )
