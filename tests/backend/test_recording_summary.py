"""The summary of a recording: metrics block by block are those of all rows at once; the facts are what is in the file."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from backend.recordings.metrics_by_blocks import CHATTER, PEAKS, SATURATED, SATURATED_TIME, SQUARES, MetricsByBlocks
from backend.recordings.reader import Recording
from backend.recordings.summary import summary
from tests.backend.run_recorded import noise_rows, recorded, with_gaps
from vssea_core.channels import INDEX
from vssea_core.scenarios import NOMINAL, SCENARIOS
from vssea_core.simulation.metrics import METRICS, metrics
from vssea_core.simulation.run import simulate

ROWS = simulate(SCENARIOS["realistic"].model_copy(update={"duration_s": 4.0})).rows
SHORT = NOMINAL.model_copy(update={"duration_s": 1.0})


@given(st.lists(st.integers(1, 1500), max_size=12))
def test_metrics_by_blocks_are_those_of_the_whole(sizes: list[int]) -> None:
    blocks = MetricsByBlocks()
    for piece in np.split(ROWS, np.unique(np.minimum(np.cumsum(sizes), len(ROWS)))):
        blocks.take(piece)
    assert blocks.metrics() == pytest.approx(metrics(ROWS), rel=1e-13, abs=0.0)


def test_every_metric_has_its_rule() -> None:
    assert {metric.name for metric in METRICS} == PEAKS | SQUARES | {CHATTER, SATURATED, SATURATED_TIME}


def test_metrics_of_channels_that_were_not_recorded_are_not_told() -> None:
    rows = ROWS.copy()
    for name in ("link_disturbance", "limits"):
        rows[:, INDEX[name]] = np.nan
    blocks = MetricsByBlocks()
    blocks.take(rows)
    found = blocks.metrics()
    assert {name for name, value in found.items() if value is None} == {"observer_error", SATURATED, SATURATED_TIME}
    assert found["rms_error"] == metrics(ROWS)["rms_error"]


def test_facts_are_told(tmp_path: Path) -> None:
    events = [
        {"at_s": 0.2, "kind": "fault", "message": "Fault: x", "severity": "fault"},
        {"at_s": 0.3, "kind": "state"},
    ]
    found = summary(recorded(tmp_path / "run.mcap", SHORT, 1000, events=events), tmp_path / "cache")
    facts = found["facts"]
    assert facts["samples"] == 1000
    assert (facts["from_s"], facts["to_s"]) == (0.0, 0.999)
    assert facts["duration_s"] == 0.999
    assert facts["started_at"] == "2026-01-01T12:00:00.000Z"
    assert (facts["lost"], facts["events"], facts["faults"]) == (0, 2, 1)
    assert (facts["state"], facts["origin"], facts["scenario"]) == ("complete", "live", "nominal")
    assert facts["size"] == (tmp_path / "run.mcap").stat().st_size
    assert len(found["picture"]["time"]) == 120
    assert {len(column) for column in found["picture"].values()} == {120}
    assert found["metrics"] == pytest.approx(metrics(simulate(SHORT).rows), rel=1e-12)
    assert len(list((tmp_path / "cache").iterdir())) == 1


def test_missing_samples_are_counted_and_seen(tmp_path: Path) -> None:
    pieces = [(first, noise_rows(500, first)) for first in range(0, 20_000, 700)]
    found = summary(with_gaps(tmp_path / "run.mcap", pieces))
    assert found["facts"]["lost"] == 200 * (len(pieces) - 1)
    assert len(found["picture"]["time"]) <= 120
    assert None in found["picture"]["error"]


def test_a_damaged_chunk_is_told_and_the_rest_is_read(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    with_gaps(path, [(0, noise_rows(2000))])
    place = Recording(path)._blocks[3]
    with path.open("r+b") as file:
        file.seek(place.offset + place.length // 2)
        file.write(b"\xff" * 20)
    facts = summary(Recording(path))["facts"]
    assert facts["state"] == "damaged"
    assert facts["lost"] == 250


def test_nothing_was_recorded(tmp_path: Path) -> None:
    found = summary(with_gaps(tmp_path / "run.mcap", []))
    assert (found["metrics"], found["picture"], found["facts"]["samples"]) == ({}, None, 0)
