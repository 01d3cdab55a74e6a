"""A recording taken home is what was recorded: to the bit in Parquet, number by number in CSV."""

import csv
import json
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from backend.recordings import exports
from backend.recordings.exports import export
from backend.recordings.layout import FIELDS
from backend.recordings.reader import Recording
from backend.recordings.timeline import events, scenario_document
from tests.backend.run_recorded import noise_rows, recorded, with_gaps
from vssea_core.channels import CHANNELS
from vssea_core.scenarios import NOMINAL
from vssea_core.simulation.metrics import metrics

NAMES = [field.name for field in FIELDS]
CHANGES = [(300, "tuning", {"observer.bandwidth": 60.0})]
EVENTS = [
    {"at_s": 0.3, "kind": "tuning", "message": "g 100 → 60 rad/s", "severity": "info", "number": 4, "by": "page 1"}
]


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    return recorded(tmp_path_factory.mktemp("run") / "run.mcap", NOMINAL, 1000, CHANGES, EVENTS)


@pytest.fixture(autouse=True)
def small_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(exports, "ROWS_AT_ONCE", 300)


def everything(recording: Recording, channels: list[str] = NAMES) -> np.ndarray:
    return recording.read(channels).rows


def test_parquet_has_every_sample_to_the_bit_with_units_symbols_and_what_happened(
    run: Recording, tmp_path: Path
) -> None:
    media_type, path = export(run, "parquet", None, -np.inf, np.inf, str(tmp_path))
    assert media_type == "application/vnd.apache.parquet"
    table = pq.read_table(path)
    assert table.column_names == NAMES
    read = np.column_stack([column.to_numpy() for column in table.columns])
    assert read.tobytes() == np.ascontiguousarray(everything(run)).tobytes()
    field = table.schema.field("motor_torque")
    assert (field.metadata[b"unit"].decode(), field.metadata[b"symbol"].decode()) == ("N·m", "τ_e")
    about = {
        key.decode(): json.loads(value) for key, value in table.schema.metadata.items() if key.startswith(b"vssea.")
    }
    assert about["vssea.scenario"] == NOMINAL.model_dump(mode="json")
    assert [change["at_s"] for change in about["vssea.changes"]] == [0.3]
    assert about["vssea.events"][0]["text"] == "g 100 → 60 rad/s"
    assert pq.ParquetFile(path).num_row_groups > 1


def test_csv_has_units_in_its_headings_and_every_number(run: Recording, tmp_path: Path) -> None:
    _, path = export(run, "csv", None, -np.inf, np.inf, str(tmp_path))
    with Path(path).open(newline="", encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    assert head == [f"{field.name} [{field.unit}]" if field.unit else field.name for field in FIELDS]
    assert np.array_equal(np.array(rows, float), everything(run))


@pytest.mark.parametrize("form", ["csv", "parquet"])
def test_a_span_of_some_channels_comes_with_its_time(run: Recording, tmp_path: Path, form: str) -> None:
    _, path = export(run, form, ["error", "stiffness"], 0.1, 0.2, str(tmp_path))
    expected = run.read(["time", "error", "stiffness"], 0.1, 0.2).rows
    if form == "csv":
        read = np.loadtxt(path, delimiter=",", skiprows=1)
    else:
        read = np.column_stack([column.to_numpy() for column in pq.read_table(path).columns])
    assert len(read) == 101
    assert np.array_equal(read, expected)


def test_what_is_no_number_stays_so(tmp_path: Path) -> None:
    rows = noise_rows(10)
    rows[3, 2], rows[4, 2] = np.nan, np.inf
    found = with_gaps(tmp_path / "run.mcap", [(0, rows)])
    for form in ("csv", "parquet"):
        _, path = export(found, form, ["link_position"], -np.inf, np.inf, str(tmp_path))
        read = np.genfromtxt(path, delimiter=",", skip_header=1) if form == "csv" else np.column_stack(
            [column.to_numpy() for column in pq.read_table(path).columns]
        )  # fmt: skip
        assert np.array_equal(read[:, 1], rows[:, 2], equal_nan=True)


def test_json_tells_all_but_the_samples(run: Recording, tmp_path: Path) -> None:
    _, path = export(run, "json", None, -np.inf, np.inf, str(tmp_path))
    told = json.loads(Path(path).read_text("utf-8"))
    assert told["scenario"]["tuning"]["observer"]["bandwidth"] == 100.0
    assert told["final"]["tuning"]["observer"]["bandwidth"] == 60.0
    assert told["facts"]["samples"] == 1000
    assert set(told) == {"facts", "metrics", "scenario", "final", "changes", "events", "commands"}


def test_json_of_a_span_has_its_own_metrics(run: Recording, tmp_path: Path) -> None:
    _, path = export(run, "json", None, 0.2, 0.6, str(tmp_path))
    told = json.loads(Path(path).read_text("utf-8"))
    rows = run.read([channel.name for channel in CHANNELS], 0.2, 0.6).rows
    assert told["metrics"] == pytest.approx(metrics(rows), rel=1e-12)
    assert (told["facts"]["samples"], told["facts"]["to_s"]) == (len(rows), pytest.approx(0.6))


def test_an_excerpt_is_a_recording_of_the_span_and_what_happened_in_it(run: Recording, tmp_path: Path) -> None:
    _, path = export(run, "mcap", None, 0.25, 0.5, str(tmp_path))
    cut = Recording(Path(path))
    assert np.array_equal(everything(cut), run.read(NAMES, 0.25, 0.5).rows)
    assert cut.is_finished
    assert cut.head["first_sample"] == "250"
    assert scenario_document(cut) == scenario_document(run)
    assert scenario_document(cut, 0.5) == scenario_document(run, 0.5)
    assert [event["text"] for event in events(cut)] == ["g 100 → 60 rad/s"]
    _, path = export(run, "mcap", None, 0.4, 0.5, str(tmp_path))
    assert scenario_document(Recording(Path(path))) == scenario_document(run, 0.4)


def test_what_is_missing_is_missing_in_an_excerpt_too(tmp_path: Path) -> None:
    found = with_gaps(tmp_path / "run.mcap", [(0, noise_rows(50)), (80, noise_rows(50, 80))])
    _, path = export(found, "mcap", None, 0.02, 0.1, str(tmp_path))
    assert Recording(Path(path)).read(["time"]).gaps().tolist() == [30]


@pytest.mark.parametrize(
    ("asked", "sentence"),
    [
        (("xml", None, 0.0, 1.0), "form is 'xml'; expected one of csv, parquet, json, mcap"),
        (("mcap", ["error"], 0.0, 1.0), "a mcap export has all channels; expected none to be named"),
        (("mcap", None, 7.0, 8.0), "no samples from 7 to 8 s; this recording goes from 0 to 0.999 s"),
        (("csv", ["nothing"], 0.0, 1.0), "no channel 'nothing'; known: time"),
        (("parquet", None, 7.0, 8.0), "no samples from 7 to 8 s; this recording goes from 0 to 0.999 s"),
    ],
)
def test_what_cannot_be_exported_is_refused_and_leaves_no_file(
    run: Recording, tmp_path: Path, asked: tuple[str, list[str] | None, float, float], sentence: str
) -> None:
    with pytest.raises(ValueError, match=sentence):
        export(run, *asked, str(tmp_path))
    assert list(tmp_path.iterdir()) == []


def test_an_export_tells_how_far_it_is(run: Recording, tmp_path: Path) -> None:
    shares: list[float] = []
    export(run, "csv", None, -np.inf, np.inf, str(tmp_path), lambda share, words: shares.append(share))
    assert shares
    assert shares == sorted(shares)
