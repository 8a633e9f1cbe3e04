"""Two devices have two clocks: that is found, refused or taken out, and where it does not show that is said."""

import tracemalloc
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline

from calibration.from_recordings import Found, FromRecordingsError, matrix_from
from calibration.from_report import notes
from calibration.recorded_clock import _is_at_several, lag
from calibration.recorded_signals import Recorded
from rigkit.foreign_stream import Signals
from tests.calibration.recorded_lab import BAND, alone, heard, multisine, noise, recorded, sweep, truth
from tests.vibractl.linear_rig import RATE, linear_config

WORDS = {"rig": "simulated-vibrator"}


def by_another_clock(signal: np.ndarray, ppm: float) -> np.ndarray:
    """Return a signal as a recorder hears it whose clock is so much faster."""
    index = np.arange(len(signal))
    return np.asarray(make_interp_spline(index, signal, k=5)(np.clip(index / (1 + 1e-6 * ppm), 0, len(signal) - 1)))


def found_from(drive: np.ndarray, ppm: float, correct_clock: bool) -> Found:
    response = by_another_clock(heard(drive, 0.0), ppm)
    response = response + 0.3 * np.random.default_rng(3).standard_normal(response.shape)
    return matrix_from([recorded(drive, response)], linear_config(*BAND), WORDS, correct_clock)


def relative(found: Found) -> float:
    there = truth(found.matrix.frequency)
    off = np.linalg.norm(found.matrix.response - there, axis=(1, 2)) / np.linalg.norm(there, axis=(1, 2))
    return float(np.median(off))


LATE = 1e-4
"""s, of half the lines, from one level to the next: as a resonance that the level moves."""

UP_AND_DOWN = np.concatenate(
    [alone(each, side) for each in (sweep(seconds=3.0), sweep(seconds=3.0)[::-1]) for side in (0, 1)]
)


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("drive", "ppm"),
    [(noise(1, 12.0), 20.0), (noise(2), -150.0), (UP_AND_DOWN, 20.0), (multisine(1, periods=4), 20.0)],
    ids=["noise", "a bad clock", "sweeps up and down", "multisine"],
)
def test_a_clock_that_differs_is_refused_or_taken_out(drive: np.ndarray, ppm: float) -> None:
    with pytest.raises(FromRecordingsError, match=r"a.wav: the recorder's clock is -?\d+\.\d\d ppm .*--correct-clock"):
        found_from(drive, ppm, False)
    found = found_from(drive, ppm, True)
    told = found.records[0]
    assert told.is_corrected
    assert abs(1e6 * told.drift.value - ppm) < 4e6 * told.drift.error + 0.02
    assert relative(found) < 0.01


@pytest.mark.sample(1)
@pytest.mark.parametrize("most", [64, 4])
@pytest.mark.slow
def test_sweeps_that_lie_elsewhere_in_their_blocks_show_their_clock_as_well(
    monkeypatch: pytest.MonkeyPatch, most: int
) -> None:
    """Coil after coil, at three levels: a pass shows less than half of what is left of the clock."""
    monkeypatch.setattr("calibration.recorded_blocks.MOST", most)
    monkeypatch.setattr("calibration.recorded_signals.BLOCK", 5.0)
    drive = np.concatenate([level * alone(sweep(seconds=2.0), side) for side in (0, 1) for level in (0.5, 1.0, 2.0)])
    response = by_another_clock(heard(drive, 0.0), 20.0)
    (told,) = matrix_from([recorded(drive, response)], linear_config(*BAND), WORDS, True).records
    assert abs(1e6 * told.drift.value - 20.0) < 0.05


@pytest.mark.parametrize(("weaker", "shows"), [(0.1, True), (0.05, True), (1e-4, False)])
def test_a_clock_shows_where_one_of_three_times_tells_far_more_but_not_in_what_leaks(
    weaker: float, shows: bool
) -> None:
    """A vibrator that distorts is heard clearly at one level alone; a single sweep leaks into the other times."""
    share = np.array([weaker, weaker, 1.0])[:, None, None, None] * np.ones((3, 20, 1, 1))
    assert _is_at_several(share, np.array([5.0, 20.0, 35.0])) is shows


