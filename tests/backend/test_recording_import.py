"""A rig's own log becomes a recording: units turned into ours, what is wrong named by line and column."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from backend.recordings.csv_import import csv_import, csv_preview
from backend.recordings.csv_units import UNITS, guessed, plain_unit
from backend.recordings.exports import export
from backend.recordings.layout import FIELDS
from backend.recordings.reader import Recording
from tests.backend.run_recorded import recorded
from vssea_core.channels import CHANNELS
from vssea_core.scenarios import NOMINAL

HEAD = {"id": "x", "begun_at": "2026-01-01T12:00:00.000Z"}


def imported(tmp_path: Path, text: str | bytes, **asked: Any) -> Recording:
    log = tmp_path / "log.csv"
    log.write_bytes(text if isinstance(text, bytes) else text.encode())
    return Recording(csv_import(log, tmp_path / "x.mcap", HEAD, **asked))


def test_our_own_export_comes_back_to_the_bit(tmp_path: Path) -> None:
    run = recorded(tmp_path / "run.mcap", NOMINAL, 2500)
    _, path = export(run, "csv", None, -np.inf, np.inf, str(tmp_path))
    back = Recording(csv_import(Path(path), tmp_path / "back.mcap", HEAD))
    names = [field.name for field in FIELDS]
    assert np.array_equal(back.read(names).rows, run.read(names).rows)
    assert back.head["origin"] == "import"
    assert float(back.head["sample_time_s"]) == pytest.approx(1e-3)
    assert back.is_finished


@pytest.mark.parametrize("delimiter", [",", ";", "\t", "|", " "])
def test_any_delimiter_is_found(tmp_path: Path, delimiter: str) -> None:
    text = "\n".join(
        delimiter.join(cells) for cells in (("t", "link_position", "foo"), ("0", "1", "2"), ("0.5", "-1e-3", "3"))
    )
    assert imported(tmp_path, text + "\n").read(["time", "link_position"]).rows.tolist() == [[0.0, 1.0], [0.5, -1e-3]]


def test_units_are_turned_into_ours_and_the_error_is_made(tmp_path: Path) -> None:
    text = "time [ms];theta_l (deg);reference [mrad];motor_torque [mN·m];motor velocity [rpm]\n0;90;100;1500;60\n2;-45;;2;1\n"
    rows = (
        imported(tmp_path, text)
        .read(["time", "link_position", "reference", "motor_torque", "motor_velocity", "error"])
        .rows
    )
    expected = [
        [0.0, np.pi / 2, 0.1, 1.5, 2 * np.pi, 0.1 - np.pi / 2],
        [2e-3, -np.pi / 4, np.nan, 2e-3, np.pi / 30, np.nan],
    ]
    assert np.allclose(rows, expected, rtol=1e-15, equal_nan=True)


def test_a_decimal_comma_a_remark_and_a_byte_order_mark_are_read(tmp_path: Path) -> None:
    text = "\ufeff# measured on Monday\n\nt [s];q [deg]\n0,0;1,5\n0,1;-2,5\n"
    assert imported(tmp_path, text).read(["time", "link_position"]).rows == pytest.approx(
        np.array([[0.0, np.radians(1.5)], [0.1, np.radians(-2.5)]])
    )


def test_a_log_in_latin_letters_of_an_old_program_is_read(tmp_path: Path) -> None:
    assert imported(tmp_path, "t,q [°]\n0,180\n1,0\n".encode("latin-1")).read(["link_position"]).rows[0, 0] == np.pi


def test_channels_that_are_not_there_are_nothing(tmp_path: Path) -> None:
    rows = imported(tmp_path, "t,q\n0,1\n1,2\n").read([channel.name for channel in CHANNELS]).rows
    assert np.isnan(
        rows[:, [n for n, channel in enumerate(CHANNELS) if channel.name not in ("time", "link_position")]]
    ).all()


def test_a_mapping_names_what_headings_do_not(tmp_path: Path) -> None:
    columns = {
        "q1": {"channel": "link_position", "factor": 0.5, "offset": 1.0}, "i [A]": {"channel": "motor_torque", "factor": 2.0},
        "error": {"channel": None},
    }  # fmt: skip
    found = imported(tmp_path, "t,q1,i [A],error\n0,1,3,9\n1,2,4,9\n", mapping=columns)
    assert found.read(["link_position", "motor_torque"]).rows.tolist() == [[1.5, 6.0], [2.0, 8.0]]
    assert np.isnan(found.read(["error"]).rows).all()


def test_times_are_kept_as_they_are_and_the_usual_distance_is_the_period(tmp_path: Path) -> None:
    found = imported(tmp_path, "t,q\n0.5,1\n0.6,2\n0.7,2\n1.9,2\n")
    assert found.read(["time"]).rows[:, 0].tolist() == [0.5, 0.6, 0.7, 1.9]
    assert float(found.head["sample_time_s"]) == pytest.approx(0.1)


def test_a_sample_rate_stands_for_a_time_column(tmp_path: Path) -> None:
    assert imported(tmp_path, "q\n1\n2\n3\n", sample_rate_hz=500.0).read(["time"]).rows[:, 0].tolist() == [
        0.0,
        0.002,
        0.004,
    ]


def test_the_time_of_day_becomes_when_it_began(tmp_path: Path) -> None:
    found = imported(tmp_path, "timestamp [ms],q\n1767268800000,1\n1767268800250,2\n")
    assert found.read(["time"]).rows[:, 0].tolist() == [0.0, 0.25]
    assert found.head["begun_at"].startswith("2026-01-01T12:00:00.000")


def test_a_preview_says_what_would_be_read_and_writes_nothing(tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    log.write_text(
        "time [us];theta_l (deg);reference [mrad];foo\n0;1,5;100;x\n1000;2,5;1;y\n2000;2,5;1;y\n3000;2,5;1;y\n"
    )
    told = csv_preview(log)
    assert {name: told[name] for name in ("rows", "delimiter", "decimal", "derived", "ignored", "even")} == {
        "rows": 4, "delimiter": "semicolon", "decimal": "comma", "derived": ["error"], "ignored": ["foo"], "even": True,
    }  # fmt: skip
    assert [(column["heading"], column["channel"], column["unit"]) for column in told["columns"]] == [
        ("time [us]", "time", "us"), ("theta_l (deg)", "link_position", "deg"), ("reference [mrad]", "reference", "mrad"),
    ]  # fmt: skip
    assert told["period_s"] == pytest.approx(1e-3)
    assert list(tmp_path.iterdir()) == [log]


@pytest.mark.parametrize(
    ("text", "asked", "sentence"),
    [
        ("", {}, "the file has no rows; expected a line of headings"),
        ("t,q\n", {}, "the file has no rows"),
        ("0,1\n1,2\n", {}, "the first line, '0,1', is numbers; expected headings such as"),
        ("x,y\n0,1\n", {}, "none of the headings x, y is a channel"),
        ("t,q,q\n0,1,1\n", {}, "the heading 'q' stands twice"),
        ("t,q,theta_l\n0,1,1\n", {}, "the columns 'q' and 'theta_l' both are link_position"),
        ("t,q\n0,1\n1,abc\n", {}, "line 3, column 'q': 'abc' is not a number"),
        ("t,q\n0,1\n1,2\n1,3\n", {}, "line 4, column 't': the time 1 s is not after 1 s; expected times that rise"),
        ("t,q\n0,1\n,2\n", {}, "line 3, column 't': the time is missing"),
        ("t,q\n0,1\n1,2,3\n", {}, "line 3 has 3 cells and the headings are 2"),
        ("q,error\n0,1\n", {}, "no column is the time; expected a heading such as"),
        ("t,motor_torque [A]\n0,1\n", {}, "the unit of 'motor_torque \\[A\\]' is not one of Nm, mNm"),
        ("t,q\n0,1\n", {"mapping": {"z": {"channel": "error"}}}, "there is no column 'z'; the headings are t, q"),
        (
            "t,q\n0,1\n",
            {"mapping": {"q": {"channel": "zz"}}},
            "'q' is mapped to 'zz', which is no channel; known: time",
        ),
        (
            "t,q\n0,1\n",
            {"mapping": {"q": {"channel": "error", "gain": 1}}},
            "'q' has an unknown 'gain'; expected channel, factor",
        ),
        (
            "t,q\n0,1\n",
            {"mapping": {"q": {"channel": "error", "factor": "x"}}},
            "the factor of 'q' is 'x'; expected a number",
        ),
        (
            "t,q [A]\n0,1\n",
            {"mapping": {"q [A]": {"channel": "error"}}},
            "the unit of 'q \\[A\\]' is not one of rad, mrad",
        ),
        ("t,q\n0,1\n", {"sample_rate_hz": 0.0}, "the sample rate is 0 Hz; expected above 0"),
    ],
)
def test_what_is_wrong_is_told_in_a_sentence_and_nothing_is_kept(
    tmp_path: Path, text: str, asked: dict[str, Any], sentence: str
) -> None:
    with pytest.raises(ValueError, match=sentence):
        imported(tmp_path, text, **asked)
    with pytest.raises(ValueError, match=sentence):
        csv_preview(tmp_path / "log.csv", **asked)
    assert [path.name for path in tmp_path.iterdir()] == ["log.csv"]


@given(st.sampled_from(FIELDS), st.sampled_from(["[{}]", "({})", " [{}]", "  ( {} )"]))
def test_a_channels_own_heading_is_known_in_any_brackets(field: Any, brackets: str) -> None:
    assert guessed(field.name + brackets.format(field.unit)) == (field.name, field.unit, 1.0)


@given(st.sampled_from(CHANNELS), st.data())
def test_a_factor_turns_one_of_a_unit_into_ours(channel: Any, data: st.DataObject) -> None:
    unit = data.draw(st.sampled_from(sorted(UNITS[plain_unit(channel.unit)])))
    factor = guessed(f"{channel.name} [{unit}]").factor
    assert factor is not None
    assert factor > 0.0
