"""`vssea batch`: the rows of the batch in each form, taken up again after any end, and one sentence for whatever is wrong."""

import asyncio
import json
import signal
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.csv
import pyarrow.ipc
import pyarrow.parquet as pq
import pytest
from distributed import LocalCluster
from typer.testing import CliRunner, Result

from backend.batch import jobs, local_engine, part_jobs
from backend.batch.beside_output import BesideOutput
from backend.batch.dask_engine import DaskEngine
from backend.batch.engine import PartFailed, PartFiles, PartTask
from backend.batch.part_files import part_files
from backend.batch.progress import RunCounts
from backend.batch.terminal import Lines, words
from backend.cli import app
from tests.backend.server import free_port
from vssea_core.actuator.parameters import Sensors
from vssea_core.batch.document import Batch, Grid, Keep
from vssea_core.batch.part import run_part
from vssea_core.batch.plan import BatchPlan
from vssea_core.scenarios import NOMINAL

NOISY = NOMINAL.model_copy(update={"duration_s": 0.1, "sensors": Sensors(velocity_noise=0.1)})
BATCH = Batch(
    scenario=NOISY,
    vary=(Grid(path="actuator.link.inertia", low=0.5, high=2.0, count=40, factor=True),),
    noise="own",
    keep=Keep(trajectories="all", every=50),
)  # parts of 16, 16 and 8 runs
READ = {
    ".parquet": pq.read_table,
    ".csv": pyarrow.csv.read_csv,
    ".arrow": lambda path: pa.ipc.open_stream(path).read_all(),
}


class Here:
    """An engine in this process; `before` is called with the number of each part."""

    name, threads, at_a_time = "here", 1, 1

    def __init__(self, workers: int) -> None:
        self.computed: list[int] = []
        self.before = lambda number: None
        self.ended = False

    async def run(self, part: PartTask) -> PartFiles:
        self.before(part.number)
        await asyncio.sleep(0)  # where the end of the program is noticed
        self.computed.append(part.number)
        computed = run_part(part_jobs.plan_of(part.document), part.first, part.count)
        assert computed is not None
        return part_files(computed)

    def process_ids(self) -> list[int]:
        return []

    async def end(self) -> None:
        self.ended = True


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch) -> Here:
    engine = Here(1)
    monkeypatch.setattr(local_engine, "LocalEngine", lambda workers: engine)
    return engine


@pytest.fixture(autouse=True)
def interruptible() -> Iterator[None]:
    """SIGINT raises KeyboardInterrupt, also where the tests run in the background of a shell, which ignores it there."""
    before = [signal.signal(signal.SIGINT, signal.default_int_handler), signal.getsignal(signal.SIGTERM)]
    yield
    for number, handler in zip((signal.SIGINT, signal.SIGTERM), before, strict=True):
        signal.signal(number, handler)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    written = tmp_path / "batch.json"
    written.write_text(BATCH.model_dump_json(), "utf-8")
    return written


def vssea(*arguments: Any, stdin: str = "") -> Result:
    return CliRunner().invoke(app, ["batch", *map(str, arguments)], input=stdin)


def expected() -> dict[str, list[Any]]:
    part = run_part(BatchPlan(BATCH), 0, 40)
    assert part is not None
    return {name: [*column] for name, column in part.rows.items()}


@pytest.mark.parametrize("suffix", READ)
def test_each_form_has_a_row_a_run_and_the_samples_that_were_asked_for(here: Here, file: Path, suffix: str) -> None:
    output = file.with_name(f"out{suffix}")
    outcome = vssea(file, "-o", output)
    assert outcome.exit_code == 0, outcome.stderr
    samples = file.with_name(f"out-trajectories{suffix}")
    told = json.loads(outcome.stdout)
    assert told | {"seconds": 0} == {
        "runs": 40, "done": 40, "ended": 0, "refused": 0, "seconds": 0, "written": [str(output), str(samples)]
    }  # fmt: skip
    rows = READ[suffix](output).to_pydict()
    if suffix == ".csv":
        rows["reason"] = [reason or "" for reason in rows["reason"]]
    assert rows == expected()
    assert READ[suffix](samples).column_names == ["run", "time", "reference", "link_position", "motor_torque"]
    assert READ[suffix](samples).num_rows == 40 * 2
    assert sorted(path.name for path in file.parent.iterdir()) == [
        "batch.json",
        f"out-trajectories{suffix}",
        f"out{suffix}",
    ]
    assert here.ended


