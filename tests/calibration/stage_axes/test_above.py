"""The largest gain above a band, against systems whose response is known."""

import numpy as np
import pytest
from scipy.signal import bilinear, chirp, lfilter

from calibration.stage_axes.above import HeardResponse, heard_response

RATE = 10_000.0
BAND = 200.0, 800.0


def swept(seconds: float = 10.0) -> np.ndarray:
    time = np.arange(round(seconds * RATE)) / RATE
    fade = np.minimum(1.0, np.minimum(time, time[::-1]) / 0.2)
    return fade * chirp(time, 170.0, time[-1], 850.0)


@pytest.mark.parametrize("damping", [0.003, 0.005, 0.03])
@pytest.mark.parametrize("natural", [246.0, 700.0])
def test_a_resonance_that_a_chirp_goes_through_is_seen_at_its_height(natural: float, damping: float) -> None:
    omega = 2 * np.pi * natural
    top, bottom = bilinear([0.01 * omega**2], [1.0, 2 * damping * omega, omega**2], RATE)
    drive = swept()
    noise = 1e-4 * np.random.default_rng(1).standard_normal(len(drive))
    found = heard_response([drive], [lfilter(top, bottom, drive) + noise], RATE, BAND).gain.max()
    assert found == pytest.approx(0.01 / (2 * damping), rel=0.15)


def test_what_rings_below_does_not_count() -> None:
    omega = 2 * np.pi * 100.0
    top, bottom = bilinear([omega**2], [1.0, 0.02 * omega, omega**2], RATE)
    drive = swept()
    found = heard_response([drive], [lfilter(top, bottom, drive)], RATE, BAND)
    assert found.gain.max() == pytest.approx(1 / 3, rel=0.02)


@pytest.mark.parametrize("seed", range(4))
def test_noise_alone_is_nothing_and_an_answer_in_noise_is_one(seed: int) -> None:
    drive = swept()
    noise = np.random.default_rng(seed).standard_normal(len(drive))
    assert heard_response([drive], [noise], RATE, BAND).gain.max() == 0.0
    assert heard_response([drive], [0.2 * drive + 0.1 * noise], RATE, BAND).gain.max() == pytest.approx(0.25, abs=0.05)


def test_a_faint_answer_that_no_cell_shows_is_found_in_several_together() -> None:
    """Two thirds of what is recorded in a cell is noise: by itself it might all be."""
    drive = swept()
    noise = np.random.default_rng(5).standard_normal(len(drive))
    found = heard_response([drive], [0.05 * drive + 0.12 * noise], RATE, BAND)
    assert np.mean(found.gain > 0) > 0.9
    assert np.median(found.gain) == pytest.approx(0.05, rel=0.2)


def test_records_of_several_chirps_are_taken_together_and_keep_their_phase() -> None:
    drives = [swept(10.0), -2.0 * swept(8.0)]
    late = [np.concatenate([np.zeros(5), 0.3 * each[:-5]]) for each in drives]
    found = heard_response(drives, late, RATE, BAND)
    np.testing.assert_allclose(found.gain, 0.3, rtol=0.01)
    np.testing.assert_allclose(
        found.response, 0.3 * np.exp(-2j * np.pi * (found.frequency + 0.5) * 5 / RATE), atol=0.01
    )


def test_a_resonance_counts_as_far_away_as_it_may_be_another_day() -> None:
    frequency = np.arange(200.0, 800.0)
    heard = HeardResponse(frequency, np.where(frequency == 400.0, 3.0, 0.1))
    near = heard.near(np.array([370.0, 385.0, 400.0, 418.0, 430.0]), 0.05)
    assert near.tolist() == [0.1, 3.0, 3.0, 3.0, 0.1]


def test_where_the_chirp_did_not_go_or_heard_noise_the_largest_of_all_counts() -> None:
    """770 Hz: a resonance there may be at 808 another day, and nobody listened."""
    frequency = np.arange(200.0, 800.0)
    heard = HeardResponse(frequency, np.where(np.abs(frequency - 500.0) < 50, 0.0, np.linspace(1.0, 0.2, 600)))
    assert heard.near(np.array([150.0, 770.0, 1200.0, 5000.0, 500.0]), 0.05).tolist() == [1.0] * 5
    assert (heard.near(np.array([250.0, 700.0]), 0.05) < 1.0).all()
