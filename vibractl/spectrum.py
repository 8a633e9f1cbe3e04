"""Between time and the frequency bins that are learned: planned real FFTs, and decimation."""

import numpy as np
from scipy.signal import firwin, upfirdn

from vibractl.fft_plans import Plans
from vibractl.fft_transform import Transform

DECIMATOR_REACH = 24
"""Taps of the decimator to each side, times its factor: 100 dB with the transition below."""
DECIMATOR_CORNER = 0.9
"""Of the new Nyquist frequency."""
DECIMATOR_BETA = 10.06
"""Kaiser window for 100 dB."""


class LineSpectrum:
    """Transforms of one length between a frame of time and the lines of a band, planned once.

    The line at f of x is X(f) = 1/rate sum_n x(n) exp(-j 2 pi f n / rate), so that it does not depend on the rate.

    Parameters
    ----------
    frames : int, samples, >= 2
    width : int, channels
    rate : float, samples/s
    band : (float, float), Hz
        First and last frequency of the lines; they lie at multiples of rate / frames.
    plans : Plans
        Of the run.

    Source
    ------
    Sörnmo 2015, eq. (6.4).
    """

    def __init__(self, frames: int, width: int, rate: float, band: tuple[float, float], plans: Plans) -> None:
        spacing = rate / frames
        self._first = int(np.ceil(band[0] / spacing - 1e-9))
        self._end = min(int(np.floor(band[1] / spacing + 1e-9)), (frames - 1) // 2) + 1
        if self._end <= self._first:
            raise ValueError(f"no bin of {spacing:g} Hz spacing lies within {band[0]:g} to {band[1]:g} Hz")
        self.frequency = np.arange(self._first, self._end) * spacing
        self.rate, self.frames, self.width = rate, frames, width
        self._fft = plans.planned(Transform(frames, width))

    def lines(self, signal: np.ndarray) -> np.ndarray:
        """Transform `signal` (frames, width) to its lines (lines, width), in the signal's unit times s."""
        np.copyto(self._fft.time, signal.T)
        self._fft.forward()
        result: np.ndarray = self._fft.bins[:, self._first : self._end].T / self.rate
        return result

    def time(self, lines: np.ndarray, signal: np.ndarray) -> None:
        """Fill `signal` (frames, width) with the real signal that has these lines and no other."""
        self._fft.bins[:, : self._first] = 0.0
        self._fft.bins[:, self._end :] = 0.0
        np.multiply(lines.T, self.rate / self.frames, out=self._fft.bins[:, self._first : self._end])
        self._fft.backward()
        np.copyto(signal, self._fft.time.T)


class Decimator:
    """Keep every `factor`-th sample behind a linear-phase low-pass, its delay compensated.

    Parameters
    ----------
    factor : int, >= 1; 1 passes the signal on

    Source
    ------
    Sörnmo 2015, sec. 6.6: 44.1 kHz downsampled by 4.
    """

    def __init__(self, factor: int) -> None:
        self.factor = factor
        if factor > 1:
            taps = 2 * DECIMATOR_REACH * factor + 1
            self._taps = firwin(taps, DECIMATOR_CORNER / factor, window=("kaiser", DECIMATOR_BETA))

    def apply(self, signal: np.ndarray) -> np.ndarray:
        """Decimate `signal` (frames, width), silent outside, to (ceil(frames / factor), width)."""
        if self.factor == 1:
            return signal
        full = upfirdn(self._taps, signal, 1, self.factor, axis=0)
        kept: np.ndarray = full[DECIMATOR_REACH : DECIMATOR_REACH - (-len(signal) // self.factor)]
        return kept
