"""What is computed of a recording: spectra, references, differences, its report, and what the details tell."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from scipy import integrate

from backend.recordings import jobs
from backend.recordings.details import details, row_at
from backend.recordings.difference import difference
from backend.recordings.reader import Recording
from backend.recordings.recorded_reference import recorded_reference
from backend.recordings.report import report_page
from backend.recordings.spectrum import spectrum
from tests.backend.run_recorded import noise_rows, recorded, with_gaps
from vssea_core.channels import CHANNELS, INDEX
from vssea_core.scenarios import NOMINAL, REALISTIC
from vssea_core.signals.documents import RecordedReference

CHANGES = [(300, "tuning", {"observer.bandwidth": 60.0}), (700, "stiffness_reference", {"stiffness": 300.0})]
EVENTS = [
    {"at_s": 0.3, "kind": "tuning", "message": "g <100> → 60", "severity": "info", "number": 4, "by": "page 1", "epoch": 1,
     "wall_time": "2026-01-01T12:00:00.300Z"},
    {"at_s": 0.9, "kind": "fault", "message": "Fault: far away", "severity": "fault", "by": "session"},
]  # fmt: skip
COMMANDS = [{"at_s": 0.3, "wall_time": "", "epoch": 1, "by": "page 1", "command": "tune", "arguments": {"changes": {}}, "ok": True},
            {"at_s": 0.4, "wall_time": "", "epoch": 1, "by": "page 2", "command": "step", "arguments": {}, "ok": False,
             "problem": "Only a paused session can be stepped."}]  # fmt: skip


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    return recorded(tmp_path_factory.mktemp("run") / "run.mcap", NOMINAL, 1500, CHANGES, EVENTS, COMMANDS)


def test_the_integral_of_a_density_is_the_variance(tmp_path: Path) -> None:
    rows = noise_rows(200_000)
    rows[:, 4] = rows[:, 4] * 2.0 + 5.0 + 3.0 * np.sin(2 * np.pi * 40.0 * rows[:, 0])
    found = spectrum(with_gaps(tmp_path / "run.mcap", [(0, rows)]), ["error", "motor_torque"], -np.inf, np.inf)
    for name in ("error", "motor_torque"):
        variance = np.var(rows[:, INDEX[name]])
        power = integrate.trapezoid(found["density"][name], found["frequencies_hz"])
        assert power == pytest.approx(variance, rel=0.02)
        assert found["rms"][name] ** 2 == pytest.approx(variance, rel=1e-12)
    peak = found["frequencies_hz"][int(np.argmax(found["density"]["error"]))]
    assert peak == pytest.approx(40.0, abs=found["resolution_hz"])
    assert found["segment_samples"] == 65_536
    assert found["unit"] == {"error": "rad²/Hz", "motor_torque": "(N·m)²/Hz"}
    assert found["note"] is None


def test_a_spectrum_is_of_the_longest_piece_without_a_gap_and_says_so(tmp_path: Path) -> None:
    pieces = [(0, noise_rows(300)), (1000, noise_rows(4000, 1000)), (9000, noise_rows(500, 9000))]
    found = spectrum(with_gaps(tmp_path / "run.mcap", pieces), ["error"], -np.inf, np.inf)
    assert (found["from_s"], found["to_s"]) == (pytest.approx(1.0), pytest.approx(4.999))
    assert found["note"].endswith("longest piece without a gap, 1 to 4.999 s.")


def test_uneven_times_count_as_gaps(tmp_path: Path) -> None:
    rows = noise_rows(1000)
    rows[400:, 0] += 0.02
    found = spectrum(with_gaps(tmp_path / "run.mcap", [(0, rows)]), ["error"], -np.inf, np.inf)
    assert found["from_s"] == pytest.approx(0.42)


@pytest.mark.parametrize(
    ("channels", "to_s", "sentence"),
    [
        ([], 1.0, "0 channels are asked for; expected 1 to 8"),
        (["error"], 0.005, "the span has 6 samples at even times; expected at least 16"),
        (["nothing"], 1.0, "no channel 'nothing'"),
    ],
)
def test_a_spectrum_that_makes_no_sense_is_refused(
    run: Recording, channels: list[str], to_s: float, sentence: str
) -> None:
    with pytest.raises(ValueError, match=sentence):
        spectrum(run, channels, 0.0, to_s)


def test_a_spectrum_of_what_is_no_number_is_refused(tmp_path: Path) -> None:
    rows = noise_rows(100)
    rows[50, 4] = np.nan
    with pytest.raises(ValueError, match="error has values that are no numbers in this span"):
        spectrum(with_gaps(tmp_path / "run.mcap", [(0, rows)]), ["error"], 0.0, 1.0)


@pytest.mark.parametrize(("samples", "kept"), [(2, 2), (1500, 1500), (7001, 1751)])
def test_a_recorded_course_is_a_reference_of_evenly_spaced_samples(tmp_path: Path, samples: int, kept: int) -> None:
    rows = noise_rows(samples, 300)
    document = recorded_reference(with_gaps(tmp_path / "run.mcap", [(300, rows)]), "link_position", -np.inf, np.inf)
    reference = RecordedReference.model_validate(document)
    times, positions = np.array(reference.times_s), np.array(reference.positions)
    assert len(times) == kept
    assert times[0] == 0.0
    assert times[-1] == pytest.approx((samples - 1) * 1e-3)
    places = np.rint(times / 1e-3).astype(int)
    assert np.array_equal(positions, rows[places, 2])
    assert len(set(np.diff(places)[:-1])) <= 1


def test_a_course_at_uneven_or_fast_times_keeps_what_a_reference_allows(tmp_path: Path) -> None:
    rows = noise_rows(5000, period_s=1e-4)
    rows[:, 0] += 4e-5 * np.sin(np.arange(5000))
    document = recorded_reference(with_gaps(tmp_path / "run.mcap", [(0, rows)]), "link_position", -np.inf, np.inf)
    times = RecordedReference.model_validate(document).times_s
    assert times[-1] == pytest.approx(rows[-1, 0] - rows[0, 0], abs=1e-8)


@pytest.mark.parametrize(
    ("channel", "span", "sentence"),
    [
        (
            "motor_torque",
            (0.0, 1.0),
            "'motor_torque' cannot be a reference; expected a position, one of reference, link_position",
        ),
        ("nothing", (0.0, 1.0), "'nothing' cannot be a reference"),
        ("link_position", (9.0, 10.0), "link_position has 0 samples from 9 to 10 s; expected at least 2"),
    ],
)
def test_what_is_no_reference_is_refused(
    run: Recording, channel: str, span: tuple[float, float], sentence: str
) -> None:
    with pytest.raises(ValueError, match=sentence):
        recorded_reference(run, channel, *span)


def test_a_course_too_far_away_is_refused(tmp_path: Path) -> None:
    rows = noise_rows(10)
    rows[5, 2] = 101.0
    with pytest.raises(ValueError, match="link_position reaches 101 rad; a reference stays within ±100 rad"):
        recorded_reference(with_gaps(tmp_path / "run.mcap", [(0, rows)]), "link_position", 0.0, 1.0)


def test_differences_are_told_in_words(run: Recording, tmp_path: Path) -> None:
    live = NOMINAL.model_copy(update={"tuning": REALISTIC.tuning})
    at_begin = difference(run, 0.0, run)
    assert [(each["path"], each["words"]) for each in at_begin["changes"]] == [
        ("tuning.observer.bandwidth", "g 100 → 60 rad/s"), ("stiffness_reference.stiffness", "k 200 → 300 N·m/rad"),
    ]  # fmt: skip
    assert difference(run, None, run) == {"changes": [], "same": True}
    assert [each["path"] for each in difference(run, 0.29, NOMINAL)["changes"]] == []
    assert "tuning.observer.kind" in [each["path"] for each in difference(run, 0.0, live)["changes"]]
    with pytest.raises(ValueError, match="holds no scenario, as what it began with was not written"):
        difference(run, None, with_gaps(tmp_path / "run.mcap", []))


def test_the_details_are_what_happened(run: Recording) -> None:
    found = details(run)
    assert found["scenario"] == NOMINAL.model_dump(mode="json")
    assert found["final"]["stiffness_reference"]["stiffness"] == 300.0
    assert [(each["at_s"], each["part"], each["tuning_id"], each["by"]) for each in found["tunings"]] == [
        (0.3, "tuning", 8, "page 1"), (pytest.approx(0.7), "stiffness_reference", 8, "page 1"),
    ]  # fmt: skip
    assert found["events"][0] == {
        "number": 4, "wall_time": "2026-01-01T12:00:00.300Z", "epoch": 1, "time_s": 0.3, "kind": "tuning",
        "text": "g <100> → 60", "by": "page 1", "severity": "info",
    }  # fmt: skip
    assert [each["ok"] for each in found["commands"]] == [True, False]
    assert [channel["name"] for channel in found["channels"]][: len(CHANNELS)] == [channel.name for channel in CHANNELS]
    json.dumps(found, allow_nan=False)


def test_the_pose_of_a_time_is_that_of_the_nearest_sample(run: Recording, tmp_path: Path) -> None:
    names = [channel.name for channel in CHANNELS]
    rows = run.read(names).rows
    for time_s, place in ((0.5004, 500), (-3.0, 0), (99.0, 1499)):
        assert row_at(run, time_s) == rows[place].tolist()
    gap = with_gaps(tmp_path / "gap.mcap", [(0, noise_rows(10)), (5000, noise_rows(10, 5000))])
    assert row_at(gap, 2.0)[0] in (pytest.approx(0.009), 5.0)
    with pytest.raises(ValueError, match="the recording has no samples"):
        row_at(with_gaps(tmp_path / "empty.mcap", []), 0.0)


def test_the_report_is_one_page_that_needs_nothing_else(run: Recording, tmp_path: Path) -> None:
    page = report_page(run, tmp_path)
    assert not re.search(r"""(src|href)\s*=\s*["'](?!#)|<script|@import|url\((?!#)""", page)
    for words in (
        "peak error", "0.300 s", "g &lt;100&gt; → 60", "Fault: far away", "stiffness reference", "tune",
        "refused: Only a paused session can be stepped.", "2026-01-01T12:00:00.000Z", "1500, none lost",
    ):  # fmt: skip
        assert words in page
    assert page.count("<svg") == 1
    assert "@media print" in page
    assert "prefers-color-scheme" in page or "light-dark(" in page


