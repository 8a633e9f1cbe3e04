"""A plant that keeps what it was driven with in a file, for tests that end its process."""

import numpy as np

from ctlblocks.block import Block, Port


class DriveLog(Block):
    """Follow the drive, and write it down.

    Ports: `drive` (V) in, `response` (m/s^2) out.
    """

    inputs = (Port("drive", "V", 2),)
    outputs = (Port("response", "m/s^2", 2),)

    def __init__(self, file: str, capacity: int) -> None:
        self._log = np.memmap(file, np.float64, "w+", shape=(capacity, 2))
        self._log.fill(np.nan)
        self._written = 0

    def process(self, drive: np.ndarray, response: np.ndarray) -> None:
        """Copy and keep."""
        response[:] = drive
        end = min(self._written + len(drive), len(self._log))
        self._log[self._written : end] = drive[: end - self._written]
        self._written = end
