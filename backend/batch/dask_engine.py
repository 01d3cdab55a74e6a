"""Parts of batches computed by a Dask cluster, found by its scheduler's address.

A task is the part itself (the batch's document, first run, count), so workers share no disk; they need this package. Dask gives
the part of a worker that is gone to another one by itself. Twice as many parts as threads are under way: a worker that is
done with one has the next in hand. `distributed`, the extra vssea[dask], is imported when the first part is asked for.
"""

import asyncio
import importlib.util
import logging
import re
from typing import Any
from uuid import uuid4

from backend.batch.engine import OutOfReach, PartFailed, PartFiles, PartTask, WorkerLost

CONNECT_LIMIT_S = 10.0
AHEAD = 2
"""Parts under way for each thread of the cluster."""
ADDRESS = re.compile(r"(tcp|tls|ws|wss|ucx)://[^\s/]+:\d+/?")
COMPUTE = "backend.batch.dask_part", "compute"


def compute(part: PartTask) -> PartFiles | None:
    """Return a part's files, on a worker; the web process knows only the name of what computes them."""
    module, function = COMPUTE
    files: PartFiles | None = getattr(importlib.import_module(module), function)(part)
    return files


class DaskEngine:
    """The workers of the scheduler at `address`, such as tcp://127.0.0.1:8786.

    Raises ValueError for what is no address, or without `distributed`.
    """

    def __init__(self, address: str, connect_limit_s: float = CONNECT_LIMIT_S) -> None:
        if not ADDRESS.fullmatch(address):
            raise ValueError(f"{address!r} is no address of a Dask scheduler; expected such as tcp://127.0.0.1:8786")
        if importlib.util.find_spec("distributed") is None:
            raise ValueError("a Dask cluster needs the package distributed: install it with pip install 'vssea[dask]'")
        self._address, self._connect_limit_s = address, connect_limit_s
        self._client: Any = None
        self._connecting = asyncio.Lock()

    @property
    def name(self) -> str:
        """Where it computes, in words."""
        threads = self._threads
        return f"Dask at {self._address}" + (f", {threads} thread{'' if threads == 1 else 's'}" if threads else "")

    @property
    def threads(self) -> int:
        """How many parts are computed at the same time, 1 while the cluster has no worker."""
        return max(1, self._threads)

    @property
    def at_a_time(self) -> int:
        """How many parts may be given out now; one, which waits, while the cluster has no worker."""
        return max(1, AHEAD * self._threads)

    @property
    def waiting_for(self) -> str:
        """What has to be there first: the scheduler and a worker."""
        if self._client is None or self._client.status != "running":
            return f"an answer of the scheduler at {self._address}"
        return "" if self._threads else f"a worker: the cluster of {self._address} has none"

    async def connect(self) -> None:
        """Connect now, so that `threads` is known. Raises OutOfReach if no scheduler answers."""
        await self._connected()

    async def run(self, part: PartTask) -> PartFiles:
        """Return a computed part. Raises OutOfReach if no scheduler answers, PartFailed, WorkerLost."""
        from distributed import KilledWorker
        from distributed.client import FutureCancelledError
        from distributed.comm.core import CommClosedError

        client = await self._connected()
        future = client.submit(compute, part, key=f"vssea-part-{part.number}-{uuid4().hex}", pure=False)
        try:
            files: PartFiles | None = await future
        except asyncio.CancelledError:
            await client.cancel([future], force=True)
            raise
        except KilledWorker as killed:
            raise PartFailed(
                f"part {part.number} ended every worker that tried it; is there enough memory?"
            ) from killed
        except (FutureCancelledError, CommClosedError) as lost:
            if self._client is client:  # else another part has connected anew
                await self.end()
            raise WorkerLost(f"the scheduler at {self._address} is gone") from lost
        except PartFailed:
            raise
        except ModuleNotFoundError as missing:
            raise PartFailed(
                f"a worker of {self._address} lacks a package: {missing}; install vssea there"
            ) from missing
        except Exception as failure:
            raise PartFailed(f"part {part.number} failed on a worker of {self._address}: {failure}") from failure
        finally:
            future.release()
        if files is None:
            raise WorkerLost(f"a worker gave up part {part.number}")
        return files

    def process_ids(self) -> list[int]:
        """Return the numbers of its processes that this engine has started: none."""
        return []

    async def end(self) -> None:
        """Leave the cluster, which goes on for others."""
        client, self._client = self._client, None
        if client is not None:
            await client.close()

    @property
    def _threads(self) -> int:
        if self._client is None:
            return 0
        return int(self._client.scheduler_info().get("total_threads", 0))

    async def _connected(self) -> Any:
        from distributed import Client

        # What it logs of a scheduler that is away are tracebacks; WorkerLost and OutOfReach say it in a sentence.
        logging.getLogger("distributed.client").setLevel(logging.CRITICAL)
        async with self._connecting:
            if self._client is None or self._client.status != "running":
                await self.end()
                client = Client(
                    self._address, asynchronous=True, timeout=self._connect_limit_s, set_as_default=False, name="vssea"
                )
                try:
                    self._client = await client
                except (OSError, TimeoutError) as error:
                    await client.close()
                    raise OutOfReach(
                        f"no Dask scheduler answers at {self._address}; start one with `dask scheduler`, "
                        "or give the address of one that runs"
                    ) from error
            return self._client
