"""Who may call: Host and Origin are checked on every HTTP request and websocket, and the token where one is set.

The Host check keeps other names from being pointed at this server (DNS rebinding), the Origin check keeps other sites'
pages from using it.
"""

import secrets
from urllib.parse import parse_qs, urlsplit

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import cookie_parser
from starlette.responses import RedirectResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocket

from backend.api.problems import problem_response
from backend.problem import Problem
from backend.settings import Settings

COOKIE = "vssea_token"
POLICY_VIOLATION = 1008
CONTENT_SECURITY_POLICY = "; ".join((
    "default-src 'self'", "style-src 'self' 'unsafe-inline'", "img-src 'self' data:", "frame-ancestors 'self'", "base-uri 'none'",
))  # fmt: skip


class Guard:
    """ASGI middleware around the whole application."""

    def __init__(self, app: ASGIApp, settings: Settings) -> None:
        self._app, self._hosts, self._token = app, settings.hosts, settings.token

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Let the request through, or answer why not."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        problem = self._objection(scope)
        if problem is not None:
            await self._refuse(problem, scope, receive, send)
        elif scope["type"] == "http" and scope["method"] == "GET" and self._token and _query(scope, "token"):
            await self._welcome(scope, receive, send)
        else:
            await self._app(scope, receive, _with_headers(send) if scope["type"] == "http" else send)

    def _objection(self, scope: Scope) -> Problem | None:
        headers = Headers(scope=scope)
        host = headers.get("host", "")
        if _name(host) not in self._hosts:
            return Problem(
                421,
                "Unknown host",
                f"This server is not called {_name(host)!r}; set VSSEA_ALLOWED_HOSTS if it should be.",
            )
        origin = headers.get("origin")
        if origin is not None and _netloc(origin) != host:
            return Problem(
                403, "Other origin", f"A page from {origin} may not use this server; open it from {host} itself."
            )
        if self._token is not None and not self._knows_token(scope, headers):
            return Problem(
                401,
                "Token needed",
                "This server needs its token: open the page once with ?token=..., or send Authorization: Bearer.",
            )
        return None

    def _knows_token(self, scope: Scope, headers: Headers) -> bool:
        given = (
            headers.get("authorization", "").removeprefix("Bearer "),
            # Lenient: another program's odd cookie on this host must not hide ours.
            cookie_parser(headers.get("cookie", "")).get(COOKIE, ""),
            _query(scope, "token"),
        )
        return any(secrets.compare_digest(value.encode(), (self._token or "").encode()) for value in given if value)

    async def _welcome(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Put the token of the address into a cookie, and take it out of the address."""
        # One slash: two would name another host.
        response = RedirectResponse("/" + scope["path"].lstrip("/\\"), status_code=303)
        response.set_cookie(
            COOKIE, self._token or "", httponly=True, samesite="strict", secure=scope["scheme"] == "https"
        )
        await response(scope, receive, send)

    async def _refuse(self, problem: Problem, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "http":
            await problem_response(problem)(scope, receive, send)
        else:
            await WebSocket(scope, receive, send).close(POLICY_VIOLATION, problem.title)


def _name(host: str) -> str:
    try:
        return (urlsplit(f"//{host}").hostname or "").lower()
    except ValueError:
        return host


def _netloc(origin: str) -> str:
    try:
        return urlsplit(origin).netloc
    except ValueError:
        return ""


def _query(scope: Scope, name: str) -> str:
    return parse_qs(scope.get("query_string", b"").decode("latin-1")).get(name, [""])[0]


def _with_headers(send: Send) -> Send:
    async def sending(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            headers.setdefault("Content-Security-Policy", CONTENT_SECURITY_POLICY)
            headers.setdefault("X-Content-Type-Options", "nosniff")
            headers.setdefault("Referrer-Policy", "no-referrer")
            headers.setdefault("Cache-Control", "no-cache")
        await send(message)

    return sending
