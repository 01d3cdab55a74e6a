"""Requests to one server: JSON in and out, or a body to read; every failure is a VsseaError."""

import http.client
import json
import urllib.error
import urllib.request
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import IO, Any
from urllib.parse import urlencode, urlsplit

from backend.client.document import text_of
from backend.client.problem import VsseaError, error_of

LOOPBACK = ("127.0.0.1", "localhost", "::1")
MOST_OF_A_PROBLEM = 1_000_000
"""Bytes of an error's body that are read."""


class _NoRedirects(urllib.request.HTTPRedirectHandler):
    """The token is for one server: it never follows to another one."""

    def redirect_request(self, *args: Any, **kwargs: Any) -> None:
        return None


class Connection:
    """Where the server is, its token, and how long it may be silent [s]."""

    def __init__(self, address: str, token: str | None, timeout_s: float) -> None:
        parts = urlsplit(address)
        if parts.scheme not in ("http", "https") or not parts.hostname or parts.query or parts.fragment:
            raise VsseaError(f"{address!r} is no address of a server; expected such as http://127.0.0.1:8000")
        self._base, self._token, self._timeout_s = address.rstrip("/"), token, timeout_s
        # A proxy of the environment leads to the network, and a loopback address is this machine.
        proxies = [urllib.request.ProxyHandler({})] if parts.hostname in LOOPBACK else []
        self._opener = urllib.request.build_opener(_NoRedirects, *proxies)

    def json(
        self,
        method: str,
        path: str,
        body: Any = None,
        query: Mapping[str, Any] | None = None,
        headers: Mapping[str, str] | None = None,
    ) -> Any:
        """Return the JSON of an answer, None of an empty one. Raises VsseaError."""
        with self.opened(method, path, body, query, headers) as answer:
            content = answer.read()
        try:
            return json.loads(content) if content else None
        except ValueError as error:
            raise VsseaError(f"{method} {self._base}{path} was not answered by a VSSEA server: {error}") from error

    @contextmanager
    def opened(
        self,
        method: str,
        path: str,
        body: Any = None,
        query: Mapping[str, Any] | None = None,
        headers: Mapping[str, str] | None = None,
    ) -> Iterator[IO[bytes]]:
        """Give the body of an answer to read. Raises VsseaError, also for what goes wrong while it is read."""
        chosen = {name: value for name, value in (query or {}).items() if value is not None}
        request = urllib.request.Request(
            f"{self._base}{path}" + (f"?{urlencode(chosen)}" if chosen else ""),
            data=None if body is None else text_of(body),
            headers={"Accept": "*/*", **(headers or {})},
            method=method,
        )
        if body is not None:
            request.add_header("Content-Type", "application/json")
        if self._token is not None:
            request.add_header("Authorization", f"Bearer {self._token}")
        asked = f"{method} {self._base}{path}"
        try:
            try:
                opened = self._opener.open(request, timeout=self._timeout_s)
            except ValueError:  # its words would show the token
                raise VsseaError(
                    f"{asked} cannot be asked: a key or token is no text for a header; expected ASCII"
                ) from None
            with opened as answer:
                yield answer
        except urllib.error.HTTPError as error:
            with error:
                raise error_of(error.code, error.read(MOST_OF_A_PROBLEM), asked) from None
        except TimeoutError as error:
            raise VsseaError(f"{asked} was not answered within {self._timeout_s:g} s") from error
        except urllib.error.URLError as error:
            if isinstance(error.reason, TimeoutError):
                raise VsseaError(f"{asked} was not answered within {self._timeout_s:g} s") from error
            raise VsseaError(
                f"{self._base} cannot be reached: {error.reason}; is `vssea serve` running there?"
            ) from error
        except (http.client.HTTPException, ConnectionError) as error:
            raise VsseaError(f"the answer to {asked} broke off: {error!r}; ask again") from error