def test_ctrl_c_keeps_what_is_done_and_the_same_command_goes_on(here: Here, file: Path) -> None:
    output = file.with_name("out.parquet")
    here.before = lambda number: signal.raise_signal(signal.SIGINT) if number == 1 else None
    outcome = vssea(file, "-o", output)
    assert outcome.exit_code == 130
    assert outcome.stderr == (
        f"vssea: ended; what is done is kept in {output}.parts, and the same command goes on from there\n"
    )
    assert not output.exists()
    assert (here.computed, here.ended) == ([0], True)
    here.before = lambda number: None
    assert vssea(file, "-o", output, "--workers", 2).exit_code == 0
    assert here.computed == [0, 1, 2]
    assert pq.read_table(output).to_pydict() == expected()
    assert not output.with_name("out.parquet.parts").exists()


@pytest.mark.parametrize(("number", "status"), [(signal.SIGTERM, 143), (signal.SIGINT, 130)], ids=["term", "int"])
def test_the_first_signal_ends_it_and_those_after_it_change_nothing(
    here: Here, file: Path, monkeypatch: pytest.MonkeyPatch, number: signal.Signals, status: int
) -> None:
    output = file.with_name("out.parquet")
    here.before = lambda part: signal.raise_signal(number) if part == 1 else None

    async def end() -> None:
        for late in (signal.SIGINT, signal.SIGTERM, signal.SIGINT):
            signal.raise_signal(late)
            await asyncio.sleep(0)
        here.ended = True

    monkeypatch.setattr(here, "end", end)
    outcome = vssea(file, "-o", output)
    signal.raise_signal(signal.SIGINT)  # as late as the last line of the program
    assert (outcome.exit_code, here.ended) == (status, True)
    assert outcome.stderr == (
        f"vssea: ended; what is done is kept in {output}.parts, and the same command goes on from there\n"
    )


def test_signals_are_handled_as_before_once_a_batch_is_whole(here: Here, file: Path) -> None:
    before = signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGTERM)
    assert vssea(file, "-o", file.with_name("out.parquet")).exit_code == 0
    assert vssea(file, "-o", file.with_name("out.parquet")).exit_code == 2
    assert (signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGTERM)) == before


def test_a_part_that_keeps_failing_is_told_and_what_is_done_is_kept(here: Here, file: Path) -> None:
    def fail(number: int) -> None:
        if number == 1:
            raise PartFailed("out of memory")

    here.before = fail
    outcome = vssea(file, "-o", file.with_name("out.csv"))
    assert outcome.exit_code == 2
    assert outcome.stderr == (
        "vssea: part 1 failed 3 times: out of memory; "
        f"what is done is kept in {file.with_name('out.csv')}.parts, and the same command goes on from there\n"
    )
    assert file.with_name("out.csv.parts").joinpath("part-00000.parquet").exists()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda parts: (parts / "batch.json").write_text("{}"), "holds parts of another batch"),
        (lambda parts: (parts / "parts.json").unlink(), "is no folder of a batch's parts"),
        (lambda parts: (parts / "parts.json").write_text('{"part_size": 16, "version": "1"}'), "by another version"),
    ],
    ids=["another document", "no parts", "another version"],
)
def test_parts_of_something_else_are_never_taken_up_or_removed(here: Here, file: Path, change: Any, words: str) -> None:
    output = file.with_name("out.parquet")
    here.before = lambda number: signal.raise_signal(signal.SIGINT) if number == 1 else None
    vssea(file, "-o", output)
    parts = output.with_name("out.parquet.parts")
    change(parts)
    before = {path.name: path.read_bytes() for path in parts.iterdir()}
    outcome = vssea(file, "-o", output)
    assert outcome.exit_code == 2
    assert f"{words}" in outcome.stderr
    assert "remove it, or write elsewhere" in outcome.stderr
    assert {path.name: path.read_bytes() for path in parts.iterdir()} == before
    assert here.computed == [0]


