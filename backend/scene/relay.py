"""Routes of the scene: its page, and a relay between browsers and the scene process.

viser checks no Origin and knows no users; the relay asks `check_origin` before it lets anyone through.
"""

import asyncio
from collections.abc import Callable
from contextlib import suppress
from typing import Final

from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import BaseRoute, Route, WebSocketRoute
from starlette.websockets import WebSocket, WebSocketDisconnect
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, WebSocketException
from websockets.typing import Subprotocol

from backend.scene.page import CONTENT_SECURITY_POLICY, scene_page, waiting_page
from backend.scene.palette import Theme

POLICY_VIOLATION: Final = 1008
INTERNAL_ERROR: Final = 1011
TRY_AGAIN_LATER: Final = 1013
NOT_FOR_THE_WIRE: Final = {1004: 1000, 1005: 1000, 1006: INTERNAL_ERROR, 1015: INTERNAL_ERROR}
"""Close codes that say how a connection ended but may not be sent, and what is sent instead."""

Closing = tuple[int, str]
"""Close code and reason."""


def scene_routes(
    get_port: Callable[[], int | None],
    check_origin: Callable[[WebSocket], bool],
    get_sentence: Callable[[], str] = lambda: "The 3D scene is starting; it appears here in a moment.",
    time_limit_s: float = 10.0,
    place: str = "/scene",
) -> list[BaseRoute]:
    """The page `/scene/` and the websocket `/scene`, or those of another `place`.

    Parameters
    ----------
    get_port : the scene process's port on 127.0.0.1, or None while there is none.
    check_origin : whether this websocket request may see the scene.
    get_sentence : what the page says while there is no scene.
    time_limit_s : for connecting to the scene, and for a browser to take one message before it is let go.
    """

    async def page(request: Request) -> Response:
        theme: Theme = "light" if request.query_params.get("theme") == "light" else "dark"
        content = scene_page(theme) if get_port() is not None else waiting_page(theme, get_sentence())
        headers = {"Content-Security-Policy": CONTENT_SECURITY_POLICY, "Cache-Control": "no-cache"}
        return Response(content, media_type="text/html", headers=headers)

    async def socket(browser: WebSocket) -> None:
        if not check_origin(browser):
            await browser.close(POLICY_VIOLATION, "This origin may not see the scene.")
            return
        port = get_port()
        if port is None:
            await browser.close(TRY_AGAIN_LATER, get_sentence())
            return
        await relay(browser, f"ws://127.0.0.1:{port}", time_limit_s)

    return [Route(f"{place}/", page, methods=["GET"]), WebSocketRoute(place, socket)]


async def relay(browser: WebSocket, upstream_address: str, time_limit_s: float) -> None:
    """Pass messages both ways, untouched, until one side closes; then close the other with the same code."""
    offered = [Subprotocol(name) for name in browser.scope["subprotocols"]]
    try:
        # viser packs its messages itself, and a proxy setting of the environment must not see loopback traffic.
        upstream = await connect(
            upstream_address,
            subprotocols=offered or None,
            compression=None,
            max_size=None,
            proxy=None,
            open_timeout=time_limit_s,
            close_timeout=time_limit_s,
        )
    except (OSError, TimeoutError, WebSocketException):
        await browser.close(TRY_AGAIN_LATER, "The 3D scene does not answer; try again.")
        return
    async with upstream:
        await browser.accept(subprotocol=upstream.subprotocol)
        from_browser = asyncio.create_task(_from_browser(browser, upstream))
        to_browser = asyncio.create_task(_to_browser(browser, upstream, time_limit_s))
        try:
            await asyncio.wait([from_browser, to_browser], return_when=asyncio.FIRST_COMPLETED)
        finally:
            from_browser.cancel()
            to_browser.cancel()
            await asyncio.wait([from_browser, to_browser])
        if not from_browser.cancelled():
            await upstream.close(*from_browser.result())
        elif not to_browser.cancelled():
            with suppress(TimeoutError, WebSocketDisconnect, RuntimeError):  # it may have gone in the meantime
                async with asyncio.timeout(time_limit_s):
                    await browser.close(*to_browser.result())


async def _from_browser(browser: WebSocket, upstream: ClientConnection) -> Closing:
    """Browser to scene, until the browser leaves; answers how."""
    while True:
        event = await browser.receive()
        if event["type"] == "websocket.disconnect":
            return _closing(event.get("code"), event.get("reason"))
        message = event.get("bytes")
        with suppress(ConnectionClosed):  # the other direction reports the end, with its code
            await upstream.send(event["text"] if message is None else message)


async def _to_browser(browser: WebSocket, upstream: ClientConnection, time_limit_s: float) -> Closing:
    """Scene to browser, until the scene closes or the browser no longer reads; answers how."""
    try:
        async for message in upstream:
            async with asyncio.timeout(time_limit_s):
                if isinstance(message, str):
                    await browser.send_text(message)
                else:
                    await browser.send_bytes(message)
    except ConnectionClosed:
        pass  # closed with an error code, which is passed on below
    except TimeoutError:
        return TRY_AGAIN_LATER, "This page was too slow for the scene."
    except (WebSocketDisconnect, RuntimeError):
        return 1000, ""  # the browser has gone
    return _closing(upstream.close_code, upstream.close_reason)


def _closing(code: int | None, reason: str | None) -> Closing:
    """Code and reason as they may be sent on."""
    return NOT_FOR_THE_WIRE.get(code or 1005, code or 1000), reason or ""
