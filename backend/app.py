"""Composition root: settings in, application out."""

import gc
import importlib.resources
import tempfile
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

from fastapi import FastAPI
from starlette.middleware import Middleware
from starlette.staticfiles import StaticFiles

from backend.api.actuators import actuator_routes
from backend.api.analysis import analysis
from backend.api.batches import batch_routes
from backend.api.documentation import documentation
from backend.api.export import export
from backend.api.guard import Guard
from backend.api.live import live
from backend.api.presets import preset_routes
from backend.api.problems import add_problem_handlers
from backend.api.recording_origins import recording_origin_routes
from backend.api.recordings import recording_routes
from backend.api.resources import resources
from backend.api.rigs import rig_routes
from backend.batch.start import ServedBatches
from backend.compute.pool import Pool
from backend.processes import set_niceness
from backend.recordings.catalogue import Catalogue
from backend.recordings.excerpts import Excerpts
from backend.recordings.library import Library
from backend.recordings.recorder import Recorder
from backend.rigs.library import RigLibrary
from backend.scene.process import SceneProcess
from backend.scene.relay import scene_routes
from backend.scene.replay import ReplayScene
from backend.session.session import Session
from backend.settings import Settings
from backend.store.database import Database
from backend.tasks.tasks import Tasks
from vssea_core import __version__

WEB_NICENESS = -10
"""STOP passes through this process, so it goes before other programs where the system allows it."""


def create_app(settings: Settings) -> FastAPI:
    """Return the whole application; its processes start and end with it."""
    settings.data_dir.mkdir(parents=True, exist_ok=True)
    database = Database(settings.database_url)
    pool = Pool()
    batches = ServedBatches(settings, database)
    pool.also(batches.process_ids)
    tasks = Tasks(pool.tasks)
    recorder = Recorder(settings)
    rigs = RigLibrary(settings.rigs_folder)
    session = Session(settings, pool, database, recorder, recorder, Excerpts(database), rigs)
    library = Library(settings, Catalogue(database), recorder, pool.archive)
    scene = SceneProcess(session.ring_name)
    replay = ReplayScene()
    answers = tempfile.TemporaryDirectory(prefix="vssea-")

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        set_niceness(WEB_NICENESS)
        session.start()
        recorder.start(session.ring_name, session.tell, session.note_recording, library.added)
        library.start(session.recordings_changed, session.note_recording)
        batches.start(session.tell)
        if settings.scene:
            scene.start()
        gc.collect()
        gc.freeze()  # a collection of all that was imported would stall STOP for tens of milliseconds
        yield
        await session.rig.close()  # first of all: nothing may move without its pages
        await scene.stop()
        await replay.stop()
        await library.stop()
        await recorder.stop()
        await session.close()
        await batches.stop()
        await tasks.stop()
        await pool.stop()
        database.close()
        answers.cleanup()

    app = FastAPI(
        title="VSSEA", version=__version__, lifespan=lifespan, docs_url=None, redoc_url=None,
        description="Robust position control of a variable stiffness series elastic actuator: simulate and tune live.",
        middleware=[Middleware(Guard, settings=settings)],
    )  # fmt: skip
    add_problem_handlers(app)
    app.include_router(resources(session, pool, answers.name))
    app.include_router(preset_routes(session))
    app.include_router(actuator_routes(session, pool))
    app.include_router(rig_routes(session, pool, rigs))
    app.include_router(analysis(session, pool, tasks, answers.name))
    app.include_router(export(session, pool))
    app.include_router(batch_routes(batches, pool, answers.name))
    app.include_router(recording_origin_routes(pool, tasks, library, answers.name))
    app.include_router(recording_routes(session, pool, library, replay if settings.scene else None, answers.name))
    app.include_router(live(session, recorder))
    app.include_router(documentation())
    # The guard has checked Host and Origin of every websocket before this.
    app.router.routes.extend(scene_routes(lambda: scene.port, lambda _: True, lambda: scene.sentence))
    app.router.routes.extend(
        scene_routes(lambda: replay.port, lambda _: True, lambda: replay.sentence, place="/replay")
    )
    static = Path(str(importlib.resources.files("frontend_static")))
    app.mount("/", StaticFiles(directory=static, html=True), name="page")
    app.state.session = session
    return app
