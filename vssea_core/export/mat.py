"""The controller's numbers as a MATLAB file."""

import io
from typing import Any

import numpy as np
import scipy.io

Document = dict[str, Any]
TABLES = ("gains", "observer")
"""Parts whose lists have one entry for each row over the stiffness; in MATLAB that axis comes last."""


def as_mat(numbers: Document) -> bytes:
    """Return `numbers` (export.numbers) as a .mat file (version 5) with one struct, `controller`.

    A list over the stiffness of n rows has that axis last: K is (4, n), A (3, 3, n) or, of one row, (4, 1) and (3, 3).
    """
    file = io.BytesIO()
    held = {"controller": _struct(numbers, rows_last=False)}
    scipy.io.savemat(file, held, oned_as="column")  # type: ignore[arg-type]  # it takes open files too
    return file.getvalue()


def _struct(part: Document, *, rows_last: bool) -> Document:
    return {name: _value(value, rows_last=rows_last or name in TABLES) for name, value in part.items()}


def _value(value: Any, *, rows_last: bool) -> Any:
    if isinstance(value, dict):
        return _struct(value, rows_last=rows_last)
    if isinstance(value, list) and value and isinstance(value[0], str):
        return np.array(value, dtype=object)
    if isinstance(value, list):
        array = np.asarray(value, dtype=float)
        if not rows_last:
            return array
        return np.moveaxis(array, 0, -1)[..., 0] if len(array) == 1 and array.ndim > 1 else np.moveaxis(array, 0, -1)
    if isinstance(value, int) and not isinstance(value, bool):
        return float(value)
    return value
