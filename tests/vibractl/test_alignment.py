"""The round trip is found to thousandths of a sample, and a recording that cannot tell says so."""

import math

import numpy as np
import pytest

from vibractl.alignment import (
    LOOPBACK_BAND,
    MARKER_BAND,
    delay,
    deviations,
    timing_signal,
    timing_train,
    train_deviations,
)

RATE = 44_100.0
BANDS = [LOOPBACK_BAND, MARKER_BAND]
Band = tuple[float, float]


def shifted(signal: np.ndarray, samples: float, length: int) -> np.ndarray:
    """Return a signal later by a fraction, exactly, as a band-limited converter would give it."""
    points = 2 * length
    turn = np.exp(-2j * np.pi * np.fft.rfftfreq(points) * samples)
    return np.fft.irfft(np.fft.rfft(signal, points) * turn, points)[:length]


def noise(length: int, decibel: float, seed: int = 1) -> np.ndarray:
    """Return white noise, rms in dB of the chirp's amplitude 1."""
    return 10 ** (decibel / 20) * np.random.default_rng(seed).standard_normal(length)


@pytest.mark.parametrize("band", BANDS)
@pytest.mark.parametrize("rate", [44_100.0, 48_000.0, 96_000.0, 192_000.0])
def test_the_timing_signal_is_about_twenty_milliseconds_and_starts_and_ends_at_rest(band: Band, rate: float) -> None:
    chirp = timing_signal(rate, band, 0.5)
    assert 0.017 < len(chirp) / rate < 0.033
    assert np.log2(len(chirp)) % 1 == 0
    assert 0.49 < np.abs(chirp).max() <= 0.5
    assert np.abs(chirp[[0, -1]]).max() < 0.5e-3
    power = np.abs(np.fft.rfft(chirp)) ** 2
    frequency = np.fft.rfftfreq(len(chirp), 1 / rate)
    inside = (frequency >= band[0] - 200) & (frequency <= band[1] + 200)
    assert power[inside].sum() > 0.999 * power.sum()


def test_a_band_beyond_half_the_rate_is_refused() -> None:
    with pytest.raises(ValueError, match="the timing band is 1000 to 8000 Hz, must rise within 0 to 4000 Hz"):
        timing_signal(8000.0, LOOPBACK_BAND, 1.0)


@pytest.mark.parametrize("band", BANDS)
@pytest.mark.parametrize(("decibel", "allowed"), [(-300, 1e-8), (-60, 1e-3), (-40, 0.01), (-20, 0.1)])
def test_any_fraction_of_a_sample_is_found(band: Band, decibel: float, allowed: float) -> None:
    chirp = timing_signal(RATE, band, 1.0)
    rng = np.random.default_rng(2)
    for seed in range(100):
        late = rng.uniform(0.0, 3000.0) if seed else 1500.5
        recorded = 0.3 * (shifted(chirp, late, 6000) + noise(6000, decibel, seed))
        found = delay(chirp, recorded, RATE, band)
        assert abs(found.samples - late) < allowed
        assert found.quality > 0.98


def test_hum_and_the_vibrators_own_motion_do_not_disturb_a_marker() -> None:
    chirp = timing_signal(RATE, MARKER_BAND, 0.01)
    time = np.arange(6000) / RATE
    motion = 0.3 * np.sin(2 * np.pi * 50 * time) + 0.2 * np.sin(2 * np.pi * 76 * time)
    window = np.hanning(6000)
    found = delay(chirp, shifted(chirp, 2500.4, 6000) + window * motion, RATE, MARKER_BAND)
    assert abs(found.samples - 2500.4) < 0.3
    assert abs(delay(chirp, shifted(chirp, 2500.4, 6000), RATE, MARKER_BAND).samples - 2500.4) < 1e-6


def spoilt(chirp: np.ndarray) -> dict[str, np.ndarray]:
    """Return recordings that tell nothing, by what was done to them."""
    good = shifted(chirp, 777.3, 6000)
    middle = 777 + len(chirp) // 2
    cut, bad = good.copy(), good.copy()
    cut[middle:] = 0.0
    bad[middle] = math.nan
    return {
        "silent": np.zeros(6000),
        "noise": noise(6000, 0),
        "inverted": -good,
        "truncated": cut,
        "slipped": np.concatenate((good[:middle], np.zeros(2), good[middle:-2])),
        "samples lost": np.concatenate((good[:middle], good[middle + 2 :])),
        "saturated": np.clip(good, -0.5, 0.5),
        "not finite": bad,
    }


