"""Anybody's measurement - a sound, a table or an HDF5 file - read block by block: the one reader of all programs."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from ctlblocks.recording import Recording, RecordingError

VALUES = 2**19
"""Numbers that are read at once where nobody says how many."""


def frames_at_once(width: int) -> int:
    """Return how many frames of `width` channels are read at once."""
    return max(1, VALUES // width)


@dataclass(frozen=True, eq=False)
class Signals:
    """Signals in a file, all of one length and rate; their samples are still there.

    Parameters
    ----------
    path : Path
    names, units : tuple of str
    rate : float, samples/s
    frames : int or None
        None where that is known only after all is read: of a table without a column of time.
    source : callable() -> iterator of arrays, shape (any number of frames, all columns of the file), any unit
        Reads from the first sample.
    columns : tuple of int
        Which of the columns these signals are.
    provenance : mapping of str to str
    may_miss : bool
        Whether samples may be missing, which are NaN.

    Raises
    ------
    RecordingError : names, units or rate that no recording may have.
    """

    path: Path
    names: tuple[str, ...]
    units: tuple[str, ...]
    rate: float
    frames: int | None
    source: Callable[[], Iterator[np.ndarray]]
    columns: tuple[int, ...]
    provenance: Mapping[str, str] = field(default_factory=dict)
    may_miss: bool = False

    def __post_init__(self) -> None:
        """Refuse what no recording may be."""
        if self.frames == 0:
            raise RecordingError(f"{self.path}: holds no sample, must be frames >= 1")
        try:
            Recording(self.names, self.units, self.rate, np.zeros((1, len(self.names))), self.provenance)
        except (ValueError, TypeError) as fault:
            raise RecordingError(f"{self.path}: {fault}") from None

    def select(self, names: Sequence[str]) -> "Signals":
        """Return the signals of these names or numbers (from 1), in this order.

        Parameters
        ----------
        names : sequence of str

        Raises
        ------
        RecordingError : there is no such signal.
        """
        places = [self._place(name) for name in names]
        return replace(
            self,
            names=tuple(self.names[place] for place in places),
            units=tuple(self.units[place] for place in places),
            columns=tuple(self.columns[place] for place in places),
        )

    def scaled(self, unit: str, factors: np.ndarray) -> "Signals":
        """Return these signals in another unit.

        Parameters
        ----------
        unit : str
        factors : array, shape (channels,), `unit` per each signal's own
        """

        def source() -> Iterator[np.ndarray]:
            return (part[:, self.columns] * factors for part in self.source())

        width = len(self.names)
        return replace(self, units=(unit,) * width, source=source, columns=tuple(range(width)))

    def part(self, first: int, stop: int) -> np.ndarray:
        """Read samples `first` to `stop`, shape (stop - first, channels), any unit; fewer where there are fewer.

        Parameters
        ----------
        first, stop : int, frames, 0 <= first <= stop
        """
        kept, done = [np.empty((0, len(self.names)))], 0
        for block in self.blocks():
            if done + len(block) > first:
                kept.append(block[max(first - done, 0) : stop - done])
            done += len(block)
            if done >= stop:
                break
        return np.concatenate(kept)

    def blocks(self, size: int | None = None) -> Iterator[np.ndarray]:
        """Read from the first sample to the last, in memory for two blocks whatever the length of the file.

        Parameters
        ----------
        size : int or None, frames, >= 1
            None: what is handy.

        Yields
        ------
        float64 array, shape (size, channels), any unit
            A new one each time; the last may be shorter.

        Raises
        ------
        RecordingError : while it is read: a sample that is not finite, a row that is none, a file that ends too early.
        """
        size = size or frames_at_once(len(self.names))
        block, filled, done = np.empty((size, len(self.names))), 0, 0
        for part in self.source():
            chosen = part[:, self.columns]
            self._refuse_not_finite(chosen, done)
            done += len(chosen)
            while len(chosen):
                taken = chosen[: size - filled]
                block[filled : filled + len(taken)] = taken
                filled, chosen = filled + len(taken), chosen[len(taken) :]
                if filled == size:
                    yield block
                    block, filled = np.empty_like(block), 0
        if filled:
            yield block[:filled]
        if done == 0 or self.frames not in (None, done):
            raise RecordingError(f"{self.path}: has {done} samples, must have {self.frames or 'at least 1'}")

    def whole(self) -> Recording:
        """Read all of it.

        Raises
        ------
        RecordingError : as of `blocks`.
        """
        data, done = np.empty((frames_at_once(len(self.names)), len(self.names))), 0
        for block in self.blocks():
            if done + len(block) > len(data):
                data.resize((len(data) * 3 // 2 + len(block), len(self.names)), refcheck=False)
            data[done : done + len(block)] = block
            done += len(block)
        data.resize((done, len(self.names)), refcheck=False)
        return Recording(self.names, self.units, self.rate, data, self.provenance)

    def _place(self, name: str) -> int:
        if name in self.names:
            return self.names.index(name)
        if name.isdecimal() and 1 <= int(name) <= len(self.names):
            return int(name) - 1
        raise RecordingError(
            f"{self.path}: no channel {name!r}; there are {', '.join(self.names)}, or the numbers 1 to "
            f"{len(self.names)}"
        )

    def _refuse_not_finite(self, data: np.ndarray, first: int) -> None:
        if (finite := np.isfinite(data) | (self.may_miss & np.isnan(data))).all():
            return
        frame, column = divmod(int(finite.argmin()), data.shape[1])
        sample = first + frame
        raise RecordingError(
            f"{self.path}: channel {self.names[column]!r}, sample {sample}: {data[frame, column]}, must be finite "
            f"(at {sample / self.rate:.6g} s)"
        )
