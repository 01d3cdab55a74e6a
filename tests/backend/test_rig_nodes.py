"""Node numbers of a rig's file: this computer's own, which the drives watch, is nobody else's."""

from typing import Any

import pytest
from pydantic import ValidationError

from backend.rigs.canopen.objects import OWN_NODE
from backend.rigs.rig_file import RigFile
from tests.backend.rig_bench import EMULATOR


@pytest.mark.parametrize("device", ["motor", "stiffness", "link"])
def test_no_device_has_the_number_of_the_computer_whose_heartbeat_the_drives_watch(device: str) -> None:
    def with_node(node: int) -> dict[str, Any]:
        document = EMULATOR.model_dump(mode="json")
        document[device]["node"] = node
        return document

    RigFile.model_validate(with_node(OWN_NODE - 1))
    with pytest.raises(ValidationError, match="less than or equal to 126"):
        RigFile.model_validate(with_node(OWN_NODE))
