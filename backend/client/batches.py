"""The batches of a server: start one, wait for it, take its tables home."""

import shutil
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import IO, Any, cast
from urllib.parse import quote

import pyarrow as pa
import pyarrow.parquet

from backend.client.connection import Connection
from backend.client.document import document_of
from backend.client.problem import VsseaError

Document = dict[str, Any]
ENDED = ("done", "cancelled", "failed")
AWAY_LIMIT_S = 60.0
FORMS = (".parquet", ".csv", ".arrow")


class Batches:
    """What `VsseaClient.batches` is; every call raises VsseaError with one sentence."""

    def __init__(self, connection: Connection, simulate: Callable[..., pa.Table]) -> None:
        self._connection, self._simulate = connection, simulate

    def estimate(self, document: Any) -> Document:
        """Return how many runs, seconds and bytes a batch would take, and what of it would be refused."""
        return self._json("POST", "/estimate", document_of(document))

    def create(self, document: Any, key: str | None = None) -> Document:
        """Start a batch and return what the server says of it.

        With the same `key` (any text of your own) the same document starts once, however often it is sent.
        """
        return self._json("POST", "", document_of(document), headers={} if key is None else {"Idempotency-Key": key})

    def list(self, state: str | None = None, offset: int = 0, limit: int | None = None) -> Any:
        """Return the batches, newest first, as the server lists them."""
        return self._connection.json("GET", "/api/batches", query={"state": state, "offset": offset, "limit": limit})

    def get(self, batch: str) -> Document:
        """Return state, progress, rate, time left and counts of a batch."""
        return self._json("GET", _of(batch))

    def document(self, batch: str) -> Document:
        """Return the document that a batch was started with."""
        return self._json("GET", f"{_of(batch)}/document")

    def wait(
        self,
        batch: str,
        progress: Callable[[Document], object] | None = None,
        every_s: float = 0.5,
        limit_s: float | None = None,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], object] = time.sleep,
    ) -> Document:
        """Return a batch's document once it has ended, done or cancelled; `progress` is given each one until then.

        A server that has answered once and then is away is asked again for AWAY_LIMIT_S. Raises VsseaError if it stays away,
        with the batch's reason if it failed, or if it goes on after `limit_s`.
        """
        until = None if limit_s is None else clock() + limit_s
        answered_s: float | None = None
        while True:
            found = None
            try:
                found, answered_s = self.get(batch), clock()
            except VsseaError as error:  # with a status the server has answered
                if error.status is not None or answered_s is None or clock() - answered_s >= AWAY_LIMIT_S:
                    raise
            if found is not None:
                if progress is not None:
                    progress(found)
                if found["state"] == "failed":
                    raise VsseaError(f"batch {batch} failed: {found.get('reason') or 'no reason is known'}")
                if found["state"] in ENDED:
                    return found
            if until is not None and clock() >= until:
                state = "not answered for" if found is None else f"still {found['state']}"
                raise VsseaError(f"batch {batch} is {state} after {limit_s:g} s; wait for it again")
            sleep(every_s)

    def cancel(self, batch: str) -> Document:
        """End a batch; the parts that are done stay."""
        return self._json("POST", f"{_of(batch)}/cancel", {})

    def resume(self, batch: str) -> Document:
        """Let a batch that failed or was cancelled go on with the parts that are missing."""
        return self._json("POST", f"{_of(batch)}/resume", {})

    def delete(self, batch: str) -> None:
        """Delete a batch that does not run, with its results."""
        self._connection.json("DELETE", f"/api/batches{_of(batch)}")

    def results(self, batch: str, columns: Sequence[str] | None = None) -> pa.Table:
        """Return a row for each run that is done: its number, values by path, state, metrics, shares of limits."""
        return self._table(f"{_of(batch)}/results.parquet", columns)

    def trajectories(self, batch: str, columns: Sequence[str] | None = None) -> pa.Table:
        """Return the samples kept: run, time [s] and the channels that the batch keeps."""
        return self._table(f"{_of(batch)}/trajectories.parquet", columns)

    def save(self, batch: str, file: Path | str) -> Path:
        """Write the results into a file, its form told by its name (.parquet, .csv, .arrow), and return its path."""
        target = Path(file)
        if target.suffix.lower() not in FORMS:
            raise VsseaError(f"{target} cannot be written: expected a name ending in {', '.join(FORMS)}")
        unfinished = target.with_name(f"{target.name}.new")
        try:
            with unfinished.open("wb") as written:
                self._download(f"{_of(batch)}/results{target.suffix.lower()}", written)
            unfinished.replace(target)
        except OSError as error:
            raise VsseaError(f"{target} cannot be written: {error}") from error
        finally:
            unfinished.unlink(missing_ok=True)
        return target

    def run(self, batch: str, run: int) -> Document:
        """Return values, state and figures of one run."""
        return self._json("GET", f"{_of(batch)}/runs/{run}")

    def scenario(self, batch: str, run: int) -> Document:
        """Return the whole scenario of one run."""
        return self._json("GET", f"{_of(batch)}/runs/{run}/scenario")

    def simulate(self, batch: str, run: int, every: int = 1) -> pa.Table:
        """Return the trajectory of one run with all channels, computed anew and equal to the bit."""
        return self._simulate(self.scenario(batch, run), every, allow_unstable=True)

    def _json(self, method: str, path: str, body: Any = None, headers: dict[str, str] | None = None) -> Document:
        return cast(Document, self._connection.json(method, f"/api/batches{path}", body, headers=headers))

    def _table(self, path: str, columns: Sequence[str] | None) -> pa.Table:
        try:
            with tempfile.TemporaryFile() as file:
                self._download(path, file)
                file.seek(0)
                known = pa.parquet.read_schema(file).names
                unknown = [name for name in columns or () if name not in known]
                if unknown:
                    raise VsseaError(f"there is no column {unknown[0]!r}; known here: {', '.join(known)}")
                file.seek(0)
                return pa.parquet.read_table(file, columns=None if columns is None else [*columns])
        except (OSError, pa.ArrowException) as error:
            raise VsseaError(f"the answer to GET /api/batches{path} cannot be read: {error}") from error

    def _download(self, path: str, file: IO[bytes]) -> None:
        with self._connection.opened("GET", f"/api/batches{path}") as answer:
            shutil.copyfileobj(answer, file, 1 << 20)
            missing = getattr(answer, "length", None)  # of what the head promised; reading in pieces does not look
        if missing:
            raise VsseaError(f"the answer to GET /api/batches{path} broke off, {missing} bytes are missing; ask again")


def _of(batch: str) -> str:
    return f"/{quote(batch, safe='')}"
