"""The states that make errors vanish follow an input that is limited, however little they act on it."""

import numpy as np
import pytest

from stagectl.config import Outer
from stagectl.stage.servo import servo

RATE = 10_000.0


@pytest.mark.parametrize("resonances", [(), (13.0, 24.0)])
@pytest.mark.parametrize("bandwidth", [200.0, 1e-4])
@pytest.mark.parametrize("size", [-30.0, -1e-12, -1e-60, 1e-200])
def test_it_settles_as_fast_whatever_the_size_of_its_gain(
    resonances: tuple[float, ...], bandwidth: float, size: float
) -> None:
    """A drawn stage's loop acted so little that the equation in its own units had no solution."""
    made = servo(Outer(resonances=resonances), bandwidth, RATE)
    shape = (1.0 + 0.3 * np.arange(len(made.A)))[np.newaxis]
    radii = [
        np.abs(np.linalg.eigvals(made.A + made.tracking(each, RATE) @ each)).max() for each in (shape, size * shape)
    ]
    assert radii[1] < 1.0
    assert radii[1] == pytest.approx(radii[0], abs=1e-9)


def test_what_does_not_act_follows_nothing() -> None:
    made = servo(Outer(), 200.0, RATE)
    np.testing.assert_array_equal(made.tracking(np.zeros((1, 1)), RATE), [[0.0]])


def test_an_integral_that_would_take_ages_is_refused_by_its_bandwidth() -> None:
    """A drawn stage's refinement went to 1e-11 Hz, and the run ended in a traceback."""
    with pytest.raises(ValueError, match=r"bandwidth is 1.1e-11 Hz, must be higher at 10000 samples/s"):
        servo(Outer(), 1.1e-11, RATE).tracking(np.array([[-1e-9]]), RATE)
