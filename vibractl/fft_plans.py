"""The FFT plans of a run: FFTW's are measured beforehand or estimated, and stored as wisdom; SciPy has none."""

import threading
from pathlib import Path
from typing import Self

import platformdirs

from vibractl.fft_transform import Effort, FftwTransform, Planned, ScipyTransform, Transform, fftw, library_of
from vibractl.spectrum_config import Backend

_PLANNER = threading.Lock()
"""FFTW has one memory of plans for the whole process: one run at a time may put its own there."""


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
    backend : Backend
        `spectrum.backend`.  With SciPy there is no wisdom: its transforms follow from SciPy's version alone.

    Raises
    ------
    ValueError : that library is not installed.
    """

    def __init__(self, wisdom: bytes = b"", backend: Backend = "auto") -> None:
        self.library = library_of(backend)
        """Which one transforms."""
        self.is_taken, self._wisdom = True, b""
        """Whether there was no wisdom, or FFTW took it."""
        if self.library == "fftw":
            with _PLANNER:
                fftw().forget_wisdom()
                self.is_taken = not wisdom or bool(fftw().import_wisdom((wisdom, b"", b""))[0])
                self._wisdom = fftw().export_wisdom()[0]
                fftw().forget_wisdom()
        self.note = ""
        """What a person should know of where the plans come from; empty for nothing."""

    @classmethod
    def of_run(cls, path: Path, backend: Backend = "auto") -> Self:
        """Return the plans that a run has stored in `path`; estimates, and a note, where they cannot be had."""
        try:
            return cls._read(path, backend)
        except OSError as fault:
            plans = cls(backend=backend)
            plans.note = _estimated(path, fault.strerror or str(fault))
            return plans

    @classmethod
    def of_user(cls, backend: Backend = "auto") -> Self:
        """Return the plans that this user has measured; estimates where there are none."""
        try:
            return cls._read(user_wisdom(), backend)
        except OSError:  # of an optimisation: whatever is wrong with the folder, a run goes on
            return cls(backend=backend)

    @property
    def wisdom(self) -> bytes:
        """Everything planned so far, as FFTW's own text."""
        return self._wisdom

    def planned(self, transform: Transform, effort: Effort = "FFTW_ESTIMATE") -> Planned:
        """Plan a transform, and remember how; from any thread."""
        if self.library == "scipy":
            return ScipyTransform(transform)
        with _PLANNER:
            fftw().forget_wisdom()
            fftw().import_wisdom((self._wisdom, b"", b""))
            try:
                made = FftwTransform(transform, effort)
                self._wisdom = fftw().export_wisdom()[0]
            finally:
                fftw().forget_wisdom()
        return made

    @classmethod
    def _read(cls, path: Path, backend: Backend) -> Self:
        if library_of(backend) == "scipy":
            return cls(backend=backend)
        plans = cls(path.read_bytes(), backend)
        if not plans.is_taken:
            plans.note = _estimated(path, "damaged, or from another version of FFTW or another kind of processor")
        return plans


def user_wisdom() -> Path:
    """Return the file in which `vibractl plan-ffts` stores the plans that it has measured for this user."""
    return Path(platformdirs.user_cache_dir("vibrostage")) / "fftw.wisdom"


def _estimated(path: Path, reason: str) -> str:
    return f"{path}: {reason}; FFT plans are estimated, so that results may differ in their last digits"
