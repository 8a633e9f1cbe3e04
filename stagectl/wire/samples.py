"""Blocks of samples: position, extension and voltage of three axes, in SI units, to frames and back."""

import numpy as np

from rigkit.wire.layout import GarbledError, Layout, WireError
from stagectl.wire import messages

FULL_SCALE = 32_767
"""Counts; one more to the other side stands for a sample that is not valid."""
INVALID = -32_768

_SI = {"um": ("m", 1e6), "V": ("V", 1.0)}
_COUNTS = np.dtype("<i2")


def unit(layout: Layout) -> str:
    """Return the SI unit of a frame of samples."""
    return _SI[layout.fields[0].unit][0]


def resolution(layout: Layout) -> float:
    """Return what one count is worth, in `unit`: m or V."""
    field = layout.fields[0]
    return field.scale / _SI[field.unit][1]


def largest(layout: Layout) -> float:
    """Return the largest value such a frame can carry, in `unit`: m or V.

    Examples
    --------
    >>> largest(messages.REFERENCE)
    0.00032767
    """
    return FULL_SCALE * resolution(layout)


def rounded(layout: Layout, signal: np.ndarray) -> np.ndarray:
    """Return a signal, any shape, m or V, as the counts of such a frame will give it back.

    Examples
    --------
    >>> rounded(messages.VOLTAGE, np.array([0.07, -0.11])).round(3)
    array([ 0.05, -0.1 ])
    """
    counts: np.ndarray = np.rint(signal / resolution(layout))
    return counts * resolution(layout)


def encode(layout: Layout, counter: int, block: np.ndarray) -> bytes:
    """Return a frame of samples.

    Parameters
    ----------
    layout : Layout
    counter : int, number of the block
    block : array, shape (samples, axes), m or V
        As many samples as the frame holds: 10, or 1 in a short one.  A NaN, in what the stage measures, says that the
        sample is not valid.

    Raises
    ------
    WireError : a value is beyond the frame's range; nothing is clipped.
    """
    if block.size != len(layout.fields) or block.shape[1:] != (len(messages.AXES),):
        raise WireError(f"{layout.name}: a block of shape {block.shape}, must be of {len(layout.fields)} samples")
    counts = np.rint(block / resolution(layout))
    invalid = np.isnan(counts) if layout.sender == "stage" else np.zeros(counts.shape, bool)
    beyond = ~(np.abs(counts) <= FULL_SCALE) & ~invalid
    if beyond.any():
        sample, axis = np.argwhere(beyond)[0]
        raise WireError(
            f"{layout.name}: {messages.AXES[axis]} is {block[sample, axis]:g} {unit(layout)} in sample {sample}, "
            f"must be within +-{largest(layout):g} {unit(layout)}"
        )
    counts[invalid] = INVALID
    return layout.pack(counter, *counts.astype(_COUNTS).ravel().tolist())


def decode(layout: Layout, data: bytes) -> tuple[int, np.ndarray]:
    """Return the number of a block and its samples, shape (samples, axes), m or V; NaN where one is not valid.

    Parameters
    ----------
    layout : Layout
    data : bytes

    Raises
    ------
    GarbledError : it is no such frame, or a reference holds a sample that is not valid.
    """
    counter, counts = layout.unpack(data)
    block = np.array(counts, float).reshape(-1, len(messages.AXES))
    if INVALID in counts:
        if layout.sender == "host":
            raise GarbledError(f"{layout.name}: a sample is {INVALID} counts, must be within +-{FULL_SCALE}")
        block[block == INVALID] = np.nan
    block *= resolution(layout)
    return counter, block
