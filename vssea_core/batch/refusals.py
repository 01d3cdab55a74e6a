"""Why the variations of a batch make no sense, and which field of its document is to blame."""

from collections.abc import Iterator
from contextlib import contextmanager


class VaryError(ValueError):
    """One sentence about a varied field; `field` is the path in the batch document to blame, such as vary.0.path."""

    def __init__(self, field: str, sentence: str) -> None:
        super().__init__(sentence)
        self.field = field


@contextmanager
def refused_at(place: str) -> Iterator[None]:
    """Raise a ValueError of what is done meanwhile as one of the path at `place`, such as vary.0."""
    try:
        yield
    except ValueError as refusal:
        raise VaryError(f"{place}.path", str(refusal)) from refusal
