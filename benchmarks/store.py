"""1,000 edits of one document by two programs at once, and listing and searching 1,000 presets, on SQLite and PostgreSQL."""

import subprocess
import sys
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path

from rich.console import Console
from rich.table import Table

from backend.presets.contents import PRESET, live_preset
from backend.presets.documents import Documents
from backend.store import versioned
from backend.store.database import Database
from benchmarks.timing import timed
from tests.backend.counting import NAME, draft, numbers
from tests.postgres import PostgresServer, find_postgres
from vssea_core.scenarios import SCENARIOS

CLIENTS, EACH, PRESETS, REPEATS = 2, 500, 1000, 10


def edits(database: Database, url: str) -> tuple[float, int, int]:
    """Return the edits per second, how many were refused and tried again, and how many were lost."""
    with database.begin() as connection:
        versioned.put(connection, "preset", NAME, draft(0), None)
    command = [sys.executable, "-m", "tests.backend.counting", url, str(EACH)]
    begun = time.perf_counter()
    clients = [subprocess.Popen(command, stdout=subprocess.PIPE, text=True) for _ in range(CLIENTS)]
    refused = sum(int(client.communicate()[0]) for client in clients)
    seconds = time.perf_counter() - begun
    return CLIENTS * EACH / seconds, refused, CLIENTS * EACH - numbers(database)[-1]


def lists(database: Database) -> tuple[float, float]:
    """Return the median time [s] of a list of 1,000 presets, and of a search in it."""
    presets = Documents(database, PRESET)
    contents = [live_preset(scenario, 0.0, "benchmark") for scenario in SCENARIOS.values()]
    drafts = [presets.draft(content, "benchmark", "a note", ("one", "two")) for content in contents]
    with database.begin() as connection:
        for number in range(PRESETS):
            versioned.put(connection, "preset", f"preset {number}", drafts[number % len(drafts)], None)
    return timed(presets.list, REPEATS)[1], timed(lambda: presets.list("position two"), REPEATS)[1]


def main() -> None:
    """Print a line for each sort of database."""
    programs = find_postgres()
    table = Table("database", "edits/s", "refused, tried again", "lost", f"list of {PRESETS}", "search in them")
    with ExitStack() as stack:
        folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="vssea-store-"))
        urls = {"SQLite": f"sqlite:///{Path(folder, 'vssea.sqlite')}"}
        if programs is not None:
            server = PostgresServer(programs)
            stack.callback(server.stop)
            urls["PostgreSQL, no fsync"] = server.new_database("benchmark")
        for name, url in urls.items():
            database = Database(url)
            stack.callback(database.close)
            rate, refused, lost = edits(database, url)
            listed, searched = lists(database)
            table.add_row(
                name, f"{rate:.0f}", str(refused), str(lost), f"{1e3 * listed:.1f} ms", f"{1e3 * searched:.1f} ms"
            )
    Console(width=120).print(table)
