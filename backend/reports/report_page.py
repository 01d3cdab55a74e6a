"""The report as one page that needs no other file: figures inline, claims with their numbers. No script."""

import importlib.resources
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path

from backend.reports.claims_table import result_words
from backend.reports.figures import DRAWINGS, Drawing
from backend.reports.inline import inline_svg
from vssea_core.paper.claim import Number, Verdict
from vssea_core.paper.claims import STATEMENT


def report_page(verdicts: Sequence[Verdict], svgs: Mapping[str, bytes], software: str) -> str:
    """Return the page; `svgs` holds each figure of DRAWINGS by name. It follows the reader's light or dark setting."""
    passed = sum(verdict.passed for verdict in verdicts)
    colours = (Path(str(importlib.resources.files("frontend_static"))) / "style" / "colours.css").read_text("utf-8")
    layout = (importlib.resources.files("backend.reports") / "report.css").read_text("utf-8")
    figures = "\n".join(_figure(drawing, svgs[drawing.name]) for drawing in DRAWINGS)
    rows = "\n".join(_row(verdict) for verdict in verdicts)
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>VSSEA · The paper, checked</title>
<style>
{colours}
{layout}
</style>
</head>
<body>
<main>
<h1>The paper, checked</h1>
<p>E. Sariyildiz, <cite>On the Robust Position Control of Variable Stiffness Series Elastic Actuators</cite>: Figs. 2 to 4, and each
sentence of its results as a claim that can fail.</p>
<p class="statement">{escape(STATEMENT)}</p>
<p><strong class="{"passed" if passed == len(verdicts) else "failed"}">{passed} of {len(verdicts)} claims passed.</strong>
The same numbers are in <code>claims.json</code>; each scenario is in <code>scenarios/</code> and runs with
<code>vssea simulate</code>. Made by {escape(software)}.</p>
<h2>Figures</h2>
{figures}
<h2>Claims</h2>
<div class="wide">
<table>
<thead><tr><th scope="col">No.</th><th scope="col">Claim</th><th scope="col" colspan="2">Measured</th><th scope="col">Criterion</th>
<th scope="col">Result</th></tr></thead>
<tbody>
{rows}
</tbody>
</table>
</div>
</main>
</body>
</html>
"""


def _row(verdict: Verdict) -> str:
    claim, words = verdict.claim, result_words(verdict)
    note = f'<p class="note">{escape(claim.note)}</p>' if claim.note else ""
    ending = f'<p class="failed">{escape(verdict.ending)}</p>' if verdict.ending else ""
    first, *others = verdict.numbers or (None,)
    height = max(1, len(verdict.numbers))
    head = (
        f'<tr class="first"><th scope="row" rowspan="{height}">{claim.number}</th>'
        f'<td rowspan="{height}" class="claim">{escape(claim.sentence)} <span class="source">{escape(claim.source)}</span>'
        f'<p class="how">{escape(claim.measured)}</p>{note}{ending}</td>'
    )
    result = f'<td rowspan="{height}" class="{words}">{words}</td>'
    return f"{head}{_cells(first)}{result}</tr>" + "".join(f"<tr>{_cells(number)}</tr>" for number in others)


def _cells(number: Number | None) -> str:
    if number is None:
        return "<td></td><td></td><td></td>"
    value = "value" if number.met else "value failed"
    return (
        f'<td>{escape(number.label)}</td><td class="{value}">{escape(number.text)}</td>'
        f'<td class="criterion">{escape(number.criterion)}</td>'
    )


def _figure(drawing: Drawing, svg: bytes) -> str:
    return (
        f'<figure id="{drawing.name}"><div class="paper">{inline_svg(svg, drawing.name, drawing.caption)}</div>'
        f"<figcaption>{escape(drawing.caption)}</figcaption></figure>"
    )