def test_what_one_clock_has_recorded_is_not_stretched() -> None:
    assert not found_from(noise(1, 12.0), 0.0, True).records[0].is_corrected


def test_a_single_sweep_does_not_show_a_clock_and_that_is_said() -> None:
    found = found_from(np.concatenate([alone(sweep(), 0), alone(sweep(), 1)]), 20.0, False)
    assert not np.isfinite(found.records[0].drift.error)
    assert any("whether player and recorder have one clock is not shown" in note for note in notes(found))


def test_a_lag_is_where_the_response_begins() -> None:
    drive = np.random.default_rng(1).standard_normal((20_000, 2))
    ringing = np.exp(-np.arange(200) / 50.0) * np.sin(0.3 * np.arange(200))
    response = np.stack([np.convolve(side, ringing)[:20_000] for side in drive.T], axis=1)
    for late in (0, 37, -500):
        assert abs(lag(drive, np.roll(response, late, axis=0), 100) - late) <= 4  # type: ignore[operator]
    assert lag(drive, np.random.default_rng(2).standard_normal((20_000, 2)), 100) is None


def test_of_two_sweeps_alike_a_response_belongs_to_its_own() -> None:
    """Coil after coil: the second's response lies beside the first's drive as well as beside its own."""
    one = sweep(seconds=1.0)
    drive = np.concatenate([1.2 * alone(one, 0), alone(one, 1)])
    response = np.concatenate([0.01 * one, one])[:, None]
    assert abs(lag(drive, response, 2_000)) < 200  # type: ignore[arg-type]


def test_a_resonance_that_moves_with_the_level_is_no_clock() -> None:
    """Of sweeps at two levels, the louder one's lower half comes late; a clock would delay the upper one alike."""
    one = alone(sweep(seconds=3.0), 0) + alone(sweep(seconds=3.0)[::-1], 1)
    soft, loud = heard(one, 0.0), 2.0 * heard(one, 0.0)
    lines, frequency = np.fft.rfft(loud, axis=0), np.fft.rfftfreq(len(loud), 1 / RATE)
    lines[frequency < 70.0] *= np.exp(-2j * np.pi * frequency[frequency < 70.0] * LATE)[:, None]
    response = np.concatenate([soft, np.fft.irfft(lines, len(loud), axis=0)])
    response += 0.01 * np.random.default_rng(3).standard_normal(response.shape)
    record = recorded(np.concatenate([one, 2.0 * one]), response)
    (told,) = matrix_from([record], linear_config(*BAND), WORDS, False).records
    assert not told.is_corrected


@pytest.mark.slow
def test_a_long_recording_takes_no_more_memory() -> None:
    rate, seconds, kernel = 8_000, 240, np.array([1.0, 0.5, -0.3])

    def played() -> Iterator[np.ndarray]:
        rng = np.random.default_rng(1)
        return (rng.standard_normal((rate, 2)) for _ in range(seconds))

    def answered() -> Iterator[np.ndarray]:
        before = np.zeros((2, 2))
        for drive in played():
            whole = np.concatenate((before, drive))
            yield kernel[0] * drive + kernel[1] * whole[1:-1] + kernel[2] * whole[:-2]
            before = drive[-2:]

    def stream(name: str, unit: str, source: object) -> Signals:
        return Signals(Path(name), ("a", "b"), (unit,) * 2, float(rate), rate * seconds, source, (0, 1))  # type: ignore[arg-type]

    record = Recorded(stream("d", "V", played), stream("r", "m/s^2", answered))
    config = linear_config("characterisation.band=[30, 60]", f"audio.rate={rate}")
    tracemalloc.start()
    found = matrix_from([record], config, WORDS)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 45e6
    turn = np.exp(-2j * np.pi * found.matrix.frequency / rate)
    truly = np.polynomial.polynomial.polyval(turn, kernel)
    assert np.allclose(found.matrix.response, truly[:, None, None] * np.eye(2), atol=0.01)
