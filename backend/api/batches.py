"""Batches over REST: estimated, started, watched, ended, resumed; their results by pages or whole. Workers plan and read."""

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Header, Query, Request, Response
from fastapi.responses import FileResponse

from backend.api.reading import channels_in, named_file, read
from backend.api.resources import body_named, content_of
from backend.batch.batches import Batches
from backend.batch.catalogue import Row
from backend.batch.listed import whole_parts, why_none
from backend.compute.pool import Pool
from backend.problem import Problem

LARGEST_DOCUMENT = 4_000_000
EXPORT_LIMIT_S = 900.0
SIMULATION_LIMIT_S = 60.0
MOST_ROWS = 20_000
REFUSED = 422
Document = dict[str, Any]
State = Literal["queued", "running", "done", "cancelled", "failed"]


def batch_routes(batches: Batches, pool: Pool, folder: str) -> APIRouter:
    """Return the routes; large answers pass through files in `folder`."""
    router = APIRouter(prefix="/api/batches")

    @router.post("/estimate", openapi_extra=body_named("Batch"))
    async def estimate(request: Request) -> Document:
        """Say how many runs, seconds and bytes a batch would take, and which of some runs would be refused."""
        return await batches.estimate(await content_of(request, LARGEST_DOCUMENT))

    @router.post("", status_code=201, openapi_extra=body_named("Batch"))
    async def create(
        request: Request,
        response: Response,
        key: Annotated[str | None, Header(alias="Idempotency-Key", max_length=200)] = None,
    ) -> Document:
        """Start a batch, or return the one that was started with the same Idempotency-Key."""
        try:
            row, is_new = await batches.create(await content_of(request, LARGEST_DOCUMENT), key)
        except Problem as problem:
            problem.detail += " No batch was started." if problem.status == REFUSED else ""
            raise
        response.status_code = 201 if is_new else 200
        response.headers["Location"] = f"/api/batches/{row.id}"
        return await batches.document(row.id)

    @router.get("")
    async def listed(
        state: State | None = None,
        offset: Annotated[int, Query(ge=0)] = 0,
        limit: Annotated[int, Query(ge=1, le=500)] = 50,
    ) -> Document:
        """Return the batches, newest first."""
        return await batches.list(state, offset, limit)

    @router.get("/{batch}")
    async def one(batch: str) -> Document:
        """Return state, progress, rate, time left and counts of a batch."""
        return await batches.document(batch)

    @router.get("/{batch}/document")
    async def document(batch: str) -> FileResponse:
        """Return the document that a batch was started with."""
        path = await batches.document_path(await batches.row(batch))
        return FileResponse(path, media_type="application/json")

    @router.post("/{batch}/cancel")
    async def cancel(batch: str) -> Document:
        """End a batch that waits or runs; the parts that are done stay."""
        return await batches.cancel(batch)

    @router.post("/{batch}/resume")
    async def resume(batch: str) -> Document:
        """Let a batch that has ended go on with the parts that are missing."""
        return await batches.resume(batch)

    @router.delete("/{batch}")
    async def delete(batch: str) -> Document:
        """Delete a batch that has ended, with its results."""
        await batches.delete(batch)
        return {}

    @router.get("/{batch}/results")
    async def results(
        batch: str,
        offset: Annotated[int, Query(ge=0)] = 0,
        limit: Annotated[int, Query(ge=1, le=MOST_ROWS)] = 100,
        columns: str = "",
    ) -> Response:
        """Return rows of the runs that are computed, in their order; without columns all of them."""
        row = await batches.row(batch)
        path, asked = str(batches.folder_of(row).path), channels_in(columns) or None
        content = await read(batches.results.run("page", path, offset, limit, asked, whole_parts(row)), "batch")
        return Response(content, media_type="application/json")

    @router.get("/{batch}/results.{form}")
    async def results_file(batch: str, form: Literal["parquet", "csv", "arrow"]) -> FileResponse:
        """Return the rows of all runs that are computed, in their order, as a file."""
        return await exported(batch, "results", form)

    @router.get("/{batch}/trajectories.{form}")
    async def trajectories_file(batch: str, form: Literal["parquet", "arrow"]) -> FileResponse:
        """Return the samples that are kept, in the order of runs, as a file."""
        return await exported(batch, "trajectories", form)

    @router.get("/{batch}/runs/{number}")
    async def run(batch: str, number: int) -> Document:
        """Return values, state and figures of one run; `waiting` until it is computed."""
        row = await found(batch, number)
        path = await batches.document_path(row)
        values = await read(batches.plans.run("values_of", str(path), number), "batch")
        part = number // row.part_size
        kept = await read(batches.results.run("row", str(path.parent), number, part, whole_parts(row)), "batch")
        known = {} if kept is None else {name: value for name, value in kept.items() if name not in values}
        return {"run": number, "values": values, "state": "waiting", **known}

    @router.get("/{batch}/runs/{number}/scenario")
    async def scenario(batch: str, number: int) -> Document:
        """Return the whole scenario of one run."""
        document: Document = (await scenario_of(batch, number)).model_dump(mode="json")
        return document

    @router.post("/{batch}/runs/{number}/simulate")
    async def simulate(batch: str, number: int, every: Annotated[int, Query(ge=1, le=1000)] = 1) -> FileResponse:
        """Compute one run anew, to the same bits, and return its trajectory in binary frames as /api/simulate does."""
        job = pool.simulation.run(
            "simulate_to_file", await scenario_of(batch, number), "binary", every, True, folder, time_limit_s=SIMULATION_LIMIT_S
        )  # fmt: skip
        media_type, path = await read(job, "batch")
        return named_file(path, media_type)

    async def exported(batch: str, what: str, form: str) -> FileResponse:
        row = await batches.row(batch)
        if what == "trajectories" and row.summary["trajectories"] == "none":
            raise Problem(
                404, "No trajectories", "This batch keeps no trajectories; start one whose document keeps them."
            )
        path = str(batches.folder_of(row).path)
        job = batches.results.run(
            "export", path, what, form, folder, whole_parts(row), why_none(row, what), time_limit_s=EXPORT_LIMIT_S
        )
        media_type, file = await read(job, "batch")
        return named_file(file, media_type, f"{row.id}-{what}.{form}")

    async def found(batch: str, number: int) -> Row:
        row = await batches.row(batch)
        if not 0 <= number < row.runs:
            raise Problem(404, "No such run", f"There is no run {number}; this batch has runs 0 to {row.runs - 1}.")
        return row

    async def scenario_of(batch: str, number: int) -> Any:
        path = await batches.document_path(await found(batch, number))
        return await read(batches.plans.run("scenario_of", str(path), number), "batch")

    return router
