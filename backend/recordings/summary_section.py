"""The end of a finished recording: what it holds and where, so that a reader need not walk through it."""

from collections import Counter

from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import Channel, ChunkIndex, DataEnd, Footer, MetadataIndex, Schema, Statistics, SummaryOffset

from backend.recordings.scan import MAGIC, Scan


def summary_section(found: Scan, declarations: list[Schema | Channel], offset: int) -> bytes:
    """Return everything from the end of the data on, for position `offset` of the file."""
    builder = RecordBuilder()
    DataEnd(0).write(builder)
    start = builder.count
    groups: list[SummaryOffset] = []

    def group(opcode: Opcode, records: list[object]) -> None:
        begin = builder.count
        for record in records:
            record.write(builder)  # type: ignore[attr-defined]
        if records:
            groups.append(SummaryOffset(opcode, offset + begin, builder.count - begin))

    group(Opcode.SCHEMA, [record for record in declarations if isinstance(record, Schema)])
    group(Opcode.CHANNEL, [record for record in declarations if isinstance(record, Channel)])
    group(Opcode.STATISTICS, [_statistics(found, declarations)])
    group(Opcode.CHUNK_INDEX, [
        ChunkIndex(
            place.length, place.offset, "zstd", place.compressed, place.end_ns, place.index_length,
            {place.channel: place.offset + place.length}, place.start_ns, place.size,
        )
        for place in found.places
    ])  # fmt: skip
    group(Opcode.METADATA_INDEX, [MetadataIndex(at, length, name) for name, at, length in found.metadata_places])
    offsets = builder.count
    for each in groups:
        each.write(builder)
    Footer(offset + start, offset + offsets, 0).write(builder)
    return builder.end() + MAGIC


def _statistics(found: Scan, declarations: list[Schema | Channel]) -> Statistics:
    counts: Counter[int] = Counter()
    for place in found.places:
        counts[place.channel] += place.messages
    schemas = sum(isinstance(record, Schema) for record in declarations)
    return Statistics(
        attachment_count=0,
        channel_count=len(declarations) - schemas,
        channel_message_counts=dict(counts),
        chunk_count=len(found.places),
        message_count=counts.total(),
        message_end_time=max((place.end_ns for place in found.places), default=0),
        message_start_time=min((place.start_ns for place in found.places), default=0),
        metadata_count=len(found.metadata_places),
        schema_count=schemas,
    )
