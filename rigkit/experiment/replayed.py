"""What was recorded, and the same made again: compared bit for bit."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ctlblocks.recording import Recording


@dataclass(frozen=True)
class Replayed:
    """One output of one axis, recorded and made again.

    Parameters
    ----------
    recording : str
    channel, unit : str
    identical : bool
        Whether every sample is the same, bit for bit.
    difference : float, in `unit`
        Largest.
    """

    recording: str
    channel: str
    unit: str
    identical: bool
    difference: float


def compared(name: str, before: Recording, again: Recording) -> Iterator[Replayed]:
    """Compare every channel that was made again with the recorded one.

    Parameters
    ----------
    name : str
        Of the recording.
    before, again : Recording
        The latter may have fewer channels.
    """
    for channel, unit in zip(again.names, again.units, strict=True):
        one, other = (np.ascontiguousarray(each.select([channel]).data) for each in (before, again))
        rows = min(len(one), len(other))
        is_same = one.shape == other.shape and one.tobytes() == other.tobytes()
        yield Replayed(name, channel, unit, is_same, float(np.abs(one[:rows] - other[:rows]).max()))
