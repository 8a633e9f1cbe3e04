"""The table `[characterisation]` of the stage's rig file: how `calibrate stage` excites an axis."""

from typing import Literal, Self

from pydantic import model_validator

from rigkit.config import Section, setting


class Characterisation(Section):
    """How `calibrate stage` excites an axis: linear chirps about rest, up to the allowed excursion."""

    band: tuple[float, float] = setting((0.5, 200.0), "Hz", "lowest and highest frequency of the chirps")
    seconds: float = setting(20.0, "s", "length of the first chirp; the others are 15 and 25 % longer", ge=1, le=600)
    settle: float = setting(5.0, "s", "rest before each chirp, for the creep to decay", ge=0.5, le=600)
    excursion: float = setting(120e-6, "m", "largest excursion of the plate from rest", gt=0, le=1e-2)
    scout: float = setting(4.0, "V", "amplitude of the first, weak chirp, from which the others are scaled", gt=0)
    inner: Literal["designed", "rig"] = setting(
        "designed", "", "the PID of the closed inner loop: designed on the identified stack, or that of [inner]"
    )
    max_sensitivity: float = setting(
        2.2, "1", "bound on Ms of a designed PID on the identified stack, with one sample of extra delay", ge=1.1, le=10
    )

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        low, high = self.band
        if not 0 < low < high / 10:
            raise ValueError(f"characterisation.band is {low:g} to {high:g} Hz, must be > 0 and span a decade")
        if not low * self.seconds >= 2:
            raise ValueError(
                f"characterisation.seconds is {self.seconds:g} s, must be >= {2 / low:g} s: two periods of the lowest "
                "frequency of characterisation.band"
            )
        return self
