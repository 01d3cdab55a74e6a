"""`vssea batch`: a batch computed here, without a server, part by part, so that it can be ended and taken up again."""

import asyncio
import json
import os
import sys
import time
from codecs import BOM_UTF8
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from pydantic import ValidationError

from backend.batch.ending import Ended, run_until_ended
from backend.refusal import refuse

if TYPE_CHECKING:
    from backend.batch.beside_output import BesideOutput
    from backend.batch.engine import Engine
    from backend.batch.limits import Limits

ENDED_BY_USER = 130
"""Exit status of a program that Ctrl+C has ended."""


def batch(
    file: Annotated[str, typer.Argument(help="Batch as JSON: a file, or - for standard input.")],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", help="Table to write, a row a run: .parquet, .csv or .arrow; FILE.parquet if unset."
        ),
    ] = None,
    workers: Annotated[int | None, typer.Option(min=1, help="Processes that compute; one a core if unset.")] = None,
    dask: Annotated[
        str | None, typer.Option(help="Compute on the cluster of this Dask scheduler, such as tcp://127.0.0.1:8786.")
    ] = None,
    estimate: Annotated[bool, typer.Option(help="Only tell how many runs, seconds and bytes it would take.")] = False,
    force: Annotated[bool, typer.Option(help="Replace an output that is there already.")] = False,
) -> None:
    """Run a batch of scenarios here and write a row for each run; docs/batches.md says what a batch is.

    Ctrl+C or SIGTERM ends it and keeps what is done: the same command goes on from there.
    """
    from backend.batch.beside_output import FORMS, BesideOutput, OutputExists
    from backend.batch.engine import PartFailed

    output = output or Path(f"{'batch' if file == '-' else Path(file).stem}.parquet")
    if output.suffix.lower() not in FORMS:
        refuse(f"{output} cannot be written: expected a name ending in {', '.join(FORMS)}")
    if dask is not None and workers is not None:
        refuse("--workers is of this machine and --dask of a cluster; expected one of them")
    document, samples = _document(file)
    beside = BesideOutput(output, samples, force)
    try:
        if not estimate:
            beside.check()
        run_until_ended(_run(document, beside, workers or os.cpu_count() or 1, dask, estimate))
    except Ended as end:
        typer.echo(f"vssea: ended{_goes_on(output)}", err=True)
        raise typer.Exit(end.status) from None
    except KeyboardInterrupt:
        typer.echo(f"vssea: ended{_goes_on(output)}", err=True)
        raise typer.Exit(ENDED_BY_USER) from None
    except (PartFailed, OutputExists) as failure:
        refuse(f"{failure}{_goes_on(output)}")
    except ValueError as refusal:
        refuse(str(refusal))
    except OSError as error:
        refuse(f"{output} cannot be written: {error}{_goes_on(output)}")


async def _run(document: str, beside: "BesideOutput", workers: int, address: str | None, only_estimate: bool) -> None:
    from backend.batch.estimate import estimate_of, why_refused
    from backend.batch.jobs import plan_batch

    engine = _engine(workers, address)
    try:
        if address is not None:
            await engine.connect()
            workers = engine.threads
            if waiting_for := engine.waiting_for:
                typer.echo(f"vssea: waits for {waiting_for}", err=True)
        plan = plan_batch(document, workers)
        await asyncio.sleep(0)  # Ctrl+C meanwhile ends it before there is a folder
        if only_estimate:
            typer.echo(json.dumps(estimate_of(plan), indent=2, ensure_ascii=False))
            return
        if why := why_refused(plan):
            refuse(why)
        with beside.held():
            beside.check()  # another command may have written it meanwhile
            await _compute(engine, document, plan, beside)
    finally:
        await engine.end()


async def _compute(engine: "Engine", document: str, plan: dict[str, Any], beside: "BesideOutput") -> None:
    from backend.batch.part_run import parts_of, run_parts
    from backend.batch.progress import RunCounts, summed
    from backend.batch.result_jobs import counts_by_part
    from backend.batch.terminal import shown

    begun_s = time.monotonic()
    parts = parts_of(document, plan["runs"], beside.take_up(document, plan["part_size"]))
    found = counts_by_part(str(beside.path)).items()
    there = {number: counts for number, counts in found if counts is not None}  # what cannot be read is computed again
    progress = RunCounts(plan["runs"], len(parts), summed(there.values()), len(there), threads=engine.threads)
    with shown(progress) as show:

        async def keep(part: Any, files: Any) -> None:
            await asyncio.to_thread(beside.folder.keep, part.number, files)
            progress.add(files.counts)
            show()

        await run_parts(engine, [part for part in parts if part.number not in there], keep)
    finishing = asyncio.create_task(asyncio.to_thread(beside.finish))
    try:
        written = await asyncio.shield(finishing)
    except asyncio.CancelledError:  # all is computed, and a thread does not end halfway
        written = await finishing
    figures = {"runs": plan["runs"], **progress.counts, "seconds": round(time.monotonic() - begun_s, 1)}
    typer.echo(json.dumps(figures | {"written": [str(path) for path in written]}, indent=2))


def _goes_on(output: Path) -> str:
    parts = Path(f"{output}.parts")
    return f"; what is done is kept in {parts}, and the same command goes on from there" if parts.exists() else ""


def _engine(workers: int, address: str | None) -> Any:
    if address is None:
        from backend.batch.local_engine import LocalEngine

        return LocalEngine(workers)
    from backend.batch.dask_engine import DaskEngine

    try:
        return DaskEngine(address)
    except ValueError as refusal:
        refuse(str(refusal))


def _document(file: str) -> tuple[str, bool]:
    """Return a batch's document, whole and always written the same way, and whether samples may be kept."""
    from backend.batch.limits import runs_of
    from backend.problem import Problem, from_validation
    from vssea_core.batch.document import Batch

    named = "standard input" if file == "-" else file
    try:
        content = sys.stdin.buffer.read() if file == "-" else Path(file).read_bytes()
        batch = Batch.model_validate_json(content.removeprefix(BOM_UTF8))
        _limits().check_runs(runs_of(batch))
        return batch.model_dump_json(), batch.keep.trajectories != "none"
    except Problem as refusal:
        refuse(refusal.detail)
    except ValidationError as error:
        if (first := error.errors(include_url=False)[0])["type"] == "json_invalid":
            refuse(f"{named} is not JSON: {first['ctx']['error']}; expected a batch document (docs/batches.md)")
        refuse(from_validation(error, Batch).detail)
    except OSError as error:
        refuse(f"{named} cannot be read: {error}; expected the file of a batch as JSON")


def _limits() -> "Limits":
    from backend.batch.limits import Limits
    from backend.settings import Settings

    try:
        return Limits.of(Settings())
    except ValueError as error:
        refuse(" ".join(str(error).split()))
