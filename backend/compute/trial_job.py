"""A tuning beside the present one, both simulated: its figures, its new limits, and a sentence."""

import math
from typing import Any

from vssea_core.channels import LIMITS
from vssea_core.scenario import Scenario
from vssea_core.simulation.metrics import METRICS, limit_shares, metrics
from vssea_core.simulation.run import simulate
from vssea_core.simulation.trajectory import Trajectory

Pairs = dict[str, list[float | None]]
WORSE = 1.5
"""A peak error that grows by more than this factor is worth a warning."""
SENTENCES = {limit.name: limit.sentence for limit in LIMITS}


def compared_tunings(present: Scenario, candidate: Scenario) -> dict[str, Any]:
    """Return how a candidate does beside the present tuning, as docs/protocol.md has it; `present` may be unstable."""
    before, after = simulate(present), simulate(candidate)
    figures = metrics(before.rows), metrics(after.rows)
    pairs = {name: [_known(figure[name]) for figure in figures] for name in figures[1]}
    new_limits = [SENTENCES.get(name, name) for name in _new_limits(before, after)]
    why = _objection(after, pairs, new_limits)
    return {"ok": why is None, "sentence": why or _words(pairs), "metrics": pairs, "limits": new_limits}


def _new_limits(before: Trajectory, after: Trajectory) -> list[str]:
    shares = limit_shares(before.rows), limit_shares(after.rows)
    return [name for name, share in shares[1].items() if share > 0.0 and not shares[0].get(name)]


def _objection(after: Trajectory, pairs: Pairs, new_limits: list[str]) -> str | None:
    if after.ending is not None:
        return f"In simulation it does not hold: {after.ending}."
    before_peak, after_peak = pairs["peak_error"]
    if before_peak is not None and (after_peak is None or after_peak > WORSE * before_peak):
        return f"In simulation the peak error grows: {_words(pairs)}"
    if new_limits:
        return f"In simulation it is {' and '.join(new_limits)}. {_words(pairs)}"
    return None


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _words(pairs: Pairs) -> str:
    shown = [metric for metric in METRICS if None not in pairs[metric.name]][:3]
    words = [f"{m.label} {pairs[m.name][0]:.3g} → {pairs[m.name][1]:.3g} {m.unit}".rstrip() for m in shown]
    return f"{', '.join(words)}."
