"""Who may call: Host, Origin and token, on HTTP and on both websockets; what the pages may load."""

import asyncio
import re
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import httpx
import pytest
from pydantic import ValidationError
from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import PlainTextResponse
from starlette.routing import Route
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect
from websockets.typing import Origin

from backend.api.guard import Guard
from backend.settings import Settings
from tests.backend.server import START_LIMIT_S, Server, until

TOKEN = "a-secret-of-some-length"
BAD_HOSTS = ["evil.test", "127.0.0.1.evil.test", "", "[", "[::1", "localhost@evil.test", "evil.test:8000"]
BAD_ORIGINS = ["http://evil.test", "null", "http://[", "http://127.0.0.1:1", "http://127.0.0.1.evil.test", ""]


def ask(path: str, method: str = "GET", token: str | None = TOKEN, **headers: str) -> httpx.Response:
    """The answer of a guarded application, without a server."""

    async def hello(request: Request) -> PlainTextResponse:
        return PlainTextResponse("hello")

    guard = Middleware(Guard, settings=Settings(token=token))
    app = Starlette(routes=[Route("/{rest:path}", hello, methods=["GET", "POST"])], middleware=[guard])

    async def send() -> httpx.Response:
        async with httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url="http://127.0.0.1:8000") as client:
            return await client.request(method, path, headers=headers)

    return asyncio.run(send())


@pytest.mark.parametrize("host", BAD_HOSTS)
def test_another_host_name_is_refused(http: httpx.Client, host: str) -> None:
    answer = http.get("/api/health", headers={"Host": host})
    assert answer.status_code in (400, 421)  # a host that is none at all ends in the HTTP parser
    if answer.status_code == 421:
        assert answer.json()["title"] == "Unknown host"


@pytest.mark.parametrize("origin", BAD_ORIGINS)
def test_another_origin_is_refused(http: httpx.Client, origin: str) -> None:
    before = http.get("/api/session").json()["state"]
    answer = http.post("/api/session/stop", headers={"Origin": origin})
    assert (answer.status_code, answer.json()["title"]) == (403, "Other origin")
    assert http.get("/api/session").json()["state"] == before


@pytest.mark.parametrize("host", ["127.0.0.1:{}", "localhost:{}", "LOCALHOST:{}", "[::1]:{}"])
def test_the_pages_own_origin_may_call(http: httpx.Client, server: Server, host: str) -> None:
    name = host.format(server.port)
    assert http.get("/api/health", headers={"Host": name, "Origin": f"http://{name}"}).status_code == 200


@pytest.mark.parametrize("path", ["/api/live", "/scene"])
@pytest.mark.parametrize("kind", ["host", "origin"])
def test_the_websockets_refuse_them_too(server: Server, path: str, kind: str) -> None:
    host, origin = ("evil.test", None) if kind == "host" else ("127.0.0.1", Origin("http://evil.test"))
    with (
        socket.create_connection(("127.0.0.1", server.port)) as plug,
        pytest.raises(InvalidStatus) as refusal,
    ):
        connect(f"ws://{host}:{server.port}{path}", sock=plug, origin=origin, proxy=None)
    assert refusal.value.response.status_code == 403


def test_on_loopback_no_token_is_needed() -> None:
    assert ask("/api/health", token=None).text == "hello"


@pytest.mark.parametrize(
    "headers",
    [{}, {"Authorization": "Bearer wrong"}, {"Authorization": f"Basic {TOKEN}"}, {"Cookie": "vssea_token=wrong"}],
    ids=str,
)
def test_without_the_token_nothing_is_answered(headers: dict[str, str]) -> None:
    for path in ("/", "/api/health", "/docs", "/scene/", "/?token=wrong"):
        answer = ask(path, **headers)
        assert (answer.status_code, answer.json()["title"]) == (401, "Token needed")


