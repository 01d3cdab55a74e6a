"""docs/batches.md: its documents are batches that can run, and every field of a batch is told."""

import json
import re
from pathlib import Path

import pytest

from vssea_core.batch.document import Batch, Draw, Grid, Keep, Listed, LogUniform, Normal, Sample, Uniform, Zipped
from vssea_core.batch.plan import BatchPlan

PAGE = (Path(__file__).parents[2] / "docs" / "batches.md").read_text("utf-8")
DOCUMENTS = re.findall(r"^```json\n(.+?)^```", PAGE, re.MULTILINE | re.DOTALL)
RUNS = [31, 500, 6, 1024, 12]


@pytest.mark.parametrize(("text", "runs"), [*zip(DOCUMENTS, RUNS, strict=True)])
def test_each_document_is_a_batch_whose_runs_can_all_start(text: str, runs: int) -> None:
    plan = BatchPlan(Batch.model_validate(json.loads(text)))
    assert plan.count == runs
    assert [str(each) for each in plan.scenarios(0, runs) if isinstance(each, ValueError)] == []


@pytest.mark.parametrize("model", [Batch, Grid, Listed, Sample, Draw, Uniform, LogUniform, Normal, Zipped, Keep])
def test_every_field_of_a_batch_is_told(model: type) -> None:
    told = set(re.findall(r"`([^`]+)`", re.sub(r"^```.*?^```", "", PAGE, flags=re.MULTILINE | re.DOTALL)))
    for name, field in model.model_fields.items():
        assert (field.default if name == "kind" else name) in told


def test_the_words_of_the_example_tell_the_figures_of_its_table() -> None:
    rows = re.findall(r"^\| ([^|]+) \| [\d.]+ mrad \| ([\d.]+) to ([\d.]+) \|", PAGE, re.MULTILINE)
    stood = {name: (round(100 - 100 * float(low)), round(100 * float(high) - 100)) for name, low, high in rows}
    words = " ".join(PAGE.split())
    for name, text in (
        ("pole placement", "from {} % lighter to {} % heavier"),
        ("sliding mode with a layer", "{} % lighter to {} % heavier"),
        ("LQR on the error state", "{} % lighter but only {} % heavier"),
    ):
        assert text.format(*stood[name]) in words
    assert f"fails when the link is {stood['LQR on the plant'][1]} % heavier" in words
