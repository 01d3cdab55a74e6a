"""How many runs make a part, by what a worker holds while it computes them."""

import numpy as np
import pytest

from backend.batch.part_files import parquet
from backend.batch.sizes import COLUMN_BYTES, HELD_BYTES, bytes_of, held_of, part_size, seconds_of
from vssea_core.batch.document import Keep
from vssea_core.channels import CHANNELS

ALL_CHANNELS = tuple(channel.name for channel in CHANNELS)


@pytest.mark.parametrize("samples", [100, 10_000, 200_000])
@pytest.mark.parametrize("every", [1, 10])
@pytest.mark.parametrize("trajectories", ["ended", "all"])
def test_a_part_fits_into_memory_even_if_every_run_ends_early(samples: int, every: int, trajectories: str) -> None:
    keep = Keep(trajectories=trajectories, channels=ALL_CHANNELS, every=every, precision="float64")  # type: ignore[arg-type]
    size, held = bytes_of(30, samples, keep), held_of(samples, keep)
    runs = part_size(1_000_000, seconds_of(samples, in_lanes=True, keep=keep), size, 2, held)
    assert runs == 1 or runs * held <= HELD_BYTES
    assert held == samples / every * (8 + 8 * len(CHANNELS))


def test_without_samples_nothing_is_held() -> None:
    assert held_of(10_000, Keep()) == 0.0
    assert part_size(1_000_000, 1e-3, 200.0, 2, 0.0) == part_size(1_000_000, 1e-3, 200.0, 2) == 1504


@pytest.mark.parametrize("runs", [1, 31, 1000])
def test_a_file_of_numbers_takes_about_what_is_told_however_few_they_are(runs: int) -> None:
    numbers = np.random.default_rng(0)
    columns = {f"metric {number}": numbers.normal(size=runs) for number in range(22)}
    told = runs * bytes_of(len(columns), 0, Keep()) + COLUMN_BYTES * len(columns)
    assert len(parquet(columns)) == pytest.approx(told, rel=0.25)
