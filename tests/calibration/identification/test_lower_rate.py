"""A rate far above what recordings hold is told, with the factor for `--decimate`."""

import numpy as np
import pytest
from scipy.signal import chirp

from calibration.identification.lower_rate import lower_rate_hint
from ctlblocks.recording import Recording

RATE = 8_000


def recording(*channels: np.ndarray) -> Recording:
    names = tuple(f"c{n}" for n in range(len(channels)))
    return Recording(names, ("1",) * len(channels), RATE, np.stack(channels, axis=1))


def sweep(highest: float, seconds: float = 4.0) -> np.ndarray:
    time = np.arange(round(seconds * RATE)) / RATE
    return chirp(time, 5.0, seconds, highest)


def test_a_sweep_far_below_the_rate_is_told() -> None:
    said = lower_rate_hint([recording(sweep(100.0), sweep(100.0))])
    highest = float(said.split(" lies below ")[1].split(" Hz")[0])
    assert 95 < highest < 125
    assert f"--decimate {int(RATE // (5 * highest))} is" in said


def test_a_response_that_holds_more_than_the_drive_counts() -> None:
    assert "--decimate 5 " in lower_rate_hint([recording(sweep(100.0), sweep(280.0))])


@pytest.mark.parametrize("highest", [600.0, 3_000.0])
def test_nothing_is_said_where_the_rate_is_near(highest: float) -> None:
    assert lower_rate_hint([recording(sweep(highest), sweep(highest))]) == ""


def test_nothing_is_said_of_noise_or_of_a_record_too_short_to_be_thinned() -> None:
    noise = np.random.default_rng(0).standard_normal(RATE)
    assert lower_rate_hint([recording(noise, noise)]) == ""
    short = sweep(100.0)[:500]
    assert lower_rate_hint([recording(short, short)]) == ""
