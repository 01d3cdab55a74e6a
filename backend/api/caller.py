"""Who calls: the page that says so, else REST. It is for the log; what may be done does not depend on it."""

import re
from typing import Annotated

from fastapi import Depends, Request

BY = "REST"
HEADER = "X-VSSEA-Page"
PAGE = re.compile(r"page \d{1,9}")


def by_of(request: Request) -> str:
    """Return the name that the live websocket gave the calling page, `REST` for everybody else."""
    named = request.headers.get(HEADER, "")
    return named if PAGE.fullmatch(named) else BY


By = Annotated[str, Depends(by_of)]
