"""That records are cut where samples are missing, and that it is said."""

import warnings

import numpy as np
import pytest
from scipy.signal import lfilter

from calibration.gaps import ENOUGH, held, without_gaps

DRIVE, RESPONSE = np.arange(40.0).reshape(20, 2), np.arange(20.0)[:, None]


def test_a_record_without_gaps_is_itself() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        drives, responses = without_gaps([DRIVE], [RESPONSE], 3)
    assert drives[0] is DRIVE
    assert responses[0] is RESPONSE


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_what_is_whole_between_gaps_of_either_side_is_used(value: float) -> None:
    drive, response = DRIVE.copy(), RESPONSE.copy()
    drive[4, 1] = response[12] = response[13] = value
    with pytest.warns(UserWarning, match="3 of 20 samples are missing: 17 in 3 stretches are used"):
        drives, responses = without_gaps([drive], [response], 3)
    for (first, last), left, right in zip([(0, 4), (5, 12), (14, 20)], drives, responses, strict=True):
        np.testing.assert_array_equal(left, DRIVE[first:last])
        np.testing.assert_array_equal(right, RESPONSE[first:last])


def test_what_is_too_short_is_left_out() -> None:
    response = RESPONSE.copy()
    response[5] = np.nan
    with pytest.warns(UserWarning, match="1 of 40 samples is missing: 34 in 2 stretches are used"):
        drives, _ = without_gaps([DRIVE, DRIVE], [response, RESPONSE], 6)
    assert [len(drive) for drive in drives] == [14, 20]


def test_nothing_that_is_long_enough_is_refused() -> None:
    response = RESPONSE.copy()
    response[::4] = np.nan
    with pytest.raises(ValueError, match="5 samples are missing, and between them there is no stretch of 4 samples"):
        without_gaps([DRIVE], [response], 4)


@pytest.mark.parametrize(
    ("gaps", "kept"),
    [
        ((100, 104), [795]),  # the first hundred would shorten all horizons
        ((450,), [450, 449]),
        (tuple(range(ENOUGH, 900, ENOUGH + 1)), [ENOUGH] * 5),
        (tuple(range(20, 900, 21)), [20] * 42),
    ],
)
def test_without_a_length_that_is_asked_for_most_is_kept_of_what_is_long(
    gaps: tuple[int, ...], kept: list[int]
) -> None:
    response = np.zeros((900, 1))
    response[list(gaps)] = np.nan
    with pytest.warns(UserWarning, match=r"samples (are|is) missing"):
        drives, _ = without_gaps([np.zeros((900, 1))], [response])
    assert [len(drive) for drive in drives] == kept


def _noisy(samples: int = 400) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(3)
    return rng.standard_normal((samples, 2)), rng.standard_normal((samples, 1))


def test_stretches_in_which_a_logger_stood_still_are_gaps() -> None:
    drive, response = _noisy()
    for first, last in ((0, 5), (100, 103), (250, 260), (396, 400)):  # at the ends it is rest
        drive[first:last], response[first:last] = drive[max(first - 1, 0)], response[max(first - 1, 0)]
    stood = [*range(100, 103), *range(250, 260)]
    assert np.flatnonzero(held(drive, response)).tolist() == stood
    with pytest.warns(UserWarning, match="13 of 400 samples are missing, 13 of them repeated by a logger that stood"):
        drives, _ = without_gaps([drive], [response], 10)
    assert [len(each) for each in drives] == [100, 147, 140]


@pytest.mark.parametrize("pole", [0.0, 0.5, 0.8])
@pytest.mark.parametrize("bits", [0, 8, 12])
def test_signals_that_come_to_rest_are_no_gap(pole: float, bits: int) -> None:
    """Steps, and a burst with rest behind it."""
    steps = np.repeat(np.sign(np.sin(np.arange(8.0) + 1.0)), 200)[:, None]
    burst = np.where(np.arange(2000) < 1500, np.random.default_rng(1).choice([-1.0, 1.0], 2000), 0.0)[:, None]
    for drive in (steps, burst):
        response = lfilter([0.0, 1.0 - pole], [1.0, -pole], drive, axis=0)
        response = np.round(response * 2 ** (bits - 1)) / 2 ** (bits - 1) if bits else response
        assert not held(drive, response).any()


@pytest.mark.parametrize("every", [2, 3, 4])
def test_signals_that_change_every_few_samples_are_taken_as_they_are(every: int) -> None:
    rng = np.random.default_rng(6)
    drive, response = (np.repeat(rng.standard_normal((1000, 1)), every, axis=0) for _ in "ur")
    assert not held(drive, response).any()


def test_coarse_noise_repeats_itself_by_chance() -> None:
    noise = np.round(60 * np.random.default_rng(7).standard_normal((100_000, 1)))
    assert not held(noise[:, :0], noise).any()


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_logger_that_stood_still_before_samples_are_missing_is_found(value: float) -> None:
    drive, response = _noisy()
    drive[100:110], response[100:110] = drive[99], response[99]
    response[110:113] = value
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert np.flatnonzero(held(drive, response)).tolist() == list(range(100, 110))


def test_coarse_signals_that_flicker_at_rest_are_no_gap() -> None:
    rng = np.random.default_rng(5)
    drive = np.repeat(np.sign(np.sin(np.arange(10.0) + 1.0)), 200)[:, None]
    response = np.round(lfilter([0.1], [1.0, -0.9], drive, axis=0) / 0.1 + 0.3 * rng.standard_normal((2000, 1)))
    assert not held(drive, response).any()


def test_one_channel_alone_may_repeat() -> None:
    drive, response = _noisy()
    drive[100:200] = drive[100]
    assert not held(drive, response).any()
