"""If-Match and If-None-Match: what a caller believes the document to be."""

import re

from fastapi import Request, Response

from backend.problem import refused
from backend.store.document import Document
from backend.store.expected import ANY, NEW, Expected
from vssea_core.field_errors import FieldError

_TAG = re.compile(r'\s*(?:W/)?"([^"]*)"\s*(?:,|$)')


def expected_of(request: Request) -> Expected | None:
    """Return what the conditions of a request say, None if there are none. Raises Problem for what is no ETag."""
    if request.headers.get("if-none-match", "").strip() == "*":
        return NEW
    given = request.headers.get("if-match")
    if given is None:
        return None
    if given.strip() == "*":
        return ANY
    tags = _TAG.findall(given)
    if not tags or _TAG.sub("", given).strip():
        error = FieldError("If-Match", given, 'expected an ETag as it was answered, such as "12-3"')
        raise refused(f'If-Match is {given!r}; expected an ETag as it was answered, such as "12-3".', error)
    return Expected(revisions=frozenset(tags))


def tagged(response: Response, document: Document) -> None:
    """Say which state of the document the answer is of."""
    response.headers["ETag"] = f'"{document.tag}"'
