"""An optical tracker: poses of several frames 440 times a second, with its noise and all that goes wrong with one."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stagectl.wire.tracker import Sample, Sighting, pack_sample

Poses = Callable[[], dict[int, np.ndarray]]
LEDS = 3
"""LEDs on each frame."""


@dataclass(frozen=True)
class TrackerFaults:
    """How good the tracker is, and what goes wrong by chance.

    Parameters
    ----------
    seed : int
    noise : float, m rms in each axis of a frame's position
        Nikon K600: 50 to 75 um [Sörnmo 2015, sec. 4.4].
    radius : float, m, of the LEDs around a frame's origin: noise of position over that is noise of direction
    lost : float, 0 to 1, part of the samples that never come
    swapped : float, 0 to 1, part of the samples that come after the next one
    unseen : float, 0 to 1, part of the sightings with too few LEDs
    """

    seed: int = 1
    noise: float = 60e-6
    radius: float = 0.1
    lost: float = 0.002
    swapped: float = 0.001
    unseen: float = 0.002


class TrackerCamera:
    """The tracker without a socket: `look` at each sample, bytes out.

    Modelled: noise of each sighting, samples lost and out of order, LEDs hidden, a frame whose LEDs are taken for
    others (`jump`), and blindness (`is_blind`: it sends that it sees nothing; `is_mute`: it sends nothing).  Not
    modelled: noise that depends on place, errors that stay in one place, exposure of LEDs one after the other.

    Parameters
    ----------
    poses : callable() -> dict of frame number to pose, shape (7,), m and unit quaternion w x y z
    faults : TrackerFaults
    """

    def __init__(self, poses: Poses, faults: TrackerFaults | None = None) -> None:
        self.faults = faults or TrackerFaults()
        self.is_blind = self.is_mute = False
        self.jump: dict[int, np.ndarray] = {}
        self._poses, self._counter, self._waiting = poses, 0, b""
        self._rng = np.random.default_rng(self.faults.seed)

    def look(self, time: float) -> bytes:
        """Return what is sent of a look at `time` (s, the tracker's clock)."""
        self._counter += 1
        sightings = tuple(self._see(frame, pose) for frame, pose in self._poses().items())
        data, waiting = pack_sample(Sample(self._counter, time, sightings)), self._waiting
        draw, faults = self._rng.random(), self.faults
        self._waiting = b""
        if self.is_mute or draw < faults.lost:
            return b"" if self.is_mute else waiting
        if draw < faults.lost + faults.swapped:
            self._waiting = data
            return waiting
        return data + waiting

    def _see(self, frame: int, pose: np.ndarray) -> Sighting:
        faults, noise = self.faults, self._rng.standard_normal(6) * self.faults.noise
        residual = float(faults.noise * np.sqrt(self._rng.chisquare(3 * LEDS - 6) / (3 * LEDS - 6)))
        if self.is_blind or self._rng.random() < faults.unseen:
            return Sighting(frame, LEDS - 1, np.nan, np.full(7, np.nan))
        seen = np.concatenate([pose[:3] + noise[:3], _turned(pose[3:], noise[3:] / faults.radius)])
        seen[:3] += self.jump.get(frame, 0.0)
        return Sighting(frame, LEDS, residual, seen)


def _turned(quaternion: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """Return a unit quaternion turned by a small vector, rad, in the base."""
    w, v = quaternion[0], quaternion[1:]
    half = 0.5 * turn
    made = np.concatenate([[w - half @ v], v + w * half + np.cross(half, v)])
    return np.asarray(made / np.linalg.norm(made))
