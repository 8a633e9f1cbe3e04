"""JSON of figures as programs have them."""

import json
from pathlib import Path

import numpy as np
import pytest

from rigkit.json_text import json_text


def test_numpy_and_paths_are_written_plainly() -> None:
    figures = {
        "a": np.float64(0.1),
        "b": np.int64(3),
        "c": np.array([[1, 2]]),
        "d": Path("x/y"),
        "e": (np.bool_(True),),
    }
    assert json.loads(json_text(figures)) == {"a": 0.1, "b": 3, "c": [[1, 2]], "d": "x/y", "e": [True]}


def test_what_is_not_finite_becomes_null_at_any_depth() -> None:
    text = json_text({"a": float("nan"), "b": [np.inf, {"c": np.array([-np.inf, 1.0])}]})
    assert json.loads(text) == {"a": None, "b": [None, {"c": [None, 1.0]}]}


def test_a_float_keeps_its_last_bit() -> None:
    assert json.loads(json_text({"a": 0.1 + 0.2}))["a"] == 0.1 + 0.2


def test_what_json_cannot_hold_is_refused() -> None:
    with pytest.raises(TypeError):
        json_text({"a": {1, 2}})
