"""FFTW's plans of a run: measured beforehand where there are such, else estimated at once; stored as wisdom."""

import threading
from pathlib import Path
from typing import Literal, NamedTuple, Self

import numpy as np
import platformdirs
import pyfftw

Effort = Literal["FFTW_ESTIMATE", "FFTW_MEASURE"]

_PLANNER = threading.Lock()
"""FFTW has one memory of plans for the whole process: one run at a time may put its own there."""


class Transform(NamedTuple):
    """The size of a real FFT and its inverse.

    Parameters
    ----------
    frames : int, samples, >= 2
    width : int, channels, >= 1
    """

    frames: int
    width: int


class Planned:
    """A transform and its inverse, each of which destroys its input.

    Parameters
    ----------
    transform : Transform
    effort : Effort
        FFTW_ESTIMATE takes milliseconds, FFTW_MEASURE seconds to minutes; neither, where FFTW knows a plan.
    """

    def __init__(self, transform: Transform, effort: Effort) -> None:
        frames, width = transform
        self.time = pyfftw.empty_aligned((width, frames), dtype=np.float64)
        """Array, shape (width, frames), any unit."""
        self.bins = pyfftw.empty_aligned((width, frames // 2 + 1), dtype=np.complex128)
        """Complex array, shape (width, frames // 2 + 1), any unit."""
        flags = (effort, "FFTW_DESTROY_INPUT")
        self._forward = pyfftw.FFTW(self.time, self.bins, axes=(1,), flags=flags, threads=1)
        self._backward = pyfftw.FFTW(self.bins, self.time, axes=(1,), direction="FFTW_BACKWARD", flags=flags, threads=1)

    def forward(self) -> None:
        """Transform `time` to `bins`."""
        self._forward.execute()

    def backward(self) -> None:
        """Transform `bins` to `time`, without the division by `frames`."""
        self._backward.execute()


class Plans:
    """The FFT plans of one run.

    A transform for which the wisdom has a plan is run by that plan; any other one is planned by FFTW_ESTIMATE, which
    times nothing: such a plan follows from FFTW's version, the kind of processor and the wisdom.  The same plan gives
    the same bits.

    Parameters
    ----------
    wisdom : bytes
        FFTW's own text.  What FFTW does not take, since it is damaged or was made on another kind of processor or by
        another version, counts as none.
    """

    def __init__(self, wisdom: bytes = b"") -> None:
        with _PLANNER:
            pyfftw.forget_wisdom()
            self.is_taken = not wisdom or bool(pyfftw.import_wisdom((wisdom, b"", b""))[0])
            """Whether there was no wisdom, or FFTW took it."""
            self._wisdom: bytes = pyfftw.export_wisdom()[0]
            pyfftw.forget_wisdom()
        self.note = ""
        """What a person should know of where the plans come from; empty for nothing."""

    @classmethod
    def of_run(cls, path: Path) -> Self:
        """Return the plans that a run has stored in `path`; estimates, and a note, where they cannot be had."""
        try:
            return cls._read(path)
        except OSError as fault:
            plans = cls()
            plans.note = _estimated(path, fault.strerror or str(fault))
            return plans

    @classmethod
    def of_user(cls) -> Self:
        """Return the plans that this user has measured; estimates where there are none."""
        try:
            return cls._read(user_wisdom())
        except OSError:  # of an optimisation: whatever is wrong with the folder, a run goes on
            return cls()

    @property
    def wisdom(self) -> bytes:
        """Everything planned so far, as FFTW's own text."""
        return self._wisdom

    def planned(self, transform: Transform, effort: Effort = "FFTW_ESTIMATE") -> Planned:
        """Plan a transform, and remember how; from any thread."""
        with _PLANNER:
            pyfftw.forget_wisdom()
            pyfftw.import_wisdom((self._wisdom, b"", b""))
            try:
                made = Planned(transform, effort)
                self._wisdom = pyfftw.export_wisdom()[0]
            finally:
                pyfftw.forget_wisdom()
        return made

    @classmethod
    def _read(cls, path: Path) -> Self:
        plans = cls(path.read_bytes())
        if not plans.is_taken:
            plans.note = _estimated(path, "damaged, or from another version of FFTW or another kind of processor")
        return plans


def user_wisdom() -> Path:
    """Return the file in which `vibractl plan-ffts` stores the plans that it has measured for this user."""
    return Path(platformdirs.user_cache_dir("vibrostage")) / "fftw.wisdom"


def _estimated(path: Path, reason: str) -> str:
    return f"{path}: {reason}; FFT plans are estimated, so that results may differ in their last digits"