@pytest.mark.parametrize("when", ["it starts", "it computes", "it finishes"])
def test_a_second_command_is_kept_away_from_the_first_ones_parts_until_the_output_is_whole(
    here: Here, file: Path, monkeypatch: pytest.MonkeyPatch, when: str
) -> None:
    output = file.with_name("out.parquet")
    refused: list[str] = []

    def try_it(*_: Any) -> None:
        with pytest.raises(ValueError, match=r"is in use by another vssea batch; wait") as raised, second.held():
            pass
        refused.append(str(raised.value))

    second = BesideOutput(output)
    if when == "it computes":
        here.before = lambda number: try_it() if number == 1 else None
    else:
        name = {"it starts": "take_up", "it finishes": "finish"}[when]
        does = getattr(BesideOutput, name)
        monkeypatch.setattr(BesideOutput, name, lambda *given: (try_it(), does(*given), try_it())[1])
    outcome = vssea(file, "-o", output)
    assert outcome.exit_code == 0, outcome.stderr
    assert len(refused) == (1 if when == "it computes" else 2)
    assert pq.read_table(output).to_pydict() == expected()
    with second.held():
        second_try = vssea(file, "-o", output, "--force")
    assert (second_try.exit_code, second_try.stderr) == (2, f"vssea: {refused[0]}\n")
    assert sorted(path.name for path in file.parent.iterdir()) == [
        "batch.json",
        "out-trajectories.parquet",
        "out.parquet",
    ]


