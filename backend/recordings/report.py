"""The report of a recording: one HTML page that needs no other file and no network. No script."""

import importlib.resources
import json
import tempfile
from collections.abc import Iterable, Sequence
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from backend.recordings.overview import overview
from backend.recordings.reader import Recording
from backend.recordings.report_figure import CHANNELS, POINTS, recording_figure
from backend.recordings.samples import drawn
from backend.recordings.summary import summary
from backend.recordings.timeline import commands, events, name_of, scenario_document, tunings
from backend.reports.inline import inline_svg
from vssea_core import __version__
from vssea_core.simulation.metrics import METRICS

MOST_ROWS = 500
CAPTION = (
    "Link and reference, tracking error, applied motor torque with its limits, disturbances (true signals wide and pale, "
    "estimates thin), and stiffness. Dotted: changes, numbered as in the table. Red: stops and faults; a red line on top of "
    "the torque: a limit was active."
)
ORIGINS = {"live": "live session", "import": "imported", "simulation": "simulation"}
Document = dict[str, Any]


def report(recording: Recording, folder: Path, cache: Path | None = None) -> str:
    """Write the report into a new file in `folder`; return its path."""
    with tempfile.NamedTemporaryFile("w", encoding="utf-8", dir=folder, suffix=".html", delete=False) as file:
        file.write(report_page(recording, cache))
    return file.name


def report_page(recording: Recording, cache: Path | None = None) -> str:
    """Return the page; it follows the reader's light or dark setting, and its figure is on white paper in both."""
    found = summary(recording, cache)
    changes, told = tunings(recording), events(recording)
    colours = (Path(str(importlib.resources.files("frontend_static"))) / "style" / "colours.css").read_text("utf-8")
    layout = (importlib.resources.files("backend.reports") / "report.css").read_text("utf-8")
    title = escape(name_of(recording))
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>VSSEA · {title}</title>
<style>
{colours}
{layout}
td.words {{ width: 60%; }}
details pre {{ font-size: 11px; white-space: pre-wrap; overflow-wrap: anywhere; }}
</style>
</head>
<body>
<main>
<h1>{title}</h1>
{_facts(found["facts"])}
<h2>Course</h2>
{_figure(recording, cache, changes, told)}
<h2>Metrics</h2>
{_metrics(found["metrics"])}
<h2>Tunings and other changes</h2>
{_changes(changes)}
<h2>Commands</h2>
{_commands(commands(recording))}
<h2>Events</h2>
{_events(told)}
<h2>Scenario at the begin</h2>
{_scenario(scenario_document(recording))}
<p class="note">Made by vssea {escape(__version__)}.</p>
</main>
</body>
</html>
"""


def _facts(facts: Document) -> str:
    lost = f"{facts['lost']} lost" if facts["lost"] else "none lost"
    rows: list[tuple[str, str]] = [
        ("scenario", facts["scenario"] or "not known"), ("started", facts["started_at"] or "not known"),
        ("from – to", f"{facts['from_s']:.3f} – {facts['to_s']:.3f} s ({facts['duration_s']:.3f} s)"),
        ("samples", f"{facts['samples']}, {lost}, every {1e3 * facts['sample_time_s']:g} ms"),
        ("state", facts["state"] + (f": {facts['ending']}" if facts["ending"] else "")),
        ("origin", str(ORIGINS.get(facts["origin"], facts["origin"])) + (f" of {facts['of']}" if facts["of"] else "")),
        ("size", f"{facts['size'] / 1e6:.2f} MB"), ("events", f"{facts['events']}, of them {facts['faults']} faults"),
        ("id", facts["id"]),
    ]  # fmt: skip
    return _table((), ((name, value) for name, value in rows))


def _figure(recording: Recording, cache: Path | None, changes: list[Document], told: list[Document]) -> str:
    blocks = None if cache is None else lambda: overview(recording, cache)
    shown = drawn(recording, CHANNELS, -np.inf, np.inf, POINTS, blocks)
    if not len(shown.time):
        return "<p>No samples were recorded.</p>"
    svg = recording_figure(shown, changes, told)
    return (
        f'<figure><div class="paper">{inline_svg(svg, "course", CAPTION)}</div>'
        f"<figcaption>{escape(CAPTION)}</figcaption></figure>"
    )


def _metrics(found: dict[str, float | None]) -> str:
    if not found:
        return "<p>No samples were recorded.</p>"
    rows = []
    for metric in METRICS:
        value = found.get(metric.name)
        shown = "not recorded" if value is None else f"{value:.4g} {metric.unit}"
        rows.append((metric.label, shown, metric.description))
    return _table(("metric", "value", "meaning"), rows)


def _changes(changes: list[Document]) -> str:
    rows = (
        (str(number), f"{change['at_s']:.3f} s", str(change["by"]), str(change["part"]).replace("_", " "),
         str(change["tuning_id"]), ", ".join(change["words"] or []))
        for number, change in enumerate(changes, 1)
    )  # fmt: skip
    return _table(("no.", "at", "by", "part", "tuning", "what"), rows, len(changes))


def _commands(told: list[Document]) -> str:
    rows = (
        (f"{each['at_s']:.3f} s", str(each.get("by", "")), str(each.get("command", "")), _short(each.get("arguments")),
         "done" if each.get("ok") else f"refused: {_problem(each.get('problem'))}")
        for each in told
    )  # fmt: skip
    return _table(("at", "by", "command", "arguments", "outcome"), rows, len(told))


def _events(told: list[Document]) -> str:
    rows = ((f"{each['time_s']:.3f} s", each["kind"], each["by"], each["text"]) for each in told)
    return _table(("at", "kind", "by", "what"), rows, len(told))


def _scenario(document: Document | None) -> str:
    if document is None:
        return "<p>Not known.</p>"
    text = escape(json.dumps(document, indent=1, ensure_ascii=False))
    return f"<details><summary>as JSON</summary><pre>{text}</pre></details>"


def _table(heads: Sequence[str], rows: Iterable[Sequence[str]], count: int = 1) -> str:
    if count == 0:
        return "<p>None.</p>"
    lines = []
    for number, row in enumerate(rows):
        if number == MOST_ROWS:
            lines.append(f'<tr><td colspan="{len(row)}">… and {count - MOST_ROWS} more, in the JSON export</td></tr>')
            break
        first, *others = (escape(cell) for cell in row)
        lines.append(
            f'<tr class="first"><th scope="row">{first}</th>' + "".join(f"<td>{x}</td>" for x in others) + "</tr>"
        )
    head = "".join(f'<th scope="col">{escape(name)}</th>' for name in heads)
    thead = f"<thead><tr>{head}</tr></thead>" if heads else ""
    return f'<div class="wide"><table>{thead}<tbody>{"".join(lines)}</tbody></table></div>'


def _short(value: Any) -> str:
    text = "" if value in (None, {}) else json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 200 else text[:197] + "..."


def _problem(problem: Any) -> str:
    return str(problem.get("detail", problem)) if isinstance(problem, dict) else str(problem or "")
