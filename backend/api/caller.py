"""Who calls: the page that says so, else REST. It is for the log; what may be done on a rig depends on the key alone."""

import re
from typing import Annotated

from fastapi import Depends, Request

BY = "REST"
HEADER = "X-VSSEA-Page"
KEY_HEADER = "X-VSSEA-Lease"
PAGE = re.compile(r"page \d{1,9}")


def by_of(request: Request) -> str:
    """Return the name that the live websocket gave the calling page, `REST` for everybody else."""
    named = request.headers.get(HEADER, "")
    return named if PAGE.fullmatch(named) else BY


def key_of(request: Request) -> str | None:
    """Return the key that proves control of the rig, as `take_control` answered it; None without one."""
    return request.headers.get(KEY_HEADER) or None


By = Annotated[str, Depends(by_of)]
Key = Annotated[str | None, Depends(key_of)]
