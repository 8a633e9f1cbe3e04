"""Where a shot is listened to: which sensors there are, how late they hear, and what the reference is there."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from vibractl.far_field import FarField

Where = Literal["accelerometers", "far-field"]
PREFIXES: dict[Where, str] = {"accelerometers": "", "far-field": "far_"}
"""Of the columns of a place in `qc.csv`."""


@dataclass(frozen=True, eq=False)
class Place:
    """The accelerometers that are controlled, or the hydrophones; both at the learner's rate.

    Parameters
    ----------
    name : "accelerometers" or "far-field"
    sensors : tuple of int
        Of those recorded there, counted from 0.
    reference : array, shape (frames, sensors), m/s^2 or Pa
        What the sensors would hear of a vibrator that emits the reference and nothing else.
    late : tuple of int, samples
        By how much each sensor hears later than the shells move: so much later its frame begins.
    transfer : complex array, shape (lines, sensors, accelerometers), 1 or Pa per m/s^2
        From accelerometers' lines to lines of these frames; empty for the accelerometers themselves.
    """

    name: Where
    sensors: tuple[int, ...]
    reference: np.ndarray
    late: tuple[int, ...]
    transfer: np.ndarray = field(default_factory=lambda: np.zeros((0, 0, 0)))

    @property
    def is_far(self) -> bool:
        """Whether hydrophones listen."""
        return self.name == "far-field"

    @property
    def unit(self) -> str:
        """Of what is heard."""
        return "Pa" if self.is_far else "m/s^2"

    @property
    def prefix(self) -> str:
        """Before the names of this place's columns."""
        return PREFIXES[self.name]

    @property
    def sensor(self) -> str:
        """What one of the sensors is called."""
        return "hydrophone" if self.is_far else "response"

    def frame(self, heard: np.ndarray, first: int) -> np.ndarray:
        """Cut out what belongs to the reference.

        Parameters
        ----------
        heard : array, shape (samples, sensors), any unit
            At the learner's rate, of a whole shot.
        first : int, samples
            Where the reference begins in the drives.

        Returns
        -------
        array, shape (frames, sensors), the same unit
            Silent where the recording has ended.
        """
        frames = len(self.reference)
        starts, beyond = [first + late for late in self.late], first + max(self.late) + frames - len(heard)
        padded = np.pad(heard, ((0, max(beyond, 0)), (0, 0)))
        return np.stack([padded[start : start + frames, column] for column, start in enumerate(starts)], axis=1)


def at_accelerometers(reference: np.ndarray, outputs: tuple[int, ...]) -> Place:
    """Return the place of the accelerometers controlled, with the reference (frames, outputs), m/s^2, itself."""
    return Place("accelerometers", outputs, reference, (0,) * len(outputs))


def in_far_field(near: Place, far: FarField, rate: float, frequency: np.ndarray, longest: float) -> Place:
    """Return the place of the hydrophones.

    Parameters
    ----------
    near : Place
        Of the accelerometers.
    far : FarField
        From all accelerometers of the rig.
    rate : float, samples/s, the learner's
    frequency : array, shape (lines,), Hz
        Lines that are learned.
    longest : float, s
        Silence after the reference: no hydrophone may hear later.

    Raises
    ------
    ValueError : one does.
    """
    slowest = int(far.delay.argmax())
    if not far.delay[slowest] <= longest:
        raise ValueError(
            f"hydrophone {slowest + 1} hears the vibrator {far.delay[slowest]:.3f} s late, must be <= shot.tail, "
            f"{longest:g} s"
        )
    late = np.floor(far.delay * rate).astype(int)
    frames = len(near.reference)
    bins = np.fft.rfftfreq(frames, 1 / rate)
    inside = (bins >= far.prompt.frequency[0]) & (bins <= far.prompt.frequency[-1])
    lines = np.fft.rfft(near.reference, axis=0)
    heard = np.zeros((len(bins), far.hydrophones), complex)
    own = list(near.sensors)
    heard[inside] = (far.at(bins[inside]).later(late / rate)[:, :, own] @ lines[inside][..., None])[..., 0]
    return Place(
        "far-field",
        tuple(range(far.hydrophones)),
        np.fft.irfft(heard, frames, axis=0),
        tuple(late.tolist()),
        far.at(frequency).later(late / rate),
    )
