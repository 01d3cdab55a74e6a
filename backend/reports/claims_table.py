"""Verdicts as a document and as a table in Markdown."""

import math
from collections.abc import Sequence
from typing import Any

from vssea_core.paper.claim import Number, Verdict

SCHEMA_VERSION = 1


def claim_document(verdict: Verdict) -> dict[str, Any]:
    """Return a verdict as JSON values; a number that could not be measured is null."""
    claim = verdict.claim
    return {
        "number": claim.number,
        "name": claim.name,
        "source": claim.source,
        "sentence": claim.sentence,
        "measured": claim.measured,
        "numbers": [_number_document(number) for number in verdict.numbers],
        "passed": verdict.passed,
        "ending": verdict.ending,
        "note": claim.note,
        "scenarios": list(claim.scenarios),
    }


def _number_document(number: Number) -> dict[str, Any]:
    return {
        "label": number.label,
        "value": number.value if math.isfinite(number.value) else None,
        "unit": number.unit,
        "criterion": None if number.relation is None else {"relation": number.relation, "limit": number.limit},
        "met": number.met,
    }


def result_words(verdict: Verdict) -> str:
    """Return `passed` or `failed`."""
    return "passed" if verdict.passed else "failed"


def number_words(number: Number) -> str:
    """Return one number with its label and criterion, such as `rise time: 0.61 s (at most 1 s)`."""
    return f"{number.label}: {number.text}" + (f" ({number.criterion})" if number.criterion else "")


def markdown(verdicts: Sequence[Verdict]) -> str:
    """Return the table of claims in Markdown; criteria in brackets."""
    lines = ["| | claim | source | measured | result |", "|---|---|---|---|---|"]
    for verdict in verdicts:
        claim = verdict.claim
        numbers = "; ".join(map(number_words, verdict.numbers)) or str(verdict.ending)
        lines.append(f"| {claim.number} | {claim.sentence} | {claim.source} | {numbers} | {result_words(verdict)} |")
    return "\n".join(lines) + "\n"
