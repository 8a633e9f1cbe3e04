"""Recordings at a lower rate keep their transfer function, and what is lost is said."""

import numpy as np
import pytest
from scipy.signal import freqz

from calibration.identification.thinning import PASSED, thinned, thinned_recordings, thinning_note
from calibration.subspace import identify
from ctlblocks.recording import Recording
from tests.calibration.identification.plain_scipy import off, response, white
from vibractl.spectrum import DECIMATOR_REACH, Decimator

FAST = 10_000.0


def test_a_tone_keeps_its_size_and_place_and_one_above_half_the_rate_is_gone() -> None:
    time = np.arange(20_000) / FAST
    for factor in (1, 2, 7, 20):
        kept, gone = PASSED * FAST / factor / 2, 1.1 * FAST / factor / 2
        thin = thinned(np.cos(2 * np.pi * kept * time)[:, None], factor)
        skipped = DECIMATOR_REACH * (factor > 1)
        later = np.cos(2 * np.pi * kept * factor * (np.arange(len(thin)) + skipped) / FAST)
        np.testing.assert_allclose(thin[:, 0], later, atol=1e-4)
        if factor > 1:
            assert np.abs(thinned(np.cos(2 * np.pi * gone * time)[:, None], factor)).max() < 2e-5


def test_nothing_left_depends_on_what_was_not_recorded() -> None:
    signal = np.random.default_rng(1).standard_normal((2_000, 1))
    whole, part = thinned(signal, 10), thinned(signal[500:1_500], 10)
    np.testing.assert_allclose(part, whole[50 : 50 + len(part)], atol=1e-12)
    assert len(part) == 100 - 2 * DECIMATOR_REACH


def test_the_low_pass_is_flat_as_far_as_is_said() -> None:
    taps = Decimator(10)._taps  # noqa: SLF001
    size = np.abs(freqz(taps, worN=np.linspace(0, PASSED / 10, 500), fs=2.0)[1])
    assert np.abs(size - 1).max() < 1e-4


@pytest.mark.slow
def test_a_model_of_thinned_recordings_is_that_of_the_plant_and_one_of_every_nth_sample_is_not() -> None:
    factor, frequency = 20, np.linspace(10, PASSED * FAST / 20 / 2, 100)
    drive = white(1, 80_000)
    heard = response(drive, seed=1, rate=FAST)
    errors = []
    for slow in (thinned, lambda signal, every: signal[::every]):
        model = identify(slow(drive, factor), slow(heard, factor), FAST / factor, order=8).model
        errors.append(off(model.frequency_response(frequency), frequency, FAST))
    assert errors[0] < 0.05
    assert errors[1] > 0.5


def test_the_models_rate_is_the_lower_one_and_its_words_say_so() -> None:
    fast = Recording(("u", "y"), ("V", "m"), FAST, np.zeros((4_000, 2)), {"rig": "bench"})
    (thin,) = thinned_recordings([fast], ["a.csv"], 20)
    assert thin.rate == 500.0
    assert len(thin.data) == 200 - 2 * DECIMATOR_REACH
    assert thin.provenance == {"rig": "bench", "decimated": "20", "recorded_rate": "10000"}
    assert thinned_recordings([fast], ["a.csv"], 1) == [fast]
    assert thinning_note(500.0, 20, 1) == (
        "decimated by 20 to 500 samples/s: 480 samples at either end of the recording are left out, and the model "
        "holds up to 187.5 Hz"
    )


@pytest.mark.parametrize(
    ("factor", "samples", "complaint"),
    [
        (0, 4_000, "--decimate is 0, must be a whole number >= 1"),
        (-3, 4_000, "--decimate is -3, must be"),
        (40, 4_000, "--decimate is 40: 52 of the 4000 samples of a.csv would be left, .*: --decimate 27 at most"),
        (10, 200, "--decimate is 10: a.csv has 200 samples, too few to be decimated"),
    ],
)  # fmt: skip
def test_a_factor_that_leaves_too_little_is_refused(factor: int, samples: int, complaint: str) -> None:
    fast = Recording(("u", "y"), ("V", "m"), FAST, np.zeros((samples, 2)))
    with pytest.raises(ValueError, match=complaint):
        thinned_recordings([fast], ["a.csv"], factor)


def test_the_largest_factor_that_is_named_is_allowed() -> None:
    fast = Recording(("u", "y"), ("V", "m"), FAST, np.zeros((4_000, 2)))
    assert len(thinned_recordings([fast], ["a.csv"], 27)[0].data) >= 100
    with pytest.raises(ValueError, match="would be left"):
        thinned_recordings([fast], ["a.csv"], 28)
