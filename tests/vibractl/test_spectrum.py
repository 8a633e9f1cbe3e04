"""The lines and the decimator."""

import numpy as np
import pytest

from vibractl.fft_plans import Plans
from vibractl.spectrum import Decimator, LineSpectrum

RATE = 44_100.0


def test_lines_are_the_dft_over_the_rate() -> None:
    signal = np.random.default_rng(1).standard_normal((8_820, 2))
    spectrum = LineSpectrum(8_820, 2, RATE, (15.0, 650.0), Plans())
    bins = np.fft.rfft(signal, axis=0) / RATE
    np.testing.assert_allclose(spectrum.frequency, np.arange(15, 651, 5))
    np.testing.assert_allclose(spectrum.lines(signal), bins[3:131], atol=1e-15)


def test_time_brings_back_what_lies_in_the_band_and_nothing_else() -> None:
    time = np.arange(8_820) / RATE
    inside, outside = np.sin(2 * np.pi * 100 * time), np.sin(2 * np.pi * 1_000 * time)
    spectrum = LineSpectrum(8_820, 1, RATE, (15.0, 650.0), Plans())
    back = np.empty((8_820, 1))
    spectrum.time(spectrum.lines((inside + outside)[:, None]), back)
    np.testing.assert_allclose(back[:, 0], inside, atol=1e-12)


def test_a_band_without_a_line_is_refused() -> None:
    with pytest.raises(ValueError, match="no bin of 441 Hz spacing lies within 10 to 20 Hz"):
        LineSpectrum(100, 1, RATE, (10.0, 20.0), Plans())


def test_decimation_keeps_amplitude_and_phase_of_the_learned_band() -> None:
    time = np.arange(44_100) / RATE
    kept = Decimator(4).apply(np.stack([np.sin(2 * np.pi * f * time) for f in (15, 650)], axis=1))
    quarter = time[::4]
    for column, f in enumerate((15, 650)):
        np.testing.assert_allclose(kept[100:-100, column], np.sin(2 * np.pi * f * quarter)[100:-100], atol=2e-5)


def test_decimation_suppresses_what_would_fold_into_the_learned_band() -> None:
    time = np.arange(44_100) / RATE
    kept = Decimator(4).apply(np.sin(2 * np.pi * (11_025 - 300) * time)[:, None])
    assert np.abs(kept[100:-100]).max() < 1e-4


def test_full_rate_passes_unchanged() -> None:
    signal = np.ones((7, 2))
    assert Decimator(1).apply(signal) is signal
