"""The table `[spectrum]` of a rig file: which library transforms."""

from typing import Literal

from rigkit.config import Section, setting

Backend = Literal["auto", "fftw", "scipy"]


class Spectrum(Section):
    """Which FFT a run goes by; another one differs in its last digits."""

    backend: Backend = setting(
        "auto", "", "fftw: pyfftw, which is under the GPL; scipy; auto: fftw where it is installed, else scipy"
    )
