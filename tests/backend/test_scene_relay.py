"""The way from the scene process to a browser: the process, the relay and the page, against a small server of ours."""

import asyncio
import math
import multiprocessing
import socket
from collections.abc import AsyncIterator, Awaitable, Callable, Coroutine
from contextlib import asynccontextmanager
from multiprocessing.connection import Connection
from typing import Any

import pytest
import uvicorn
from httpx import ASGITransport, AsyncClient, Response
from starlette.applications import Starlette
from starlette.websockets import WebSocket
from websockets.asyncio.client import connect
from websockets.asyncio.server import ServerConnection, serve
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.typing import Origin, Subprotocol

from backend.scene.actuator_scene import ScenePose
from backend.scene.page import scene_page
from backend.scene.process import SceneProcess, follow
from backend.scene.relay import scene_routes
from backend.scene.replay import ReplayScene
from backend.telemetry.ring import RingReader
from vssea_core.channels import CHANNELS, INDEX

OURS = Origin("http://ours.test")
VISER = Subprotocol("viser-v0.0.0")
LIMIT_S = 20.0
POSE = ScenePose(0.1, 0.1, 0.12, 0.02, 200.0, 53.7, 0.0)


def run(test: Coroutine[Any, Any, None]) -> None:
    """Run a test with a time limit, so that a fault fails it and never hangs it."""
    asyncio.run(asyncio.wait_for(test, LIMIT_S))


def from_us(websocket: WebSocket) -> bool:
    return websocket.headers.get("origin") == OURS


def get(path: str, port: int | None, place: str = "/scene") -> Response:
    """The answer to a GET while the scene has that port."""
    app = Starlette(routes=scene_routes(lambda: port, from_us, place=place))

    async def ask() -> Response:
        async with AsyncClient(transport=ASGITransport(app), base_url=OURS) as client:
            return await client.get(path)

    return asyncio.run(ask())


@asynccontextmanager
async def relayed(
    handler: Callable[[ServerConnection], Awaitable[None]], time_limit_s: float = 5.0
) -> AsyncIterator[str]:
    """A scene that answers by `handler`, behind the relay; gives the relay's address."""
    async with serve(handler, "127.0.0.1", 0, subprotocols=[VISER], compression=None, max_size=None) as scene:
        port = next(iter(scene.sockets)).getsockname()[1]
        app = Starlette(routes=scene_routes(lambda: port, from_us, time_limit_s=time_limit_s))
        async with served(app) as address:
            yield address


@asynccontextmanager
async def served(app: Starlette) -> AsyncIterator[str]:
    """The app on a port of its own; gives the address of its scene."""
    listener = socket.create_server(("127.0.0.1", 0))
    config = uvicorn.Config(
        app, log_level="warning", lifespan="off", timeout_graceful_shutdown=1, ws_per_message_deflate=False
    )
    server = uvicorn.Server(config)
    serving = asyncio.create_task(server.serve(sockets=[listener]))
    try:
        yield f"ws://127.0.0.1:{listener.getsockname()[1]}/scene"
    finally:
        server.should_exit = True
        await serving


def test_messages_pass_both_ways_untouched_and_the_subprotocol_is_echoed() -> None:
    async def echo(scene: ServerConnection) -> None:
        async for message in scene:
            await scene.send(message)

    async def check() -> None:
        async with (
            relayed(echo) as address,
            connect(address, origin=OURS, subprotocols=[VISER], max_size=None) as browser,
        ):
            assert browser.subprotocol == VISER
            for message in ("words", b"\x00\xff bytes", bytes(3_000_000)):
                await browser.send(message)
                assert await browser.recv() == message

    run(check())


@pytest.mark.parametrize("origin", [Origin("http://other.test"), None])
def test_a_wrong_or_missing_origin_never_reaches_the_scene(origin: Origin | None) -> None:
    visitors = []

    async def note(scene: ServerConnection) -> None:
        visitors.append(scene)

    async def check() -> None:
        async with relayed(note) as address:
            with pytest.raises(InvalidStatus) as refusal:
                await connect(address, origin=origin, subprotocols=[VISER])
            assert refusal.value.response.status_code == 403

    run(check())
    assert not visitors


def test_the_scenes_close_code_and_reason_reach_the_browser() -> None:
    async def leave(scene: ServerConnection) -> None:
        await scene.close(1002, "Version mismatch")

    async def check() -> None:
        async with relayed(leave) as address, connect(address, origin=OURS, subprotocols=[VISER]) as browser:
            with pytest.raises(ConnectionClosed):
                await browser.recv()
            assert (browser.close_code, browser.close_reason) == (1002, "Version mismatch")

    run(check())


def test_the_browsers_close_code_reaches_the_scene() -> None:
    codes: asyncio.Queue[int | None] = asyncio.Queue()

    async def wait(scene: ServerConnection) -> None:
        await scene.wait_closed()
        codes.put_nowait(scene.close_code)

    async def check() -> None:
        async with relayed(wait) as address:
            browser = await connect(address, origin=OURS, subprotocols=[VISER])
            await browser.close(4001)
            assert await codes.get() == 4001

    run(check())


