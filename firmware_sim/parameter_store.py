"""The stage's store of parameters: takes a set in chunks, gives it back, and puts it into use as a whole."""

from collections.abc import Callable, Mapping

import numpy as np

from rigkit.wire.layout import GarbledError
from stagectl.wire.messages import WINDOW, Result
from stagectl.wire.parameters import LARGEST, checksum, unpack_parameters


class ParameterStore:
    """What has been uploaded, and which set is in use.

    Parameters
    ----------
    commit : callable(mapping of str to array)
        Puts a set into use; a ValueError refuses it and changes nothing.
    """

    def __init__(self, commit: Callable[[Mapping[str, np.ndarray]], None]) -> None:
        self.in_use = 0
        self.received = 0
        self._commit = commit
        self._size = 0
        self._pieces: list[bytes] = []

    def begin(self, size: int) -> Result:
        """Expect a set of `size` bytes; what came before is forgotten, what is in use stays."""
        self.received, self._size, self._pieces = 0, 0, []
        if not 0 < size <= LARGEST:
            return Result.WRONG_SIZE
        self._size = size
        return Result.DONE

    def write(self, number: int, data: bytes) -> None:
        """Take the next chunk; any other is passed over, the host will ask how many came."""
        if number == self.received and len(data) * number < self._size:
            self._pieces.append(data)
            self.received += 1

    def read(self, first: int) -> list[tuple[int, bytes]]:
        """Return up to `WINDOW` chunks as they were written, from number `first` on."""
        return list(enumerate(self._pieces))[first : first + WINDOW]

    def commit(self, wanted: int) -> Result:
        """Put the set into use if it is whole, its CRC-32 is `wanted`, and the loops take it."""
        image = b"".join(self._pieces)[: self._size]
        if not image or len(image) < self._size:
            return Result.INCOMPLETE
        try:
            parameters = unpack_parameters(image)
        except GarbledError:
            return Result.WRONG_CHECKSUM
        if checksum(image) != wanted:
            return Result.WRONG_CHECKSUM
        try:
            self._commit(parameters)
        except ValueError:
            return Result.REFUSED
        self.in_use = wanted
        return Result.DONE
