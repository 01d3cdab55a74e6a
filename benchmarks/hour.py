"""One hour at 1 kHz from the ring into a recording, faster than real time: size, memory, samples lost, and per-message writing."""

import tempfile
import time
from pathlib import Path

import numpy as np
from mcap.writer import Writer

from backend.recordings.layout import COLUMNS_KEPT, FIELDS, telemetry_schema
from backend.recordings.messages import Answer, Begin, Wrote
from backend.recordings.reader import Recording
from backend.recordings.room import Room
from backend.recordings.writing import Writing
from backend.telemetry.ring import Ring, RingReader, RingWriter, Samples
from benchmarks.kills import ring_samples
from vssea_core.channels import INDEX

HOUR = 3_600_000
AT_ONCE = 5000
BEGIN_NS = 1_700_000_000_000_000_000


def resident_mb() -> float:
    """Return the memory of this process."""
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith("VmRSS"):
            return int(line.split()[1]) / 1024
    return float("nan")


def record(folder: Path, source: Samples, count: int) -> tuple[float, float, float, int]:
    """Record `count` samples; return seconds, memory [MB] after the first minute and at the end, samples lost."""
    ring = Ring()
    writer, answers = RingWriter(ring.name), list[Answer]()
    writing = Writing(RingReader(ring.name), folder, 2 * count * 1e-3, Room(folder, 0), answers.append)
    writing.take(Begin(1, 1, {"id": "hour", "begin_ns": str(BEGIN_NS), "origin": "live"}, {"name": "realistic"}, 1))
    time_column, begun, first_mb = INDEX["time"], time.perf_counter(), 0.0
    for done in range(0, count, AT_ONCE):
        rows = np.take(source, np.arange(done, done + AT_ONCE) % len(source), axis=0)
        rows[:, time_column] = 1e-3 * np.arange(done, done + AT_ONCE)
        written = 0
        while written < len(rows):
            _, room = writer.room(len(rows) - written)
            room[:] = rows[written : written + len(room)]
            writer.announce(len(room))
            written += len(room)
        answers.clear()
        writing.turn(done * 1e-3)
        if done == 60_000:
            first_mb = resident_mb()
    lost = max(answer.lost for answer in answers if isinstance(answer, Wrote))
    last_mb = resident_mb()
    writing.end("done")
    taken = time.perf_counter() - begun
    ring.close()
    return taken, first_mb, last_mb, lost


def per_message(path: Path, source: Samples, count: int) -> float:
    """Write `count` samples one by one with the public library, protobuf and all; return the seconds it took."""
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

    pool = descriptor_pool.DescriptorPool()
    for file in descriptor_pb2.FileDescriptorSet.FromString(telemetry_schema()).file:
        pool.Add(file)
    message = message_factory.GetMessageClass(pool.FindMessageTypeByName("vssea.Telemetry"))
    names = [field.name for field in FIELDS]
    begun = time.perf_counter()
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        schema = writer.register_schema("vssea.Telemetry", "protobuf", telemetry_schema())
        channel = writer.register_channel("/telemetry", "protobuf", schema)
        for number in range(count):
            values = source[number % len(source), COLUMNS_KEPT].tolist()
            at = BEGIN_NS + 1_000_000 * number
            writer.add_message(channel, at, message(**dict(zip(names, values, strict=True))).SerializeToString(), at)
        writer.finish()
    return time.perf_counter() - begun


def main() -> None:
    """Print the hour, and what a minute costs message by message."""
    source = ring_samples(100_000)
    with tempfile.TemporaryDirectory() as folder:
        taken, first_mb, last_mb, lost = record(Path(folder), source, HOUR)
        path = Path(folder) / "hour.mcap"
        size = path.stat().st_size
        begun = time.perf_counter()
        found = Recording(path)
        opened = time.perf_counter() - begun
        single = per_message(Path(folder) / "messages.mcap", source, 60_000)
        print(f"one hour at 1 kHz, {len(FIELDS)} numbers a sample, `realistic`")
        pace = HOUR / 1e3 / taken
        print(f"  {size / 1e6:.0f} MB, {found.samples} samples, lost {lost}, {taken:.1f} s ({pace:.0f} x real time)")
        print(
            f"  memory after the first minute {first_mb:.0f} MB, at the end {last_mb:.0f} MB; opened in {1e3 * opened:.0f} ms"
        )
        print(
            f"  a sample {1e6 * taken / HOUR:.1f} us; message by message with the public library {1e6 * single / 60_000:.1f} us"
        )


if __name__ == "__main__":
    main()
