"""A signal is found in a recording to a part of a sample, with what noise makes of that."""

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline
from scipy.signal import chirp
from scipy.signal.windows import tukey

from vibractl.foreign import search
from vibractl.foreign.search import find
from vibractl.foreign.timing import Timing, timing

RATE = 44_100
TIME = np.arange(2 * RATE) / RATE
SWEEP = (chirp(TIME, 40, 2, 90) * tukey(len(TIME), 0.08))[:, None]


def moved(delay: float, drift: float, samples: int) -> np.ndarray:
    """Return the sweep as a recorder hears it, without noise."""
    index = (np.arange(samples) - delay) / (1 + 1e-6 * drift)
    inside = (index >= 0) & (index <= len(SWEEP) - 1)
    heard = make_interp_spline(np.arange(len(SWEEP)), SWEEP[:, 0], k=5)(np.clip(index, 0, len(SWEEP) - 1))
    return np.where(inside, heard, 0.0)[:, None]


def found(recorded: np.ndarray) -> Timing:
    return timing(SWEEP, recorded, RATE, float(find(SWEEP, [recorded]).first))


@pytest.mark.parametrize(("delay", "drift"), [(0.0, 0.0), (1234.375, 20.0), (777.5, -80.0)])
def test_without_noise_it_is_exact(delay: float, drift: float) -> None:
    shot = found(-3.0 * moved(delay, drift, 3 * RATE))
    assert shot.delay == pytest.approx(delay, abs=1e-4)
    assert shot.drift == pytest.approx(drift, abs=1e-2)
    assert shot.gain[0] == pytest.approx(-3.0, rel=1e-6)
    assert shot.likeness[0] == pytest.approx(1.0, abs=1e-6)


@pytest.mark.slow
def test_its_errors_are_what_it_says_they_are() -> None:
    rng, off = np.random.default_rng(5), []
    clean = moved(500.25, 10.0, 3 * RATE)
    noise = 0.1 * np.sqrt(np.mean(SWEEP**2))
    for _ in range(30):
        shot = found(clean + noise * rng.standard_normal(clean.shape))
        off.append(((shot.delay - 500.25) / shot.delay_error, (shot.drift - 10.0) / shot.drift_error))
    spread = np.sqrt(np.mean(np.square(off), axis=0))
    assert np.all((spread > 0.6) & (spread < 1.6))


def test_a_recording_of_something_else_is_not_like_it() -> None:
    assert find(SWEEP, [np.random.default_rng(2).standard_normal((3 * RATE, 1))]).likeness < 0.1


def test_silence_is_like_nothing() -> None:
    silence = find(SWEEP, [np.zeros((3 * RATE, 1))])
    assert (silence.likeness, silence.is_silent, silence.frames) == (0.0, True, 3 * RATE)


@pytest.mark.parametrize("length", [2 * RATE + 5, 10 * RATE])
@pytest.mark.parametrize("size", [7_001, 10**6])
def test_it_is_found_in_every_stretch_of_a_long_recording(
    length: int, size: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(search, "STRETCH", 4 * RATE)
    rng = np.random.default_rng(3)
    for first in rng.integers(0, length - 2 * RATE, 6).tolist():
        recorded = 0.3 * rng.standard_normal((length, 1))
        recorded[first : first + 2 * RATE] += SWEEP
        told: list[int] = []
        place = find(SWEEP, (recorded[at : at + size] for at in range(0, length, size)), told.append)
        assert (place.first, place.frames, place.is_silent) == (first, length, False)
        assert place.likeness == pytest.approx(
            float(np.corrcoef(recorded[first : first + 2 * RATE].T, SWEEP.T)[0, 1]), abs=0.01
        )
        assert bool(told) == (length > 4 * RATE)


def test_a_recording_shorter_than_it_is_not_searched() -> None:
    assert find(SWEEP, [SWEEP[:-1]]).likeness == 0.0


def test_the_middle_is_where_noise_and_clock_leave_it() -> None:
    shot = found(moved(500.25, 10.0, 3 * RATE))
    assert shot.centre == pytest.approx(500.25 + 10e-6 * (len(SWEEP) - 1) / 2, abs=1e-3)
    assert shot.centre_error < shot.delay_error + 1e-9


def test_another_signal_s_phase_is_told_as_a_misfit_and_noise_is_not() -> None:
    rng = np.random.default_rng(6)
    clean = moved(500.25, 0.0, 3 * RATE)
    noisy = found(clean + 0.1 * np.sqrt(np.mean(SWEEP**2)) * rng.standard_normal(clean.shape))
    assert noisy.centre_misfit < 3 * noisy.centre_error * 8**0.5
    wander = 20.0 * np.sin(2 * np.pi * 1.5 * np.arange(len(clean)) / len(SWEEP))
    spline = make_interp_spline(np.arange(len(clean)), clean[:, 0], k=5)
    swung = found(spline(np.clip(np.arange(len(clean)) - wander, 0, len(clean) - 1))[:, None])
    assert abs(swung.centre - 500.25) < 3 * swung.centre_misfit
    assert swung.centre_misfit > 3.0
