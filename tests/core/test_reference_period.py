"""The period of a reference is what its samples say."""

from typing import Any

import numpy as np
import pytest

from vssea_core.channels import INDEX
from vssea_core.scenario import Scenario
from vssea_core.signals.period import period_s
from vssea_core.simulation.run import simulate

BEGUN_S = 8.0
PERIODIC: list[dict[str, Any]] = [
    {"kind": "sine", "frequency_hz": 0.5},
    {"kind": "move", "duration_s": 1.0, "dwell_s": 0.5},
    {"kind": "step", "target": 0.02, "dwell_s": 1.5},
    {"kind": "filtered_step", "dwell_s": 1.25, "bandwidth": 30.0},
    {"kind": "multisine", "components": [{"amplitude": 0.1, "frequency_hz": 0.6}, {"amplitude": 0.1, "frequency_hz": 0.8}]},
]  # fmt: skip
WITHOUT: list[dict[str, Any]] = [
    {"kind": "sine", "frequency_hz": 0.0},
    {"kind": "sine", "frequency_hz": 0.001},
    {"kind": "move", "repeat": False},
    {"kind": "step", "repeat": False},
    {"kind": "chirp"},
    {"kind": "jog"},
    {"kind": "recorded"},
    {"kind": "multisine", "components": []},
    {"kind": "multisine", "components": [{"frequency_hz": 0.5}, {"frequency_hz": 0.50001}]},
]


def scenario(reference: dict[str, Any]) -> Scenario:
    return Scenario.model_validate({"reference": reference, "duration_s": 24.0})


@pytest.mark.parametrize("reference", PERIODIC, ids=lambda reference: reference["kind"])
def test_samples_repeat_after_one_period_and_not_after_half(reference: dict[str, Any]) -> None:
    asked = scenario(reference)
    period = period_s(asked.reference)
    assert period is not None
    values = simulate(asked).rows[:, INDEX["reference"]]
    begun, shift = round(BEGUN_S * 1000), round(period * 1000)
    assert np.allclose(values[begun + shift :], values[begun:-shift], atol=1e-9)
    half = shift // 2
    assert not np.allclose(values[begun + half :], values[begun:-half], atol=1e-3)


@pytest.mark.parametrize("reference", WITHOUT, ids=str)
def test_what_does_not_repeat_within_a_minute_has_no_period(reference: dict[str, Any]) -> None:
    assert period_s(scenario(reference).reference) is None