def test_a_browser_that_does_not_read_is_let_go() -> None:
    freed = asyncio.Event()

    async def flood(scene: ServerConnection) -> None:
        try:
            while True:
                await scene.send(bytes(1_000_000))
        except ConnectionClosed:
            freed.set()

    async def check() -> None:
        async with relayed(flood, time_limit_s=0.3) as address:
            browser = await connect(address, origin=OURS, subprotocols=[VISER], max_queue=1, max_size=None)
            await freed.wait()
            browser.transport.abort()

    run(check())


def test_without_a_scene_the_socket_is_refused() -> None:
    async def check() -> None:
        async with served(Starlette(routes=scene_routes(lambda: None, from_us))) as address:
            with pytest.raises(InvalidStatus):
                await connect(address, origin=OURS)

    run(check())


def test_a_scene_that_is_gone_refuses_the_socket() -> None:
    with socket.create_server(("127.0.0.1", 0)) as closed_soon:
        port = closed_soon.getsockname()[1]

    async def check() -> None:
        async with served(Starlette(routes=scene_routes(lambda: port, from_us))) as address:
            with pytest.raises(InvalidStatus):
                await connect(address, origin=OURS)

    run(check())


def test_until_the_scene_is_up_its_page_says_so_and_asks_again() -> None:
    page = get("/scene/?theme=light", None)
    assert page.status_code == 200
    assert "The 3D scene is starting" in page.text
    assert '<meta http-equiv="refresh" content="1">' in page.text


@pytest.mark.parametrize("theme", ["dark", "light"])
def test_the_page_is_visers_with_our_preface_before_any_script_of_its_own(theme: str) -> None:
    page = get(f"/scene/?theme={theme}", 1)
    assert f"color-scheme:{theme}" in page.text
    assert page.text.index("window.vsseaScene") < page.text.index("<script data-p")
    assert "frame-ancestors 'self'" in page.headers["content-security-policy"]


def test_an_unknown_theme_is_shown_dark() -> None:
    assert get("/scene/?theme=%3Cscript%3E", 1).content == scene_page("dark")


def test_the_scene_shows_the_newest_pose_until_its_keeper_leaves() -> None:
    keeper, scene = multiprocessing.Pipe()
    shown: list[ScenePose] = []

    def show(pose: ScenePose) -> None:
        shown.append(pose)
        if len(shown) == 3:
            keeper.close()

    follow(lambda: POSE, show, lambda: True, scene)
    assert shown == [POSE] * 3


def test_without_visitors_nothing_is_read_or_drawn() -> None:
    keeper, scene = multiprocessing.Pipe()

    def nobody() -> bool:
        keeper.close()
        return False

    def unwanted() -> ScenePose:
        raise AssertionError("read without a visitor")

    follow(unwanted, lambda pose: None, nobody, scene)
    assert keeper.closed


def serve_nothing(ring_name: str, pipe: Connection) -> None:
    """A scene process that reports a port and stays until its keeper leaves."""
    pipe.send(4242)
    pipe.poll(LIMIT_S)


def fail_at_once(ring_name: str, pipe: Connection) -> None:
    """A scene process that dies before it reports anything."""


async def until(condition: Callable[[], bool]) -> None:
    """Look again and again, within the test's time limit."""
    while not condition():  # noqa: ASYNC110  another process changes it: nothing here could set an event
        await asyncio.sleep(0.01)


def test_the_port_is_known_while_the_process_lives() -> None:
    async def check() -> None:
        process = SceneProcess("ring", target=serve_nothing)
        process.start()
        await until(lambda: process.port is not None)
        assert process.port == 4242
        await process.stop()
        assert process.port is None
        assert not [child for child in multiprocessing.active_children() if child.name == "vssea scene"]

    run(check())


def test_a_scene_that_keeps_failing_is_left_off_and_says_so() -> None:
    async def check() -> None:
        process = SceneProcess("ring", target=fail_at_once, restart_pauses_s=(0.0,))
        process.start()
        await until(lambda: "stays off" in process.sentence)
        assert process.port is None
        await process.stop()

    run(check())


def follow_the_ring(ring_name: str, pipe: Connection) -> None:
    """A scene process that reports the link's position [mrad] as its port."""
    reader = RingReader(ring_name)
    while reader.latest() is None:
        pass
    newest = reader.latest()
    pipe.send(0 if newest is None else round(1e3 * newest[INDEX["link_position"]]))
    pipe.poll(LIMIT_S)
    reader.close()


def test_the_scene_of_a_recording_starts_at_its_first_use_and_is_shown_the_sample() -> None:
    async def check() -> None:
        scene = ReplayScene(follow_the_ring)
        assert scene.port is None
        assert "appears here when one is opened" in scene.sentence
        await scene.stop()
        row = [0.0] * len(CHANNELS)
        row[INDEX["link_position"]], row[INDEX["stiffness"]] = 1.234, math.nan
        scene.show(row)
        await until(lambda: scene.port is not None)
        assert scene.port == 1234
        scene.show(row)
        await scene.stop()
        assert not [child for child in multiprocessing.active_children() if child.name == "vssea scene"]

    run(check())


def test_the_scene_of_a_recording_has_a_place_of_its_own() -> None:
    assert "The 3D scene is starting" in get("/replay/", None, "/replay").text
    assert get("/scene/", None, "/replay").status_code == 404
