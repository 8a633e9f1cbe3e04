"""Faults on purpose in what the audio card hears."""

import numpy as np

from rigkit.faults import Faults, FaultTable


class SpoiledInput:
    """What a card hears, with faults put in on purpose.

    Parameters
    ----------
    table : FaultTable
        Of every input that the card is opened with.
    rate : int, samples/s
    frames : int, samples a callback
    """

    def __init__(self, table: FaultTable, rate: int, frames: int) -> None:
        self._block = Faults(table, [1.0] * len(table.names))
        self._block.prepare(float(rate), frames)
        self._clean, self._faulty = np.zeros((2, frames, len(table.names)))
        self._block.process(self._clean, self._faulty)  # compiles
        self._block.prepare(float(rate), frames)

    def spoiled(self, heard: np.ndarray) -> np.ndarray:
        """Return a block (frames, inputs), full scale, as it is with the faults; valid until the next."""
        np.copyto(self._clean, heard)
        self._block.process(self._clean, self._faulty)
        return self._faulty
