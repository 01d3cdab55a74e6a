"""Batches over a real server: asked for, computed, read, and equal to single runs to the bit."""

import io
import struct
from collections.abc import Iterator
from typing import Any

import httpx
import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.ipc
import pyarrow.parquet as pq
import pytest

from tests.backend.batch_documents import BATCHES, ENDED, PATIENCE_S, batch, created, done, ended, grid, one
from tests.backend.frame_decoder import decoded
from tests.backend.live_page import LivePage
from tests.backend.server import Server, until
from tests.backend.test_api_errors import problem_of
from vssea_core.batch.document import Batch
from vssea_core.batch.part import columns_of
from vssea_core.batch.plan import BatchPlan
from vssea_core.scenario import Scenario
from vssea_core.simulation.metrics import metrics
from vssea_core.simulation.run import simulate

INERTIA = "actuator.link.inertia"
SWEEP = batch(
    grid(INERTIA, 0.5, 2.0, 10, factor=True),
    {"kind": "list", "path": "tuning.observer.bandwidth", "values": [40.0, 80.0, 160.0]},
    name="sweep",
    description="heavier links",
)


@pytest.fixture
def http_batches(session: httpx.Client) -> Iterator[httpx.Client]:
    """The client; afterwards no batch is left."""
    yield session
    for each in session.get(BATCHES, params={"limit": 500}).json()["batches"]:
        session.post(f"{BATCHES}/{each['id']}/cancel").raise_for_status()
        session.delete(f"{BATCHES}/{each['id']}").raise_for_status()
    assert session.get(BATCHES).json()["total"] == 0


@pytest.fixture(scope="module")
def sweep(server: Server) -> Iterator[tuple[httpx.Client, dict[str, Any]]]:
    """A client, and the document of a batch of 30 runs that is done."""
    with httpx.Client(base_url=server.url, timeout=60.0, trust_env=False) as http:
        yield http, done(http, SWEEP)
