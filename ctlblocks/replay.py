"""Replay and Record: the blocks through which a recording enters a graph, and leaves it."""

from collections.abc import Mapping, Sequence

import numpy as np

from ctlblocks.block import Block, Port
from ctlblocks.recording import Recording


class Replay(Block):
    """Play chosen channels of a recording once, from its first sample; then zeros, and `exhausted` is True.

    Parameters
    ----------
    recording : Recording
        `prepare` refuses any rate but its own.
    ports : mapping of str to sequence of str
        Output port -> names of the channels it plays side by side, all of one unit.
    """

    def __init__(self, recording: Recording, ports: Mapping[str, Sequence[str]]) -> None:
        parts = {name: recording.select(channels) for name, channels in ports.items()}
        for name, part in parts.items():
            if len(set(part.units)) > 1:
                raise ValueError(f"port {name}: channels {part.names} have units {part.units}, must have one")
        self.outputs = tuple(Port(name, part.units[0], len(part.names)) for name, part in parts.items())
        self._tracks = [part.data for part in parts.values()]
        self._rate, self._length, self.position = recording.rate, len(recording.data), 0

    def prepare(self, rate: float, frames: int) -> None:
        """Go back to the first sample."""
        if rate != self._rate:
            raise ValueError(f"the recording has {self._rate:g} samples/s, must be {rate:g} to be replayed here")
        self.position = 0

    def process(self, *signals: np.ndarray) -> None:
        """Play one frame on every port."""
        played = min(len(signals[0]), self._length - self.position)
        for signal, track in zip(signals, self._tracks, strict=True):
            signal[:played] = track[self.position : self.position + played]
            signal[played:] = 0.0
        self.position += played

    @property
    def exhausted(self) -> bool:
        """Whether every sample has been played."""
        return self.position == self._length


def numbered(port: Port) -> tuple[str, ...]:
    """Return how the channels of a port are called: by its name, with numbers from 1 where it has several."""
    if port.width == 1:
        return (port.name,)
    return tuple(f"{port.name}_{number}" for number in range(1, port.width + 1))


class Record(Block):
    """Keep what flows by until the memory is full; what comes later is counted in `overrun`, not kept.

    Parameters
    ----------
    ports : sequence of Port
        Inputs.  Their channels are `numbered`.
    capacity : int, samples, >= 1
    """

    def __init__(self, ports: Sequence[Port], capacity: int) -> None:
        if not ports or capacity < 1:
            raise ValueError(f"{len(ports)} ports and room for {capacity} samples, must be >= 1 each")
        self.inputs = tuple(ports)
        self._data = np.zeros((capacity, sum(port.width for port in ports)))
        self._rate, self.position, self.overrun = 0.0, 0, 0
        self._tracks = np.split(self._data, np.cumsum([port.width for port in ports])[:-1], axis=1)

    def prepare(self, rate: float, frames: int) -> None:
        """Forget everything."""
        self._rate, self.position, self.overrun = rate, 0, 0

    def process(self, *signals: np.ndarray) -> None:
        """Keep one frame of every port."""
        kept = min(len(signals[0]), len(self._data) - self.position)
        for signal, track in zip(signals, self._tracks, strict=True):
            track[self.position : self.position + kept] = signal[:kept]
        self.position += kept
        self.overrun += len(signals[0]) - kept

    def recording(self, provenance: Mapping[str, str] | None = None) -> Recording:
        """Return a copy of what is kept so far; RecordingError if that is nothing."""
        names = [name for port in self.inputs for name in numbered(port)]
        units = [port.unit for port in self.inputs for _ in range(port.width)]
        kept = self._data[: self.position].copy()
        return Recording(tuple(names), tuple(units), self._rate, kept, provenance or {})
