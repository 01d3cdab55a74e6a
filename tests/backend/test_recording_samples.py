"""What is drawn of a recording: nothing that stands out is left out, and what is missing is seen to be missing."""

import json
import struct
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from backend.recordings import overview as overviews
from backend.recordings.layout import FIELD_INDEX, FIELDS
from backend.recordings.overview import BLOCK, overview
from backend.recordings.reader import Recording
from backend.recordings.samples import drawn, samples_answer
from backend.recordings.thinning import extremes
from tests.backend.run_recorded import noise_rows, with_gaps

CHANNELS = ["link_position", "error", "limits"]
COLUMNS = [FIELD_INDEX[name] for name in CHANNELS]
values = hnp.arrays(
    np.float64, st.tuples(st.integers(1, 60), st.integers(1, 3)), elements=st.floats(width=32, allow_nan=True)
)


@given(values, st.integers(1, 20))
def test_each_run_keeps_its_least_and_its_greatest_value_in_their_order(rows: np.ndarray, runs: int) -> None:
    starts = np.unique(np.linspace(0, len(rows), runs + 1)[:-1].astype(np.intp))
    pairs = extremes(rows, starts).pairs()
    for number, run in enumerate(np.split(rows, starts[1:])):
        for column in range(rows.shape[1]):
            told, there = pairs[2 * number : 2 * number + 2, column], run[~np.isnan(run[:, column]), column]
            if not len(there):
                assert np.isnan(told).all()
                continue
            first_low, first_high = (
                int(np.flatnonzero(run[:, column] == edge)[0]) for edge in (there.min(), there.max())
            )
            in_order = (there.min(), there.max()) if first_low <= first_high else (there.max(), there.min())
            assert tuple(told) == in_order


