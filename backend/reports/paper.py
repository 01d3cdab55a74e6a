"""The whole report: simulate, judge, draw, write."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from backend.reports.claims_table import SCHEMA_VERSION, claim_document, markdown
from backend.reports.figures import DRAWINGS, drawn
from backend.reports.report_page import report_page
from vssea_core import __version__
from vssea_core.paper.claim import judge, run_all
from vssea_core.paper.claims import CLAIMS, STATEMENT
from vssea_core.paper.scenarios import paper_scenarios

SOFTWARE = f"vssea {__version__}"
_SIMULATED = 0.4
"""Share of the work that is done when all runs are."""


def paper_report(folder: str, progress: Callable[[float, str], object]) -> dict[str, Any]:
    """Write the report into `folder` (made if it is missing) and return what claims.json holds.

    Files: index.html, claims.json, claims.md, fig2 to fig4 as .svg and .png, scenarios/NAME.json. `progress` hears the share
    done [0, 1] and words before each step; what it raises ends the report. Raises OSError if a file cannot be written.
    """
    to, scenarios = Path(folder), paper_scenarios()
    (to / "scenarios").mkdir(parents=True, exist_ok=True)
    for name, scenario in scenarios.items():
        (to / "scenarios" / f"{name}.json").write_text(scenario.model_dump_json(indent=1), "utf-8")
    runs = run_all(scenarios, lambda share, name: progress(_SIMULATED * share, f"simulating {name}"))
    verdicts = judge(CLAIMS, runs)

    svgs = {}
    for index, drawing in enumerate(DRAWINGS):
        progress(_SIMULATED + (1.0 - _SIMULATED) * index / len(DRAWINGS), f"drawing {drawing.name}")
        svgs[drawing.name], png = drawn(drawing, runs)
        for file, content in zip(drawing.files, (svgs[drawing.name], png), strict=True):
            (to / file).write_bytes(content)

    document = {
        "schema": SCHEMA_VERSION,
        "software": SOFTWARE,
        "statement": STATEMENT,
        "passed": all(verdict.passed for verdict in verdicts),
        "claims": [claim_document(verdict) for verdict in verdicts],
        "figures": [{"name": d.name, "files": list(d.files), "caption": d.caption} for d in DRAWINGS],
    }
    text = json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False)
    (to / "claims.json").write_text(text + "\n", "utf-8")
    (to / "claims.md").write_text(markdown(verdicts), "utf-8")
    (to / "index.html").write_text(report_page(verdicts, svgs, SOFTWARE), "utf-8")
    progress(1.0, "done")
    return document
