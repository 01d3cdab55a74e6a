"""What pydantic refuses is told by the path a user knows, with the value and what was expected."""

import json
from typing import Any

import pytest
from pydantic import ValidationError

from vssea_core.batch.document import Batch
from vssea_core.field_errors import field_errors, sentence_of
from vssea_core.scenario import Scenario

TOLD: list[tuple[type[Batch] | type[Scenario], dict[str, Any], str]] = [
    (Scenario, {"tuning": {"observer": {"kind": "velocity", "bandwidth": 0.5}}},
     "tuning.observer.bandwidth is 0.5; expected a number from 1 to 2000 rad/s"),
    (Scenario, {"disturbances": {"link": [{"kind": "sine", "frequency": 1}]}},
     "disturbances.link.0.frequency is 1; unknown name; known here: start_s, end_s, kind, amplitude, frequency_hz, phase"),
    (Scenario, {"tuning": {"controller": {"kind": "sliding_mod"}}},
     "tuning.controller.kind is 'sliding_mod'; expected one of 'state_feedback', 'sliding_mode', 'baseline'"),
    (Scenario, {"seed": 1.5}, "seed is 1.5; expected a whole number from 0 to 2147483647"),
    (Batch, {"vary": [{"path": "seed"}]}, "vary.0.kind is missing; expected one of 'grid', 'list', 'sample', 'zip'"),
    (Batch, {"vary": [{"kind": "list", "path": "seed", "values": []}]}, "vary.0.values is []; expected at least 1 item"),
    (Batch, {"vary": [{"kind": "grid", "path": "seed", "low": 0, "high": 1, "count": 2.5}]},
     "vary.0.count is 2.5; expected a whole number from 1 to 100000"),
    (Batch, {"seed": -1, "noise": "loud"}, "seed is -1; expected a whole number from 0 to 2147483647; 1 more field is refused"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("model", "document", "sentence"), TOLD, ids=lambda case: case if isinstance(case, str) else ""
)
def test_a_refused_field_is_told_in_a_sentence(
    model: type[Batch] | type[Scenario], document: dict[str, Any], sentence: str
) -> None:
    with pytest.raises(ValidationError) as refused:
        model.model_validate_json(json.dumps(document))
    assert sentence_of(field_errors(refused.value, model)) == sentence
