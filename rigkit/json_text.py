"""JSON of figures as programs have them: numpy numbers and arrays, paths, and values that are not finite."""

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np


def json_text(value: Any, *, indent: int | None = None) -> str:
    """Write `value` as JSON on one line, or indented.  JSON has no NaN and no infinity: they become null.

    Parameters
    ----------
    value : any nesting of mappings, lists, tuples, numpy arrays of any shape, numbers, text, paths, None
    indent : int, spaces, or None for one line

    Raises
    ------
    TypeError : something in `value` is of another type.

    Examples
    --------
    >>> json_text({"iae_ratio": np.array([50.5, np.nan]), "shots": np.int64(30)})
    '{"iae_ratio": [50.5, null], "shots": 30}'
    """
    return json.dumps(_plain(value), indent=indent, ensure_ascii=False, allow_nan=False)


def _plain(value: Any) -> Any:
    match value:
        case np.generic() | np.ndarray():
            return _plain(value.tolist())
        case float() if not math.isfinite(value):
            return None
        case Mapping():
            return {str(key): _plain(item) for key, item in value.items()}
        case list() | tuple():
            return [_plain(item) for item in value]
        case Path():
            return str(value)
    return value
