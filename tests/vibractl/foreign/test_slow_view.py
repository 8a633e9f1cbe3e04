"""A recording is looked at slower block by block as it would be as a whole."""

import numpy as np
import pytest
from scipy.signal import chirp

from vibractl.foreign.slow_view import SlowView, slow, slow_factor

RATE = 44_100


@pytest.mark.parametrize("samples", [1, 100, 1_000, 44_115])
@pytest.mark.parametrize("block", [37, 5_000])
def test_blocks_make_no_difference(samples: int, block: int) -> None:
    signal = np.random.default_rng(1).standard_normal((samples, 2))
    view = SlowView(16, 2)
    parts = [view.follow(signal[first : first + block]) for first in range(0, samples, block)]
    whole = np.concatenate((*parts, view.end()))
    assert whole.shape == (-(-samples // 16), 2)
    assert np.allclose(whole, slow(signal, 16), atol=1e-14)


def test_what_lies_far_below_the_lower_rate_stays_as_it_is() -> None:
    signal = np.sin(2 * np.pi * 60.0 * np.arange(RATE) / RATE)[:, None]
    seen = slow(signal, 32)
    assert np.abs(seen - signal[::32])[50:-50].max() < 1e-4


def test_the_rate_goes_by_the_highest_frequency_of_the_reference() -> None:
    time = np.arange(RATE) / RATE
    assert slow_factor(chirp(time, 40, 1, 90)[:, None], RATE) == 32
    assert slow_factor(chirp(time, 40, 1, 600)[:, None], RATE) == 8
    assert slow_factor(np.random.default_rng(2).standard_normal((RATE, 1)), RATE) == 1
