"""The report of the paper: its files, its page, and what the command answers."""

import json
import re
import struct
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import pytest
from click.testing import Result
from typer.testing import CliRunner

import backend.reports.paper as report_of_paper
from backend.api.guard import CONTENT_SECURITY_POLICY
from backend.cli import app
from backend.compute.jobs import refuse_unstable
from backend.reports.claims_table import claim_document, markdown
from backend.reports.figures import DRAWINGS
from backend.reports.paper import paper_report
from backend.reports.report_page import report_page
from vssea_core import __version__
from vssea_core.paper.claim import Claim, Number, Runs, Verdict
from vssea_core.paper.claims import CLAIMS
from vssea_core.paper.scenarios import paper_scenarios
from vssea_core.scenario import Scenario

DOCS = Path(__file__).parents[2] / "docs" / "paper.md"
SVG = "{http://www.w3.org/2000/svg}"
TOLD: list[tuple[float, str]] = []


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("paper") / "not" / "there yet"
    TOLD.clear()
    paper_report(str(made), lambda share, words: TOLD.append((share, words)))
    return made


def vssea(*arguments: str) -> Result:
    return CliRunner().invoke(app, arguments)


def test_every_file_is_written(folder: Path) -> None:
    files = {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}
    figures = {f"fig{number}.{form}" for number in (2, 3, 4) for form in ("svg", "png")}
    scenarios = {f"scenarios/{name}.json" for name in paper_scenarios()}
    assert files == {"index.html", "claims.json", "claims.md"} | figures | scenarios


@pytest.mark.parametrize("name", [drawing.name for drawing in DRAWINGS])
def test_figures_are_as_wide_as_a_page_and_well_formed(folder: Path, name: str) -> None:
    root = ElementTree.parse(folder / f"{name}.svg").getroot()
    assert root.tag == f"{SVG}svg"
    assert float(root.attrib["width"].removesuffix("pt")) == pytest.approx(7.0 * 72.0)
    assert not root.findall(f".//{SVG}text"), "letters are paths, so no font is needed"
    assert len(root.findall(f".//{SVG}path")) > 100
    png = (folder / f"{name}.png").read_bytes()
    width, _ = struct.unpack(">II", png[16:24])
    assert (png[:4], width) == (b"\x89PNG", 7 * 300)


def test_the_document_holds_each_claim_with_its_numbers_and_says_whose_they_are(folder: Path) -> None:
    document = json.loads((folder / "claims.json").read_text("utf-8"))
    assert (document["schema"], document["software"], document["passed"]) == (1, f"vssea {__version__}", True)
    assert "The paper gives no numbers" in document["statement"]
    assert [claim["name"] for claim in document["claims"]] == [claim.name for claim in CLAIMS]
    for claim in document["claims"]:
        assert any(number["criterion"] for number in claim["numbers"])
        assert all((folder / "scenarios" / f"{name}.json").is_file() for name in claim["scenarios"])
    for figure in document["figures"]:
        assert "ours" in figure["caption"]
        assert all((folder / file).is_file() for file in figure["files"])


class Page(HTMLParser):
    """What a browser would fetch or run, the ids, and the text."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.fetched: list[str] = []
        self.ids: list[str] = []
        self.pointed_at: list[str] = []
        self.tags: list[str] = []
        self.words = ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        for name, value in attrs:
            if name == "id":
                self.ids.append(value or "")
            elif name in ("href", "xlink:href", "src"):
                (self.pointed_at if (value or "").startswith("#") else self.fetched).append((value or "").lstrip("#"))
            assert not name.startswith("on")

    def handle_data(self, data: str) -> None:
        self.words += data


def test_the_page_fetches_nothing_and_runs_nothing(folder: Path) -> None:
    text = (folder / "index.html").read_text("utf-8")
    page = Page(text)
    assert page.fetched == []
    assert not {"script", "link", "img", "iframe", "base"} & set(page.tags)
    assert "@import" not in text
    assert not re.findall(r"url\((?!#)", text)
    assert (
        "style-src 'self' 'unsafe-inline'" in CONTENT_SECURITY_POLICY
    )  # its one style element, and the figures' styles


def test_ids_of_the_figures_do_not_meet_on_the_page(folder: Path) -> None:
    page = Page((folder / "index.html").read_text("utf-8"))
    assert len(page.ids) == len(set(page.ids))
    assert page.pointed_at
    assert set(page.pointed_at) <= set(page.ids)
    clips = re.findall(r"url\(#([^)]+)\)", (folder / "index.html").read_text("utf-8"))
    assert set(clips) <= set(page.ids)


def test_the_page_shows_every_claim_and_figure(folder: Path) -> None:
    page = Page((folder / "index.html").read_text("utf-8"))
    assert page.tags.count("figure") == len(DRAWINGS)
    for words in (claim.sentence for claim in CLAIMS):
        assert words in page.words
    assert f"{len(CLAIMS)} of {len(CLAIMS)} claims passed" in page.words


@pytest.mark.parametrize("name", paper_scenarios())
def test_each_scenario_runs_with_the_command_that_the_page_names(folder: Path, name: str) -> None:
    refuse_unstable(Scenario.model_validate_json((folder / "scenarios" / f"{name}.json").read_text("utf-8")))


def test_progress_rises_from_0_to_1_with_words(folder: Path) -> None:
    shares = [share for share, _ in TOLD]
    assert shares == sorted(shares)
    assert (shares[0], shares[-1]) == (0.0, 1.0)
    assert len(TOLD) == len(paper_scenarios()) + len(DRAWINGS) + 1
    assert all(words for _, words in TOLD)


def test_what_the_progress_raises_ends_the_report(tmp_path: Path) -> None:
    class NoLongerWanted(BaseException):
        pass

    def cancel(share: float, words: str) -> None:
        if share > 0.2:
            raise NoLongerWanted

    with pytest.raises(NoLongerWanted):
        paper_report(str(tmp_path), cancel)
    assert not (tmp_path / "index.html").exists()


def failing(claim: Claim, number: Number) -> Claim:
    def measure(runs: Runs) -> tuple[Number, ...]:
        return (number,)

    return Claim(claim.number, claim.name, claim.source, claim.sentence, claim.measured, claim.scenarios, measure)


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the figures, which take most of the time."""
    monkeypatch.setattr(report_of_paper, "drawn", lambda drawing, runs: (b"<svg></svg>", b""))


