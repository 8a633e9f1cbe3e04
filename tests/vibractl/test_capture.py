"""A recording with a bad sample is named with the channel and the time."""

import numpy as np
import pytest

from vibractl.capture import Capture, spoiled
from vibractl.config import Audio

AUDIO = Audio(rate=8_000)


def capture(
    response: np.ndarray,
    loopback: np.ndarray | None = None,
    xruns: tuple[int, int] = (0, 0),
    far_field: np.ndarray | None = None,
) -> Capture:
    silent = np.zeros(len(response), np.float32)
    heard = np.zeros((len(response), 0), np.float32) if far_field is None else far_field
    timing = silent if loopback is None else loopback
    return Capture(np.zeros_like(response), response, heard, timing, 573.0, 0.0, 1.0, *xruns, 0)


def test_a_good_recording_up_to_just_below_full_scale_is_fine() -> None:
    response = np.full((100, 2), 399.9, np.float32)
    assert spoiled(capture(response), AUDIO) == ""


@pytest.mark.parametrize("level", [400.0, -400.0, 400.0 * 32767 / 32768])
def test_clipping_is_found_at_either_end_of_sixteen_bits_too(level: float) -> None:
    response = np.zeros((100, 2), np.float32)
    response[50:53, 1] = level
    assert spoiled(capture(response), AUDIO) == "clipped at full scale, response 2 at 0.0063 s, and 2 more"


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_sample_that_is_not_finite_is_found_in_any_channel(value: float) -> None:
    loopback = np.zeros(100, np.float32)
    loopback[7] = value
    text = spoiled(capture(np.zeros((100, 2), np.float32), loopback), AUDIO)
    assert text == "a sample that is not finite, loopback at 0.0009 s, and 0 more"


def test_xruns_are_told_first() -> None:
    response = np.full((100, 2), np.nan, np.float32)
    assert spoiled(capture(response, xruns=(2, 0)), AUDIO).startswith("xruns: 2 callbacks with lost input, 0")


def test_a_hydrophone_that_clips_is_named_and_measured_against_its_own_full_scale() -> None:
    response, far_field = np.zeros((100, 2), np.float32), np.full((100, 2), 199.9, np.float32)
    assert spoiled(capture(response, far_field=far_field), AUDIO) == ""
    far_field[16, 1] = 200.0
    assert spoiled(capture(response, far_field=far_field), AUDIO) == (
        "clipped at full scale, far field 2 at 0.0020 s, and 0 more"
    )


def test_an_accelerometer_that_goes_no_further_is_named_though_the_converter_would() -> None:
    time = np.arange(16_000) / AUDIO.rate
    response = np.stack([10 * np.sin(2 * np.pi * 30 * time), 9 * np.sin(2 * np.pi * 40 * time)], axis=1)
    response += 0.01 * np.random.default_rng(1).standard_normal(response.shape)
    assert spoiled(capture(response.astype(np.float32)), AUDIO) == ""
    response[:, 1] = np.minimum(response[:, 1], 8.0)
    text = spoiled(capture(response.astype(np.float32)), AUDIO)
    assert text == "clipped below full scale, response 2 does not pass 8 m/s^2 at 80 peaks"
