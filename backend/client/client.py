"""A server as a Python object."""

import os
from typing import Any

import pyarrow as pa
import pyarrow.csv

from backend.client.batches import Batches
from backend.client.connection import Connection
from backend.client.document import document_of
from backend.client.problem import VsseaError

Document = dict[str, Any]


class VsseaClient:
    """A running `vssea serve`; `token` is the server's VSSEA_TOKEN, by default that of this environment.

    Each call raises VsseaError with one sentence: what was wrong, what was expected, what to do.
    """

    def __init__(
        self, address: str = "http://127.0.0.1:8000", token: str | None = None, timeout_s: float = 60.0
    ) -> None:
        self._connection = Connection(address, token or os.environ.get("VSSEA_TOKEN"), timeout_s)
        self.batches = Batches(self._connection, self.simulate)

    def health(self) -> Document:
        """Return whether the server runs, and its version."""
        found: Document = self._connection.json("GET", "/api/health")
        return found

    def scenario(self, name: str) -> Document:
        """Return a ready scenario: nominal, realistic or paper_fig2."""
        found: Document = self._connection.json("GET", f"/api/scenarios/{name}")
        return found

    def simulate(self, scenario: Any, every: int = 1, allow_unstable: bool = False) -> pa.Table:
        """Return the trajectory of a scenario: a row for every `every`-th sample, a float64 column for each channel."""
        query = {"trajectory": "csv", "every": every, "allow_unstable": str(allow_unstable).lower()}
        with self._connection.opened("POST", "/api/simulate", document_of(scenario), query) as answer:
            content = answer.read()
        try:
            table = pa.csv.read_csv(pa.BufferReader(content), convert_options=pa.csv.ConvertOptions(null_values=[]))
            table = table.cast(pa.schema([(heading, pa.float64()) for heading in table.column_names]))
        except pa.ArrowException as error:
            raise VsseaError(f"the answer to POST /api/simulate cannot be read: {error}") from error
        # Headings are such as "link_position [rad]".
        return table.rename_columns([heading.partition(" ")[0] for heading in table.column_names])

    def metrics(self, scenario: Any, allow_unstable: bool = False) -> Document:
        """Return metrics and limits of a scenario's run."""
        query = {"trajectory": "none", "allow_unstable": str(allow_unstable).lower()}
        found: Document = self._connection.json("POST", "/api/simulate", document_of(scenario), query)
        return found