@pytest.mark.parametrize(
    "headers",
    [
        {"Authorization": f"Bearer {TOKEN}"},
        {"Cookie": f"vssea_token={TOKEN}"},
        {"Cookie": f"of@another=program; vssea_token={TOKEN}"},
    ],
    ids=str,
)
def test_the_token_opens_by_header_or_cookie(headers: dict[str, str]) -> None:
    assert ask("/api/health", **headers).text == "hello"


def test_the_token_in_the_address_becomes_a_cookie_and_leaves_the_address() -> None:
    answer = ask(f"/?token={TOKEN}")
    assert (answer.status_code, answer.headers["location"]) == (303, "/")
    cookie = answer.headers["set-cookie"]
    assert cookie.startswith(f"vssea_token={TOKEN};")
    assert "HttpOnly" in cookie
    assert "SameSite=strict" in cookie


def test_the_redirect_never_leads_to_another_host() -> None:
    assert ask(f"http://127.0.0.1:8000//evil.test/?token={TOKEN}").headers["location"] == "/evil.test/"


def test_a_command_with_the_token_in_its_address_is_carried_out() -> None:
    assert ask(f"/api/session/stop?token={TOKEN}", "POST").text == "hello"


@pytest.mark.parametrize("host", ["0.0.0.0", "192.0.2.1", "::"])
def test_beyond_loopback_a_token_is_demanded_at_the_start(host: str) -> None:
    with pytest.raises(ValidationError, match="no token is set; set VSSEA_TOKEN"):
        Settings(host=host)
    with pytest.raises(ValidationError, match="at least 16 characters"):
        Settings(host=host, token="short")
    assert Settings(host=host, token=TOKEN).hosts >= {"127.0.0.1", "localhost"}


@pytest.fixture(scope="module")
def guarded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """A server that demands a token."""
    started = Server(tmp_path_factory.mktemp("data"), VSSEA_TOKEN=TOKEN)
    yield started
    started.terminate()


def test_the_live_websocket_needs_the_token(guarded: Server) -> None:
    until(guarded.answers, START_LIMIT_S)
    address = f"ws://127.0.0.1:{guarded.port}/api/live"
    with pytest.raises(InvalidStatus):
        connect(address, proxy=None)
    with connect(address, proxy=None, additional_headers={"Authorization": f"Bearer {TOKEN}"}) as page:
        assert '"hello"' in str(page.recv(20.0))


@pytest.mark.parametrize("path", ["/", "/docs", "/scene/", "/api/session", "/app/main.js"])
def test_every_answer_restricts_what_it_may_load_and_do(http: httpx.Client, path: str) -> None:
    headers = http.get(path).headers
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["referrer-policy"] == "no-referrer"
    policy = headers["content-security-policy"]
    assert "default-src" in policy
    assert not re.search(r"https?:|\*", policy.replace("data:", ""))


@pytest.mark.parametrize("path", ["/", "/docs"])
def test_the_pages_refer_to_no_other_host(http: httpx.Client, path: str) -> None:
    page = http.get(path).text
    assert not re.findall(r"(?:src|href|url)\s*[=:(]\s*[\"']?(?:https?:)?//", page)
    for linked in re.findall(r"<(?:script|link)[^>]+(?:src|href)=\"([^\"]+)\"", page):
        assert http.get("/" + linked.lstrip("/")).status_code == 200


LOADED = "import sys, backend.app; print(*sorted({name.split('.')[0] for name in sys.modules}))"


@pytest.mark.parametrize("absent", ["numba", "scipy", "control", "viser"])
def test_the_web_process_loads_no_tool_of_the_others(loaded: Callable[[], set[str]], absent: str) -> None:
    assert "fastapi" in loaded()
    assert absent not in loaded()


@pytest.fixture(scope="module")
def loaded() -> Callable[[], set[str]]:
    """Names of the packages that the web process imports."""
    root = Path(__file__).parents[2]
    listing = subprocess.run(
        [sys.executable, "-c", LOADED], cwd=root, capture_output=True, text=True, check=True
    ).stdout
    return lambda: set(listing.split())
