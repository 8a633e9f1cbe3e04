"""What died away becomes zero before it is subnormal; everything else, and what is no number, stays as it is."""

from collections.abc import Callable

import numpy as np
import pytest
from numba import njit

from firmware_sim.plants import flush_kernel as simulated
from rigkit import flush_kernel
from rigkit.flush_kernel import LEAST

BOTH = pytest.mark.parametrize("flushed", [flush_kernel.flushed, simulated.flushed], ids=["rigkit", "firmware_sim"])


@BOTH
def test_only_what_is_smaller_than_the_least_becomes_zero(flushed: Callable[[float], float]) -> None:
    for stays in (0.0, LEAST, -LEAST, 1.0, -1e300, np.inf, -np.inf):
        assert flushed(stays) == stays
    for goes in (np.nextafter(LEAST, 0.0), -np.nextafter(LEAST, 0.0), 5e-324, -1e-200):
        assert flushed(goes) == 0.0
    assert np.isnan(flushed(np.nan))


def test_a_product_of_two_that_stay_is_no_subnormal_number() -> None:
    assert LEAST * LEAST > np.finfo(float).tiny
    assert simulated.LEAST == LEAST


@BOTH
def test_a_compiled_decay_ends_at_zero_where_it_would_have_stuck(flushed: Callable[[float], float]) -> None:
    @njit
    def decayed(pole: float, samples: int, last: Callable[[float], float]) -> float:
        value = 1.0
        for _ in range(samples):
            value = last(pole * value)
        return value

    @njit
    def as_it_is(value: float) -> float:
        return value

    assert 0.0 < decayed(0.9, 50_000, as_it_is) < np.finfo(float).tiny
    assert decayed(0.9, 50_000, flushed) == 0.0
