"""The worked example of docs/batches.md, on a small version of it."""

import importlib.util
import io
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from vssea_core.scenarios import REALISTIC

DOCS = Path(__file__).parents[2] / "docs"
SCRIPT = DOCS / "examples" / "wrong_inertia.py"
STEPS = 8  # factors of 1.19
STEPS_OF_THE_PAGE = 120
TOLD = re.compile(r"^\| ([^|]+) \| ([\d.]+) mrad \| ([\d.]+) to ([\d.]+) \| ([\d.]+) to ([\d.]+) \|$", re.MULTILINE)


@pytest.fixture(scope="module")
def example() -> Iterator[ModuleType]:
    spec = importlib.util.spec_from_file_location("wrong_inertia", SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    yield module
    del sys.modules[spec.name]


def test_each_controller_stands_what_the_linear_analysis_foretells_to_a_step(example: ModuleType) -> None:
    results = example.found(example.batch(STEPS, 6.0))
    assert list(results) == list(example.CONTROLLERS)
    step = 4.0 ** (1.0 / STEPS)
    for name, each in results.items():
        (low, high), (below, above) = each.stood, each.linear
        assert 0.95 * below < low < step * 1.05 * below, name
        assert above / (1.05 * step) < high < 1.05 * above, name
        assert each.errors[len(each.errors) // 2] == each.at_one
        assert np.all(each.errors[each.factors > 1.1 * above] > example.WORSE * each.at_one), name
    table = example.words(results)
    assert all(f"| {name} | " in table for name in example.CONTROLLERS)
    image = io.BytesIO()
    example.drawn(results).savefig(image, dpi=50)
    assert image.getvalue().startswith(b"\x89PNG")


def test_the_table_of_the_page_is_what_the_script_finds(example: ModuleType) -> None:
    results = example.found(example.batch(STEPS_OF_THE_PAGE, REALISTIC.duration_s))
    rows = {name: [*map(float, figures)] for name, *figures in TOLD.findall((DOCS / "batches.md").read_text("utf-8"))}
    assert list(rows) == list(results)
    step = 4.0 ** (1.0 / STEPS_OF_THE_PAGE)
    for name, each in results.items():
        error, *borders = rows[name]
        assert abs(error - 1e3 * each.at_one) < 0.1, name
        for told, found in zip(borders, (*each.stood, *each.linear), strict=True):  # a step, and the digits of the page
            assert found / step - 0.005 <= told <= found * step + 0.005, name


def test_an_end_or_an_error_beyond_the_limit_bounds_what_is_stood(example: ModuleType) -> None:
    factors = np.array([0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0])
    errors = np.array([1.0, np.inf, 1.0, 4.9, 5.1, 1.0, 1.0])
    judged = example._judged(factors[:5], errors[:5], (0.6, 1.9))
    assert (judged.at_one, judged.stood) == (1.0, (1.0, 1.4))
