"""A real FFT and its inverse, planned by FFTW or made by SciPy: which of them a run goes by, and what is installed."""

from typing import Any, Literal, NamedTuple, Protocol

import numpy as np
import scipy.fft

from vibractl.spectrum_config import Backend

try:
    import pyfftw
except ImportError:  # under the GPL, so that not everybody may pass it on
    pyfftw = None

Effort = Literal["FFTW_ESTIMATE", "FFTW_MEASURE"]
Library = Literal["fftw", "scipy"]


class Transform(NamedTuple):
    """The size of a real FFT and its inverse.

    Parameters
    ----------
    frames : int, samples, >= 2
    width : int, channels, >= 1
    """

    frames: int
    width: int


class Planned(Protocol):
    """A transform and its inverse, each of which may destroy its input."""

    @property
    def time(self) -> np.ndarray:
        """Array, shape (width, frames), any unit."""

    @property
    def bins(self) -> np.ndarray:
        """Complex array, shape (width, frames // 2 + 1), any unit."""

    def forward(self) -> None:
        """Transform `time` to `bins`."""

    def backward(self) -> None:
        """Transform `bins` to `time`, without the division by `frames`."""


class FftwTransform:
    """A transform and its inverse by FFTW.

    Parameters
    ----------
    transform : Transform
    effort : Effort
        FFTW_ESTIMATE takes milliseconds, FFTW_MEASURE seconds to minutes; neither, where FFTW knows a plan.
    """

    def __init__(self, transform: Transform, effort: Effort) -> None:
        frames, width = transform
        self.time: np.ndarray = pyfftw.empty_aligned((width, frames), dtype=np.float64)
        self.bins: np.ndarray = pyfftw.empty_aligned((width, frames // 2 + 1), dtype=np.complex128)
        flags = (effort, "FFTW_DESTROY_INPUT")
        self._forward = pyfftw.FFTW(self.time, self.bins, axes=(1,), flags=flags, threads=1)
        self._backward = pyfftw.FFTW(self.bins, self.time, axes=(1,), direction="FFTW_BACKWARD", flags=flags, threads=1)

    def forward(self) -> None:
        """Transform `time` to `bins`."""
        self._forward.execute()

    def backward(self) -> None:
        """Transform `bins` to `time`, without the division by `frames`."""
        self._backward.execute()


class ScipyTransform:
    """A transform and its inverse by SciPy's pocketfft, on one core.

    Parameters
    ----------
    transform : Transform
    """

    def __init__(self, transform: Transform) -> None:
        frames, width = transform
        self.time = np.zeros((width, frames))
        self.bins = np.zeros((width, frames // 2 + 1), complex)

    def forward(self) -> None:
        """Transform `time` to `bins`."""
        self.bins[:] = scipy.fft.rfft(self.time, axis=1, workers=1)

    def backward(self) -> None:
        """Transform `bins` to `time`, without the division by `frames`."""
        self.time[:] = scipy.fft.irfft(self.bins, self.time.shape[1], axis=1, norm="forward", workers=1)


def library_of(backend: Backend) -> Library:
    """Return the library that `spectrum.backend` asks for.

    Raises
    ------
    ValueError : it is not installed.
    """
    if backend == "auto":
        return "scipy" if pyfftw is None else "fftw"
    if backend == "fftw" and pyfftw is None:
        raise ValueError(
            "spectrum.backend is fftw, but pyfftw is not installed: `pip install pyfftw`; a new run may have "
            "spectrum.backend = scipy, one that was recorded with fftw is replayed with fftw alone"
        )
    return backend


def fftw() -> Any:
    """Return FFTW's memory of plans, for `Plans`; `library_of` says whether it is installed."""
    return pyfftw
