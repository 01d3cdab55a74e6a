"""A part of a batch as Parquet files, compressed with zstd; the engines' workers make them."""

import io
from collections import Counter

import pyarrow as pa
import pyarrow.parquet as pq

from backend.batch.engine import PartFiles
from vssea_core.batch.part import Column, Part

COMPRESSION = "zstd"


def part_files(part: Part) -> PartFiles:
    """Return a part as its files, with its runs counted by state."""
    trajectories = parquet(part.trajectories) if part.trajectories else b""
    return PartFiles(parquet(part.rows), trajectories, dict(Counter(part.rows["state"])))


def parquet(columns: dict[str, Column]) -> bytes:
    """Return a table as the bytes of a Parquet file."""
    file = io.BytesIO()
    pq.write_table(pa.table(dict(columns)), file, compression=COMPRESSION)
    return file.getvalue()
