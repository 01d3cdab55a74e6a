"""What the page says of the analysis is what the core has: the axes of maps, and from where on a margin is thin."""

import json
import math
import re
from pathlib import Path

from vssea_core.analysis import warning
from vssea_core.analysis.axes import AXES

APP = Path(__file__).parents[1] / "frontend_static" / "app"


def test_the_page_offers_the_axes_of_the_core() -> None:
    offered = json.loads((APP / "analyse" / "axes.json").read_text("utf-8"))
    fields = ("name", "label", "unit", "low", "high", "scale", "side")
    assert offered == [{field: getattr(axis, field) for field in fields} for axis in AXES.values()]


def test_the_page_calls_a_margin_thin_where_the_warning_does() -> None:
    text = (APP / "stability" / "thresholds.js").read_text("utf-8")
    said = {name: float(value) for name, value in re.findall(r"export const (\w+) = ([\d.]+);", text)}
    assert said == {
        "THIN_GAIN": warning.THIN_GAIN,
        "THIN_PHASE_DEG": round(math.degrees(warning.THIN_PHASE), 9),
        "THIN_DELAY_SAMPLES": warning.THIN_DELAY_SAMPLES,
        "THIN_PARAMETER": warning.THIN_PARAMETER,
    }
