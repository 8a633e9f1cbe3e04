"""A plant in this process that keeps all it is driven with."""

from typing import ClassVar

import numpy as np

from ctlblocks.block import Block, Port


class KeptDrive(Block):
    """Follow the drive, and keep it; each opening of a stream begins another list of frames.

    Ports: `drive` (V) in, `response` (m/s^2) out.
    """

    inputs = (Port("drive", "V", 2),)
    outputs = (Port("response", "m/s^2", 2),)
    openings: ClassVar[list[list[np.ndarray]]] = []

    def __init__(self) -> None:
        self._frames: list[np.ndarray] = []
        KeptDrive.openings.append(self._frames)

    def process(self, drive: np.ndarray, response: np.ndarray) -> None:
        """Copy and keep."""
        response[:] = drive
        self._frames.append(drive.copy())

    @classmethod
    def samples(cls) -> int:
        """Return how much has been played in all."""
        return sum(len(frame) for opening in cls.openings for frame in list(opening))

    @classmethod
    def played(cls) -> np.ndarray:
        """Return all of it, (samples, coils), V."""
        return np.concatenate([np.zeros((0, 2)), *(frame for opening in cls.openings for frame in opening)])