@pytest.mark.usefixtures("undrawn")
def test_the_command_writes_the_report_and_answers_0(tmp_path: Path) -> None:
    outcome = vssea("paper", "-o", str(tmp_path / "report"))
    assert outcome.exit_code == 0, outcome.output
    assert outcome.stdout.count("passed") == len(CLAIMS)
    assert "The paper gives no numbers" in outcome.stdout
    assert (tmp_path / "report" / "index.html").is_file()


@pytest.mark.usefixtures("undrawn")
def test_the_command_answers_1_if_a_claim_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    broken = failing(CLAIMS[2], Number("rise time LQR / poles", 0.9, "", "at least", 1.1))
    monkeypatch.setattr(report_of_paper, "CLAIMS", (broken, *CLAIMS[3:4]))
    outcome = vssea("paper", "-o", str(tmp_path))
    assert outcome.exit_code == 1
    assert outcome.stdout.count("failed") == 1
    document = json.loads((tmp_path / "claims.json").read_text("utf-8"))
    assert [claim["passed"] for claim in document["claims"]] == [False, True]
    assert document["passed"] is False
    assert "1 of 2 claims passed" in (tmp_path / "index.html").read_text("utf-8")


def test_a_folder_that_cannot_be_used_is_told_in_one_sentence(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("something else")
    outcome = vssea("paper", "-o", str(tmp_path / "file"))
    assert (outcome.exit_code, outcome.stdout) == (2, "")
    assert outcome.stderr.splitlines()[-1].startswith(f"vssea: {tmp_path / 'file'} cannot be written")


def test_a_run_that_broke_off_is_shown_with_its_reason_and_an_unmeasured_number_as_null() -> None:
    ended = Verdict(CLAIMS[0], (), "fig2a_regulation stopped at t = 3.1 s: <deflection>")
    unmeasured = Verdict(CLAIMS[2], (Number("rise time", float("nan"), "s", "at most", 1.0),))
    assert claim_document(ended)["passed"] is False
    assert json.loads(json.dumps(claim_document(unmeasured), allow_nan=False))["numbers"][0]["value"] is None
    assert "stopped at t = 3.1 s" in markdown([ended])
    page = report_page([ended, unmeasured], {drawing.name: b"<svg></svg>" for drawing in DRAWINGS}, "vssea")
    assert "0 of 2 claims passed" in page
    assert "&lt;deflection&gt;" in page


NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?")


def test_the_table_in_the_docs_is_that_of_the_report(folder: Path) -> None:
    """The same words; numbers within a rounding, since another processor may turn a last digit."""
    text = DOCS.read_text("utf-8")
    written = text[text.index("| | claim") :].split("\n\n")[0].splitlines()
    measured = (folder / "claims.md").read_text("utf-8").splitlines()
    remedy = "run `vssea paper` and copy claims.md into docs/paper.md"
    assert [NUMBER.sub("#", line) for line in written] == [NUMBER.sub("#", line) for line in measured], remedy
    for shown, found in zip(written, measured, strict=True):
        values = [float(x) for x in NUMBER.findall(found)]
        assert [float(x) for x in NUMBER.findall(shown)] == pytest.approx(values, rel=0.011), remedy