def test_ctrl_c_while_the_output_is_written_comes_too_late(
    here: Here, file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    output, finish, ended = file.with_name("out.parquet"), BesideOutput.finish, threading.Event()

    def interrupted(beside: BesideOutput) -> list[Path]:
        signal.raise_signal(signal.SIGINT)
        assert ended.wait(20.0)  # until the loop has heard of it
        return finish(beside)

    monkeypatch.setattr(BesideOutput, "finish", interrupted)
    shield = asyncio.shield

    async def shielded(task: Any) -> Any:
        try:
            return await shield(task)
        finally:
            ended.set()

    monkeypatch.setattr(asyncio, "shield", shielded)
    outcome = vssea(file, "-o", output)
    assert (outcome.exit_code, outcome.stderr) == (0, "")
    assert json.loads(outcome.stdout)["done"] == 40
    assert pq.read_table(output).to_pydict() == expected()
    assert not output.with_name("out.parquet.parts").exists()


def test_ctrl_c_before_anything_is_kept_says_no_more(here: Here, file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plan = jobs.plan_batch
    monkeypatch.setattr(jobs, "plan_batch", lambda *given: (signal.raise_signal(signal.SIGINT), plan(*given))[1])
    outcome = vssea(file, "-o", file.with_name("out.parquet"))
    assert (outcome.exit_code, outcome.stderr) == (130, "vssea: ended\n")
    assert [path.name for path in file.parent.iterdir()] == ["batch.json"]


def test_the_rate_leaves_out_the_first_part_of_every_thread(
    here: Here, file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: list[int] = []

    class Told(RunCounts):
        def __init__(self, *given: Any, **named: Any) -> None:
            told.append(named["threads"])
            super().__init__(*given, **named)

    monkeypatch.setattr("backend.batch.progress.RunCounts", Told)
    here.threads = 3
    assert vssea(file, "-o", file.with_name("out.parquet")).exit_code == 0
    assert told == [3]


def test_a_batch_has_no_more_runs_than_the_setting_allows(
    here: Here, file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("VSSEA_BATCH_MOST_RUNS", "39")
    outcome = vssea(file)
    assert outcome.exit_code == 2
    assert (
        "The batch has 40 runs; expected at most 39 runs. Vary less, or raise VSSEA_BATCH_MOST_RUNS." in outcome.stderr
    )
    monkeypatch.setenv("VSSEA_BATCH_MOST_RUNS", "none")
    assert "batch_most_runs" in vssea(file).stderr
    assert [path.name for path in file.parent.iterdir()] == ["batch.json"]


def test_without_an_output_the_table_is_named_after_the_file(
    here: Here, file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(file.parent)
    assert vssea(file).exit_code == 0
    assert pq.read_table(file.with_name("batch.parquet")).num_rows == 40
    assert vssea("-", "-o", "other.csv", stdin=file.read_text("utf-8")).exit_code == 0
    assert pyarrow.csv.read_csv(file.with_name("other.csv")).num_rows == 40


@pytest.mark.parametrize("name", ["out.parquet", "out-trajectories.parquet"])
def test_a_file_that_is_there_is_never_replaced_unasked(here: Here, file: Path, name: str) -> None:
    there, output = file.with_name(name), file.with_name("out.parquet")
    there.write_text("of somebody")
    outcome = vssea(file, "-o", output)
    assert outcome.exit_code == 2
    assert outcome.stderr == f"vssea: {there} exists; add --force to replace it, or write elsewhere\n"
    assert (there.read_text(), here.computed) == ("of somebody", [])
    assert sorted(path.name for path in file.parent.iterdir()) == ["batch.json", name]
    assert vssea(file, "-o", output, "--estimate").exit_code == 0
    assert vssea(file, "-o", output, "--force").exit_code == 0
    assert pq.read_table(output).to_pydict() == expected()
    assert pq.read_table(file.with_name("out-trajectories.parquet")).num_rows == 40 * 2


def test_a_file_that_this_batch_does_not_write_stays(here: Here, file: Path) -> None:
    file.write_text(BATCH.model_copy(update={"keep": Keep()}).model_dump_json(), "utf-8")
    mine = file.with_name("keep-trajectories.parquet")
    mine.write_text("of somebody")
    for force in ([], ["--force"]):
        assert vssea(file, "-o", file.with_name("keep.parquet"), *force).exit_code == 0
        assert mine.read_text() == "of somebody"


def test_samples_of_a_replaced_output_go_with_it(here: Here, file: Path) -> None:
    assert vssea(file, "-o", file.with_name("out.csv")).exit_code == 0
    file.write_text(BATCH.model_copy(update={"keep": Keep(trajectories="ended")}).model_dump_json(), "utf-8")
    assert vssea(file, "-o", file.with_name("out.csv"), "--force").exit_code == 0  # and none of its runs ended early
    assert sorted(path.name for path in file.parent.iterdir()) == ["batch.json", "out.csv"]


def test_an_output_that_somebody_writes_meanwhile_is_not_replaced(here: Here, file: Path) -> None:
    output = file.with_name("out.parquet")
    here.before = lambda number: output.write_text("of somebody") and None
    outcome = vssea(file, "-o", output)
    assert outcome.exit_code == 2
    assert outcome.stderr == (
        f"vssea: {output} exists; add --force to replace it, or write elsewhere; "
        f"what is done is kept in {output}.parts, and the same command goes on from there\n"
    )
    assert output.read_text() == "of somebody"
    assert vssea(file, "-o", output, "--force").exit_code == 0
    assert here.computed == [0, 1, 2]
    assert pq.read_table(output).to_pydict() == expected()


def test_a_place_where_nothing_can_be_written_is_told_before_anything_is_computed(here: Here, file: Path) -> None:
    folder = file.with_name("dir.parquet")
    folder.mkdir()
    outcome = vssea(file, "-o", folder)
    assert (outcome.exit_code, outcome.stderr) == (
        2, f"vssea: {folder} is a folder; expected the name of a file to write\n"
    )  # fmt: skip
    nowhere = file.with_name("new") / "out.csv"
    assert f"folder {nowhere.parent} does not exist" in vssea(file, "-o", nowhere, "--force").stderr
    assert "cannot be written" in vssea(file, "-o", "/proc/out.csv").stderr
    assert here.computed == []
    assert sorted(path.name for path in file.parent.iterdir()) == ["batch.json", "dir.parquet"]


def test_a_file_may_begin_with_a_byte_order_mark_and_a_name_end_in_capitals(here: Here, file: Path) -> None:
    file.write_bytes(b"\xef\xbb\xbf" + file.read_bytes())
    assert vssea(file, "-o", file.with_name("out.PARQUET")).exit_code == 0
    assert pq.read_table(file.with_name("out.PARQUET")).to_pydict() == expected()


def test_an_estimate_is_told_and_nothing_is_written(here: Here, file: Path) -> None:
    outcome = vssea(file, "--estimate", "-o", file.with_name("out.parquet"))
    assert outcome.exit_code == 0, outcome.stderr
    told = json.loads(outcome.stdout)
    assert (told["runs"], told["samples"], told["in_lanes"], told["refused"]) == (40, 4000, 0.0, [])
    assert [each["actuator.link.inertia"] for each in told["first"]] == expected()["actuator.link.inertia"][:3]
    assert here.computed == []
    assert [path.name for path in file.parent.iterdir()] == ["batch.json"]


HEAVY = json.dumps({"vary": [{"kind": "list", "path": "timing.sample_time_s", "values": [-1.0, -2.0]}]})


@pytest.mark.parametrize(
    ("arguments", "stdin", "words"),
    [
        (["nothing.json"], "", "nothing.json cannot be read"),
        (["-"], "{", "standard input is not JSON: EOF while parsing an object"),
        (["-"], '{"varied": []}', "unknown name"),
        (
            ["no"],
            "",
            "vssea: no is not JSON: expected ident at line 1 column 2; expected a batch document (docs/batches.md)",
        ),
        (["-"], '{"vary": [{"kind": "grid", "path": "seed", "low": 0}]}', "vary.0.high is missing"),
        (
            ["-"],
            '{"vary": [{"kind": "grid", "path": "tuning.observer.bandwith", "low": 1, "high": 2}]}',
            "vssea: tuning.observer.bandwith is no field of the scenario; nearest: tuning.observer.bandwidth",
        ),
        (["-"], HEAVY, "no run of this batch can start; Run 0: "),
        (["-", "-o", "out.xlsx"], "{}", "expected a name ending in .parquet, .csv, .arrow"),
        (["-", "-o", "no/such/out.csv"], "{}", "no/such/out.csv cannot be written: folder no/such does not exist"),
        (["-", "--dask", "somewhere"], "{}", "is no address of a Dask scheduler"),
        (["-", "--dask", "tcp://127.0.0.1:1", "--workers", "2"], "{}", "expected one of them"),
    ],
    ids=str,
)
def test_what_is_wrong_is_told_in_one_sentence(
    here: Here, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], stdin: str, words: str
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "no").write_text("no batch")
    outcome = vssea(*arguments, stdin=stdin)
    assert outcome.exit_code == 2
    assert outcome.stdout == ""
    assert outcome.stderr.startswith("vssea: ")
    assert words in outcome.stderr
    assert outcome.stderr.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["no"]


def test_a_scheduler_out_of_reach_is_told_before_anything_is_written(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    address = f"tcp://127.0.0.1:{free_port()}"
    monkeypatch.setattr("backend.batch.dask_engine.DaskEngine", lambda given: DaskEngine(given, connect_limit_s=0.2))
    outcome = vssea(file, "-o", file.with_name("out.parquet"), "--dask", address)
    assert outcome.exit_code == 2
    assert outcome.stderr.startswith(f"vssea: no Dask scheduler answers at {address}; start one with `dask scheduler`")
    assert [path.name for path in file.parent.iterdir()] == ["batch.json"]


@pytest.fixture
def cluster() -> Iterator[LocalCluster]:
    with LocalCluster(
        n_workers=1, threads_per_worker=1, processes=True, host="127.0.0.1", dashboard_address="127.0.0.1:0",
        silence_logs=50,
    ) as started:  # fmt: skip
        yield started


def test_a_cluster_gives_the_same_table(file: Path, cluster: LocalCluster) -> None:
    outcome = vssea(file, "-o", file.with_name("out.parquet"), "--dask", cluster.scheduler_address)
    assert outcome.exit_code == 0, outcome.stderr
    assert pq.read_table(file.with_name("out.parquet")).to_pydict() == expected()


def test_the_bar_says_how_fast_it_is_and_how_long_it_will_take() -> None:
    times = iter([0.0, 4.0, 4.0, 4.0, 4.0, 4.0])
    progress = RunCounts(10_000, 5, {}, 0, lambda: next(times))
    assert words(progress) == "0 of 10,000 runs, starting"
    progress.add({"done": 1990, "ended": 8, "refused": 2})
    assert words(progress) == "2,000 of 10,000 runs, 8 ended, 2 refused, 500 runs/s, 0:00:16 left"


def test_without_a_terminal_there_is_a_line_every_ten_seconds_and_at_every_tenth() -> None:
    now = [0.0]
    progress, lines = RunCounts(10_000, 200, {}, 0, lambda: now[0]), list[str]()
    shows = Lines(progress, lines.append, lambda: now[0])
    told = []
    for seconds, runs in (
        (9.0, 400),
        (1.0, 100),
        (1.0, 499),
        (1.0, 1),
        (9.0, 900),
        (0.1, 99),
        (0.1, 4001),
        (0.5, 3000),
        (0.5, 1000),
    ):
        now[0] += seconds
        progress.add({"done": runs})
        shows.show()
        told.append(len(lines))
    assert told == [0, 1, 1, 2, 2, 2, 3, 3, 4]
    assert lines[0] == "5 %, 500 of 10,000 runs, 100 runs/s, 0:01:35 left"
    assert lines[-1].startswith("100 %, 10,000 of 10,000 runs")