@pytest.mark.parametrize("band", BANDS)
@pytest.mark.parametrize("what", list(spoilt(np.ones(4))))
def test_the_quality_says_when_a_recording_cannot_be_trusted(band: Band, what: str) -> None:
    chirp = timing_signal(RATE, band, 1.0)
    assert delay(chirp, spoilt(chirp)[what], RATE, band).quality < 0.98
    assert delay(chirp, shifted(chirp, 777.3, 6000), RATE, band).quality > 0.999999


@pytest.mark.parametrize("what", ["silent", "not finite"])
def test_a_delay_of_nothing_is_nan(what: str) -> None:
    chirp = timing_signal(RATE, LOOPBACK_BAND, 1.0)
    found = delay(chirp, spoilt(chirp)[what], RATE, LOOPBACK_BAND)
    assert math.isnan(found.samples)
    assert found.quality == 0.0


def test_a_recording_shorter_than_the_signal_is_refused() -> None:
    with pytest.raises(ValueError, match="the recording is 1023 samples long, must be >= 1024"):
        delay(timing_signal(RATE, LOOPBACK_BAND, 1.0), np.zeros(1023), RATE, LOOPBACK_BAND)


def test_every_chirp_of_a_train_gives_the_delay() -> None:
    chirp = timing_signal(RATE, LOOPBACK_BAND, 0.1)
    train = timing_train(chirp, 40)
    recorded = shifted(train, 573.37, len(train) + 573) + noise(len(train) + 573, -80)
    deviation, quality = train_deviations(chirp, recorded, 573, RATE, LOOPBACK_BAND)
    assert len(deviation) == 40
    assert np.abs(deviation - 0.37).max() < 0.005
    assert quality.min() > 0.9999


@pytest.mark.parametrize("samples", [1, 64, 1024, 4096])
def test_a_slip_in_mid_train_shows_even_by_whole_chirps(samples: int) -> None:
    chirp = timing_signal(RATE, LOOPBACK_BAND, 0.1)
    recorded = timing_train(chirp, 40)
    slipped = np.concatenate((recorded[:20_000], np.zeros(samples), recorded[20_000:-samples]))
    deviation, quality = train_deviations(chirp, slipped, 0, RATE, LOOPBACK_BAND)
    wrong = (np.abs(deviation) > 0.25) | (quality < 0.995)
    assert not wrong[: 20_000 // 1024].any()
    assert wrong[20_000 // 1024 + 1 :].any()
    assert quality.min() < 0.995


def test_a_train_tells_its_chirps_apart() -> None:
    signs = timing_train(np.ones(1), 64)
    overlaps = [abs(signs[lag:] @ signs[:-lag]) / (64 - lag) for lag in range(1, 33)]
    assert max(overlaps) < 0.6


def test_a_lost_block_of_sixteen_samples_shows_anywhere_in_a_train() -> None:
    chirp = timing_signal(RATE, LOOPBACK_BAND, 0.1)
    for start in range(0, 1024, 16):
        recorded = timing_train(chirp, 3)
        recorded[1024 + start : 1024 + start + 16] = 0.0
        energy = np.sum(chirp[start : start + 16] ** 2) / np.sum(chirp**2)
        _, quality = train_deviations(chirp, recorded, 0, RATE, LOOPBACK_BAND)
        assert (quality[1] < 0.995) == (energy > 0.00999) or abs(energy - 0.01) < 2e-3


def test_many_recordings_are_measured_at_once_the_bad_ones_as_nan() -> None:
    chirp = timing_signal(RATE, LOOPBACK_BAND, 1.0)
    rows = np.stack([shifted(chirp, 0.2, 1024), np.zeros(1024), np.full(1024, np.nan), shifted(chirp, -0.4, 1024)])
    deviation, quality = deviations(chirp, rows, RATE, LOOPBACK_BAND)
    np.testing.assert_allclose(deviation, [0.2, np.nan, np.nan, -0.4], atol=1e-3)
    assert (quality > 0.999).tolist() == [True, False, False, True]
