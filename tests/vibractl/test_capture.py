"""A recording with a bad sample is named with the channel and the time."""

import numpy as np
import pytest

from vibractl.capture import Capture, spoiled


def capture(response: np.ndarray, loopback: np.ndarray | None = None, xruns: tuple[int, int] = (0, 0)) -> Capture:
    silent = np.zeros(len(response), np.float32)
    return Capture(
        np.zeros_like(response), response, silent if loopback is None else loopback, 573.0, 0.0, 1.0, *xruns, 0
    )


def test_a_good_recording_up_to_just_below_full_scale_is_fine() -> None:
    response = np.full((100, 2), 399.9, np.float32)
    assert spoiled(capture(response), 400.0, 1000.0) == ""


@pytest.mark.parametrize("level", [400.0, -400.0, 400.0 * 32767 / 32768])
def test_clipping_is_found_at_either_end_of_sixteen_bits_too(level: float) -> None:
    response = np.zeros((100, 2), np.float32)
    response[50:53, 1] = level
    assert spoiled(capture(response), 400.0, 1000.0) == "clipped at full scale, response 2 at 0.0500 s, and 2 more"


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_sample_that_is_not_finite_is_found_in_any_channel(value: float) -> None:
    loopback = np.zeros(100, np.float32)
    loopback[7] = value
    text = spoiled(capture(np.zeros((100, 2), np.float32), loopback), 400.0, 1000.0)
    assert text == "a sample that is not finite, loopback at 0.0070 s, and 0 more"


def test_xruns_are_told_first() -> None:
    response = np.full((100, 2), np.nan, np.float32)
    assert spoiled(capture(response, xruns=(2, 0)), 400.0, 1000.0).startswith("xruns: 2 callbacks with lost input, 0")
