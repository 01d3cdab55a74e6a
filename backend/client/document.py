"""What can be handed over as a document."""

import json
from pathlib import Path
from typing import Any

from backend.client.problem import VsseaError


def document_of(given: Any) -> dict[str, Any]:
    """Return a document as a dict: given as one, as JSON text, as the path of a JSON file, or as a model of vssea_core."""
    if hasattr(given, "model_dump"):
        given = given.model_dump(mode="json")
    if isinstance(given, Path):
        try:
            given = given.read_text("utf-8-sig")
        except (OSError, UnicodeDecodeError) as error:
            raise VsseaError(f"{given} cannot be read: {error}") from error
    if isinstance(given, str):
        try:
            given = json.loads(given)
        except ValueError as error:
            raise VsseaError(f"the document is not JSON: {error}; a file is given as pathlib.Path") from error
    if not isinstance(given, dict):
        raise VsseaError(f"the document is a {type(given).__name__}; expected a dict, JSON text, a Path or a model")
    return given


def text_of(document: Any) -> bytes:
    """Return a document as JSON; numbers and arrays of numpy, and models of vssea_core, may stand anywhere in it."""
    try:
        return json.dumps(document, default=_plain, allow_nan=False).encode()
    except TypeError as error:
        raise VsseaError(f"the document is not JSON: {error}; expected numbers, texts, lists and dicts") from error
    except ValueError as error:
        raise VsseaError(
            f"the document is not JSON: {error}; expected finite numbers, and nothing within itself"
        ) from error


def _plain(value: Any) -> Any:
    if hasattr(value, "model_dump"):
        return value.model_dump(mode="json")
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"it holds a {type(value).__name__}")