@pytest.fixture(scope="module")
def long(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    rows = noise_rows(40_000)
    rows[12_345, 2], rows[31_111, 4], rows[100, 2] = 99.0, -77.0, np.nan
    return with_gaps(tmp_path_factory.mktemp("long") / "run.mcap", [(0, rows)])


@pytest.mark.parametrize(("from_s", "to_s"), [(-np.inf, np.inf), (0.0005, 39.5001), (1.0, 30.0)])
def test_the_overview_draws_what_the_samples_themselves_draw(
    long: Recording, tmp_path: Path, from_s: float, to_s: float
) -> None:
    runs = 20
    wide = drawn(long, CHANNELS, from_s, to_s, 2 * runs, lambda: overview(long, tmp_path))
    block = long.read(["time", *CHANNELS], from_s, to_s)
    starts = np.searchsorted(block.rows[:, 0], wide.time[0::2])
    direct = extremes(block.rows[:, 1:], starts)
    assert not wide.exact
    assert wide.of == len(block.rows)
    assert np.array_equal(wide.rows, direct.pairs().astype(np.float32), equal_nan=True)
    assert np.array_equal(wide.time[0::2], block.rows[starts, 0])


def test_extremes_of_an_hour_would_not_be_lost_either(long: Recording, tmp_path: Path) -> None:
    wide = drawn(long, CHANNELS, -np.inf, np.inf, 40, lambda: overview(long, tmp_path))
    assert np.nanmax(wide.rows[:, 0]) == 99.0
    assert np.nanmin(wide.rows[:, 1]) == -77.0


def test_a_short_span_is_every_sample_to_the_bit(long: Recording) -> None:
    shown = drawn(long, CHANNELS, 5.0, 5.1, 500)
    assert shown.exact
    assert shown.of == 101
    assert np.array_equal(shown.rows, noise_rows(40_000)[5000:5101][:, COLUMNS])


def test_missing_samples_are_a_row_of_nothing_at_the_last_time_before(tmp_path: Path) -> None:
    found = with_gaps(tmp_path / "run.mcap", [(0, noise_rows(50)), (80, noise_rows(50, 80))])
    shown = drawn(found, CHANNELS, -np.inf, np.inf, 500)
    assert len(shown.time) == 101
    assert np.isnan(shown.rows[50]).all()
    assert shown.time[50] == shown.time[49]
    assert not np.isnan(np.delete(shown.rows, 50, axis=0)).any()


@pytest.mark.parametrize("is_wide", [False, True], ids=["thinned", "from the overview"])
def test_no_run_of_a_thinned_drawing_goes_across_missing_samples(tmp_path: Path, is_wide: bool) -> None:
    pieces = [(0, noise_rows(30_000)), (70_000, noise_rows(30_000, 70_000))]
    found = with_gaps(tmp_path / "run.mcap", pieces)
    blocks = (lambda: overview(found, tmp_path)) if is_wide else None
    shown = drawn(found, CHANNELS, -np.inf, np.inf, 100, blocks)
    nothing = np.flatnonzero(np.isnan(shown.rows).all(axis=1))
    assert len(nothing) == 2
    assert nothing[1] == nothing[0] + 1
    assert nothing[0] % 2 == 0
    assert shown.time[nothing].tolist() == pytest.approx([29.999, 29.999])
    assert not np.any((shown.time > 29.9995) & (shown.time < 69.9995))
    for channel, column in enumerate(COLUMNS):
        every = np.concatenate([rows[:, column] for _, rows in pieces])
        assert np.nanmax(shown.rows[:, channel]) == pytest.approx(every.max(), rel=1e-6)


def test_the_overview_is_made_once_and_gone_on_with_as_the_recording_grows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from backend.recordings.recording_file import RecordingFile
    from tests.backend.run_recorded import HEAD, as_samples

    path, cache = tmp_path / "run.mcap", tmp_path / "cache"
    file = RecordingFile.create(path, HEAD | {"sample_time_s": "0.001"})
    rows = noise_rows(10_000)
    file.append_samples(as_samples(rows[:6000], 1e-3), 0)
    first = overview(Recording(path), cache)
    read: list[float] = []
    all_rows = overviews.all_rows
    monkeypatch.setattr(
        overviews, "all_rows", lambda recording, from_s=-np.inf: read.append(from_s) or all_rows(recording, from_s)
    )
    assert np.array_equal(overview(Recording(path), cache), first)
    assert read == []
    file.append_samples(as_samples(rows[6000:], 1e-3), 6000)
    grown = overview(Recording(path), cache)
    assert read[0] > 5.8
    file.finish(reason="done", lost="0")
    assert np.array_equal(grown, overview(Recording(path), tmp_path / "another"))
    assert len(list(cache.iterdir())) == 1
    assert grown["count"].sum() == 10_000
    assert grown["count"][:-1].tolist() == [BLOCK] * (len(grown) - 1)


def test_an_overview_of_what_grew_while_it_was_made_is_not_taken_for_one_of_all(tmp_path: Path) -> None:
    from backend.recordings.recording_file import RecordingFile
    from tests.backend.run_recorded import HEAD, as_samples

    path, cache = tmp_path / "run.mcap", tmp_path / "cache"
    file = RecordingFile.create(path, HEAD | {"sample_time_s": "0.001"})
    rows = noise_rows(10_000)
    file.append_samples(as_samples(rows[:6000], 1e-3), 0)
    opened = Recording(path)
    file.append_samples(as_samples(rows[6000:], 1e-3), 6000)
    file.close()
    assert overview(opened, cache)["count"].sum() == 6000
    assert overview(Recording(path), cache)["count"].sum() == 10_000


def test_a_cache_that_cannot_be_written_costs_nothing_but_time(long: Recording, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    assert overview(long, tmp_path / "file")["count"].sum() == 40_000


@settings(deadline=None, max_examples=20)
@given(st.integers(4, 3000), st.floats(-1.0, 45.0), st.floats(0.0, 45.0))
def test_the_answer_says_how_long_it_is_and_is_no_longer(
    long: Recording, points: int, from_s: float, length_s: float
) -> None:
    answer = samples_answer(long, CHANNELS, from_s, from_s + length_s, points)
    size = struct.unpack_from("<I", answer)[0]
    assert (4 + size) % 8 == 0
    head = json.loads(answer[4 : 4 + size])
    count = head["samples"]
    assert count <= points
    assert len(answer) == 4 + size + 8 * count + 4 * count * len(CHANNELS)
    time = np.frombuffer(answer, "<f8", count, 4 + size)
    assert (np.diff(time) >= 0.0).all()
    assert head["channels"] == CHANNELS
    assert head["period_s"] == 1e-3


def test_infinite_and_unnumbered_values_are_drawn(tmp_path: Path) -> None:
    rows = noise_rows(5000)
    rows[:, 2], rows[17, 4], rows[18, 4] = np.nan, np.inf, 1e300
    found = with_gaps(tmp_path / "run.mcap", [(0, rows)])
    answer = samples_answer(found, CHANNELS, points=8, cache=tmp_path)
    size = struct.unpack_from("<I", answer)[0]
    drawn_rows = np.frombuffer(answer, "<f4", offset=4 + size + 64).reshape(3, 8)
    assert np.isnan(drawn_rows[0]).all()
    assert np.isinf(drawn_rows[1].max())


def test_an_empty_recording_is_drawn_as_nothing(tmp_path: Path) -> None:
    found = with_gaps(tmp_path / "run.mcap", [])
    assert len(drawn(found, CHANNELS, -np.inf, np.inf, 100).time) == 0
    assert samples_answer(found, CHANNELS)


@pytest.mark.parametrize(
    ("asked", "sentence"),
    [
        ({"points": 3}, "points is 3; expected 4 to 20000"),
        ({"from_s": 2.0, "to_s": 1.0}, "begins at 2 s and ends at 1 s"),
        ({"channels": ["nothing"]}, "no channel 'nothing'; known: time, reference"),
    ],
)
def test_what_cannot_be_drawn_is_refused_in_a_sentence(
    long: Recording, asked: dict[str, object], sentence: str
) -> None:
    with pytest.raises(ValueError, match=sentence):
        samples_answer(long, **({"channels": CHANNELS} | asked))  # type: ignore[arg-type]


def test_every_field_has_its_place_in_the_overview(long: Recording, tmp_path: Path) -> None:
    blocks = overview(long, tmp_path)
    assert blocks["low"].shape[1] == len(FIELDS)
    assert set(blocks["low"][:, FIELD_INDEX["tick_lateness_us"]]) == {3.5}
