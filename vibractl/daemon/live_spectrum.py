"""The spectrum of what is heard now, while a shot is played."""

from collections.abc import Callable
from typing import Self

import numpy as np
from scipy.signal.windows import blackmanharris

from rigkit.service.regularly import Regularly
from rigkit.service.rig import Desk
from rigkit.service.show import Axis, Curves, Trace
from vibractl.audio import Line
from vibractl.config import RigConfig
from vibractl.decibels import decibels

SECONDS = 0.5
"""Of sound in one spectrum: lines 2 Hz apart."""
PERIOD = 0.5
"""s from one spectrum to the next."""
DEEPEST = -100.0
"""dB; what lies deeper is drawn there."""


class LiveSpectrum:
    """Shows it on a desk twice a second, from a thread of its own, for the length of a `with` block.

    It reads the memory that the audio callback writes, and takes nothing of the callback's time.

    Parameters
    ----------
    desk : Desk
    config : RigConfig
    line : callable() -> Line or None
        The audio line, while it is open.
    """

    def __init__(self, desk: Desk, config: RigConfig, line: Callable[[], Line | None]) -> None:
        self._desk, self._config, self._line = desk, config, line
        self._regularly = Regularly(self._show, PERIOD)

    def __enter__(self) -> Self:
        """Begin, with nothing heard yet."""
        sides = len(self._config.audio.response_channels)
        self._desk.show("live", live_panel(np.zeros((0, sides)), self._config))
        self._regularly.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        """End."""
        self._regularly.__exit__()

    def _show(self) -> None:
        line = self._line()
        if line is None:
            return
        emitted, response = line.lately(SECONDS)
        is_sound = len(response) and np.isfinite(response).all()  # else the shot is discarded, and it is said
        if is_sound and np.abs(emitted[: len(emitted) // 2]).max() > 0:
            self._desk.show("live", live_panel(response, self._config))


def live_panel(response: np.ndarray, config: RigConfig) -> Curves:
    """Draw the spectra of what each side does, against the limit of a whole shot's errors.

    Parameters
    ----------
    response : array, shape (samples, sides), m/s^2
        May be empty: then there are no lines.
    config : RigConfig
    """
    frequency, level = spectrum(response, config.audio.rate)
    shown, quality = frequency <= config.quality.judged_to, config.quality
    traces = [
        Trace(f"response {side}", frequency[shown], column[shown]) for side, column in enumerate(level.T, start=1)
    ]
    ends = np.array([quality.above, quality.judged_to])
    limit = Trace("objective", ends, np.full(2, quality.objective), "limit")
    axes = Axis("frequency", "Hz"), Axis("level re the strongest bin", "dB")
    return Curves(f"Spectrum of the last {SECONDS:g} s", *axes, (*traces, limit))


def spectrum(signal: np.ndarray, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the lines of a signal, relative to its strongest.

    Parameters
    ----------
    signal : array, shape (samples, channels), any unit
    rate : float, samples/s

    Returns
    -------
    frequency : array, shape (lines,), Hz
    level : array, shape (lines, channels), dB, at least `DEEPEST`
    """
    if not len(signal):
        return np.zeros(0), np.zeros(signal.shape)
    size = np.abs(np.fft.rfft(signal * blackmanharris(len(signal))[:, None], axis=0))
    relative = size / np.maximum(size.max(axis=0), np.finfo(float).tiny)
    return np.fft.rfftfreq(len(signal), 1 / rate), np.maximum(decibels(relative), DEEPEST)