def test_a_report_of_nothing_and_of_an_import_is_a_page_too(tmp_path: Path) -> None:
    assert "No samples were recorded." in report_page(with_gaps(tmp_path / "run.mcap", []))
    rows = noise_rows(100)
    rows[:, 5:] = np.nan
    page = report_page(with_gaps(tmp_path / "import.mcap", [(0, rows)]))
    assert "not recorded" in page
    assert "Not known." in page


def test_an_opened_recording_is_opened_anew_when_its_file_has_changed(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    with_gaps(path, [(0, noise_rows(10))])
    first = jobs.opened(str(path))
    assert jobs.opened(str(path)) is first
    path.unlink()
    with_gaps(path, [(0, noise_rows(20))])
    assert jobs.opened(str(path)).samples == 20


def test_a_recording_that_is_no_more_and_a_full_disk_are_told(tmp_path: Path) -> None:
    with pytest.raises(
        ValueError, match="the recording run cannot be read: No such file or directory; GET /api/recordings"
    ):
        jobs.pose_at(str(tmp_path / "run.mcap"), 0.0)
    with_gaps(tmp_path / "run.mcap", [(0, noise_rows(10))])
    nowhere = str(tmp_path / "nowhere")
    with pytest.raises(
        ValueError, match="it cannot be written: No such file or directory; make room on the disk and try again"
    ):
        jobs.report_of(str(tmp_path / "run.mcap"), nowhere, nowhere)
