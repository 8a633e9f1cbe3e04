"""The table `[spectrum]` of a rig file: which library transforms."""

from typing import Literal

from rigkit.config import Section, setting

Backend = Literal["auto", "fftw", "scipy"]


class Spectrum(Section):
    """The FFT library of a run; libraries differ in the last digits."""

    backend: Backend = setting(
        "auto", "", "fftw: pyfftw, which is under the GPL; scipy; auto: fftw where it is installed, else scipy"
    )
