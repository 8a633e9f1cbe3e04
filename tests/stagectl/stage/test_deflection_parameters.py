"""What the processor is to do with its lasers, as parameters."""

import numpy as np
import pytest

from stagectl.stage.deflection_parameters import DeflectionLoop, deflection_from, deflection_parameters, refuse_corner
from stagectl.stage.laser_check import LaserLimits
from stagectl.stage.prefilter import Prefilter

LIMITS = LaserLimits(1_000.0, 0.0, 200.0, 0.25)
FILTER = Prefilter(np.array([1.5, -0.5]), 10, 0.2, 0.1, 0.2)


def test_they_come_back_as_they_went() -> None:
    there = deflection_from("xyz", deflection_parameters("xyz", DeflectionLoop(LIMITS, 400.0, (None, FILTER, None))))
    assert (there.limits, there.corner) == (LIMITS, 400.0)
    x, y, z = there.prefilters
    assert x is None
    assert z is None
    assert y is not None
    assert y.spacing == 10
    np.testing.assert_array_equal(y.taps, FILTER.taps)
    assert deflection_from("xyz", deflection_parameters("xyz", DeflectionLoop(LIMITS))) == DeflectionLoop(LIMITS)


def test_a_corner_too_high_for_the_laser_is_refused_with_its_range() -> None:
    with pytest.raises(ValueError, match="corner is 2000 Hz, must be > 0 and <= 400 Hz with a laser of 1000"):
        refuse_corner(2_000.0, 1_000.0)
    parameters = deflection_parameters("xyz", DeflectionLoop(LIMITS, 401.0))
    with pytest.raises(ValueError, match="deflection.corner is 401 Hz"):
        deflection_from("xyz", parameters)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"laser": np.array([0.0, 0.0, 200.0, 0.25])}, "must be rate, late, stuck and speed"),
        ({"laser": np.ones(3)}, "must be rate, late, stuck and speed"),
        ({"y.prefilter": np.array([10.0, 0.5])}, "y.prefilter is no prefilter"),
        ({"y.prefilter": np.array([0.5, 1.0])}, "y.prefilter is no prefilter"),
        ({"q.prefilter": np.array([1.0, 1.0])}, "q.prefilter is unknown"),
        ({"deflection.corner": np.ones(2)}, "has shape"),
    ],
)
def test_numbers_that_cannot_be_are_refused(change: dict[str, np.ndarray], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        deflection_from("xyz", deflection_parameters("xyz", DeflectionLoop(LIMITS, 400.0)) | change)


def test_prefilters_without_a_corner_and_a_corner_without_a_laser_are_refused() -> None:
    with pytest.raises(ValueError, match="deflection.corner is missing"):
        deflection_from("x", {"laser": np.array([1e3, 0.0, 200.0, 0.25]), "x.prefilter": np.array([1.0, 1.0])})
    with pytest.raises(ValueError, match="laser is missing"):
        deflection_from("x", {"deflection.corner": np.array([100.0])})
