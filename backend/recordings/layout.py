"""What a recording holds: its topics, and one telemetry sample as a protobuf message of fixed length.

Every field of a sample is written, zeros too, so that all messages are of one length: a block of samples is one numpy array,
written and read without a loop, and still plain protobuf for everybody else.
"""

from typing import NamedTuple

import numpy as np
from google.protobuf.descriptor_pb2 import FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet

from backend.telemetry.ring import EXECUTION_US, LATENESS_US
from vssea_core.channels import CHANNELS

TELEMETRY, SCENARIO, CHANGES, COMMANDS, EVENTS = 1, 2, 3, 4, 5
"""Ids of the file's MCAP channels."""
TOPICS = {TELEMETRY: "/telemetry", SCENARIO: "/scenario", CHANGES: "/changes", COMMANDS: "/commands", EVENTS: "/events"}
FORMAT = "1"
MESSAGE_OPCODE = 0x05
DOUBLE = 1  # protobuf's wire type of 8 bytes


class Field(NamedTuple):
    """One number of a telemetry message and the column of the ring that it comes from."""

    name: str
    symbol: str
    unit: str
    label: str
    column: int


FIELDS: tuple[Field, ...] = (
    *(Field(c.name, c.symbol, c.unit, c.label, column) for column, c in enumerate(CHANNELS)),
    Field("tick_lateness_us", "", "µs", "how late the tick started", LATENESS_US),
    Field("tick_execution_us", "", "µs", "how long the tick took", EXECUTION_US),
)
FIELD_INDEX = {field.name: number for number, field in enumerate(FIELDS)}
COLUMNS_KEPT = [field.column for field in FIELDS]


def _tag(number: int) -> bytes:
    tag = number << 3 | DOUBLE
    return bytes([tag]) if tag < 128 else bytes([tag & 127 | 128, tag >> 7])


TAGS = [_tag(number + 1) for number in range(len(FIELDS))]
MESSAGE = np.dtype(
    [
        ("opcode", "u1"), ("length", "<u8"), ("channel", "<u2"), ("sequence", "<u4"), ("log_time", "<u8"), ("publish_time", "<u8"),
        *(item for n, tag in enumerate(TAGS) for item in ((f"tag{n}", f"V{len(tag)}"), (f"value{n}", "<f8"))),
    ]
)  # fmt: skip
"""One MCAP message record of a telemetry sample, byte by byte."""
RECORD_HEAD = 9  # opcode and length, which the length does not count


def empty_messages(count: int) -> np.ndarray:
    """Return `count` telemetry messages with everything set that is the same in each."""
    messages = np.zeros(count, MESSAGE)
    messages["opcode"] = MESSAGE_OPCODE
    messages["length"] = MESSAGE.itemsize - RECORD_HEAD
    messages["channel"] = TELEMETRY
    for number, tag in enumerate(TAGS):
        messages[f"tag{number}"] = np.void(tag)
    return messages


def values_of(messages: np.ndarray) -> np.ndarray:
    """Return all numbers of telemetry messages (n,) as (n, fields), in the order of FIELDS."""
    content = np.ascontiguousarray(messages)
    values = np.empty((len(content), len(FIELDS)))
    for first, last in _RUNS:
        offset = MESSAGE.fields[f"value{first}"][1]  # type: ignore[index]
        shape, strides = (len(content), last - first), (MESSAGE.itemsize, len(TAGS[first]) + 8)
        values[:, first:last] = np.ndarray(shape, "<f8", content.data, offset, strides)
    return values


_SHORT = sum(len(tag) == 1 for tag in TAGS)
_RUNS = ((0, _SHORT), (_SHORT, len(FIELDS)))
"""Fields that follow each other at equal distances, since their tags are of one length."""


def telemetry_schema() -> bytes:
    """Return the FileDescriptorSet of `vssea.Telemetry`; each field's comment has symbol, label and unit."""
    file = FileDescriptorProto(name="vssea/telemetry.proto", package="vssea", syntax="proto3")
    message = file.message_type.add(name="Telemetry")
    comment = file.source_code_info.location.add(path=[4, 0], span=[0, 0, 0])
    comment.leading_comments = (
        " One sample of a variable stiffness series elastic actuator and its controller; SI units.\n"
    )
    for number, field in enumerate(FIELDS):
        message.field.add(
            name=field.name,
            number=number + 1,
            type=FieldDescriptorProto.TYPE_DOUBLE,
            label=FieldDescriptorProto.LABEL_OPTIONAL,
        )
        comment = file.source_code_info.location.add(path=[4, 0, 2, number], span=[number + 1, 0, 0])
        symbol = f"{field.symbol}, " if field.symbol else ""
        comment.leading_comments = f" {symbol}{field.label} [{field.unit or '1'}]\n"
    return FileDescriptorSet(file=[file]).SerializeToString(deterministic=True)


def _object(**properties: str) -> dict[str, object]:
    return {"type": "object", "properties": {name: {"type": kind} for name, kind in properties.items()}}


JSON_SCHEMAS: dict[int, tuple[str, dict[str, object]]] = {
    SCENARIO: ("vssea.Scenario", {"type": "object"}),
    CHANGES: ("vssea.Change", _object(at_s="number", by="string", part="string", tuning_id="integer", words="array",
                                      changes="object", document="object")),
    COMMANDS: ("vssea.Command", _object(at_s="number", wall_time="string", by="string", command="string", arguments="object",
                                        ok="boolean", problem="object")),
    # The name and the first five fields are what Foxglove's log panel looks for.
    EVENTS: ("foxglove.Log", {"type": "object", "properties": {
        "timestamp": {"type": "object", "title": "time", "properties": {"sec": {"type": "integer"}, "nsec": {"type": "integer"}}},
        "level": {"type": "integer"}, "message": {"type": "string"}, "name": {"type": "string"}, "file": {"type": "string"},
        "line": {"type": "integer"}, "at_s": {"type": "number"}, "kind": {"type": "string"}, "by": {"type": "string"},
        "severity": {"type": "string"}, "wall_time": {"type": "string"}, "number": {"type": "integer"},
    }}),
}  # fmt: skip
