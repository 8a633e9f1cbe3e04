"""Gauges and panels."""

import math

import numpy as np
import pytest

from rigkit.service.show import Axis, Curves, Gauge, Image, Trace
from rigkit.service.snapshot import as_bytes


@pytest.mark.parametrize(
    ("value", "low", "high", "verdict"),
    [
        (None, None, 1.0, "unknown"),
        (math.nan, None, 1.0, "unknown"),
        (5.0, None, None, "free"),
        (0.5, None, 1.0, "good"),
        (0.95, None, 1.0, "near"),
        (1.01, None, 1.0, "over"),
        (-0.95, -1.0, 1.0, "near"),
        (-1.01, -1.0, 1.0, "over"),
        (95.5, 90.0, 100.0, "good"),
        (99.6, 90.0, 100.0, "near"),
        (89.0, 90.0, 100.0, "over"),
        (0, None, 0, "good"),
        (1, None, 0, "over"),
    ],
)
def test_a_verdict_comes_from_the_value_and_its_limits(
    value: float | None, low: float | None, high: float | None, verdict: str
) -> None:
    assert Gauge("x", "X", value, "V", low, high).verdict == verdict


def test_panels_become_json_with_gaps_as_null() -> None:
    x = np.arange(3.0)
    trace = Trace("error", x, np.array([1.0, np.nan, 3.0]), low=x, high=x + 1)
    curves = Curves("Convergence", Axis("shot", "1"), Axis("error", "dB"), (trace,))
    assert as_bytes(curves.plain()) == (
        b'{"kind": "curves", "title": "Convergence", "x": {"title": "shot", "unit": "1", "scale": "linear"}, '
        b'"y": {"title": "error", "unit": "dB", "scale": "linear"}, "traces": [{"name": "error", '
        b'"x": [0.0, 1.0, 2.0], "y": [1.0, null, 3.0], "role": "measured", "low": [0.0, 1.0, 2.0], '
        b'"high": [1.0, 2.0, 3.0]}], "drawn": "lines"}'
    )


def test_the_colours_of_an_image_come_to_three_digits() -> None:
    axes = Axis("time", "s"), Axis("frequency", "Hz"), Axis("level", "dB")
    image = Image("Spectrogram", *axes, (0.0, 1.0), (0.0, 2.0), (-80.0, 0.0), np.array([[-12.3456, -1.0]]))
    assert image.plain()["values"].tolist() == [[-12.3, -1.0]]
    assert image.plain()["kind"] == "image"
