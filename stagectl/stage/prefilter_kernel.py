"""The compiled kernel of prefilters, a sample at a time."""

import math

import numpy as np

from rigkit.compiled import njit

FILTER = np.dtype([("count", "i8"), ("spacing", "i8"), ("has_begun", "?")], align=True)
"""Of one axis: taps, samples from one to the next, and whether a number came since `prepare`."""


@njit(cache=True, nogil=True)
def run(
    reference: np.ndarray,
    filtered: np.ndarray,
    filters: np.ndarray,
    taps: np.ndarray,
    lines: tuple[np.ndarray, np.ndarray],
    at: np.ndarray,
) -> None:
    """Run one frame: shape (frames, axes) each, m; `taps` is shape (axes, taps), 1.

    `lines` are references and means, shape (samples, axes) each, m; `at[0]` is where the next sample goes in them.
    """
    raw, means = lines
    longest = len(raw)
    for n in range(len(reference)):
        now = at[0]
        for axis in range(reference.shape[1]):
            value = reference[n, axis]
            kept = filters[axis]
            is_number = not math.isnan(value)
            if is_number and not kept.has_begun:
                kept.has_begun = True
                raw[:, axis] = value
                means[:, axis] = value
            elif not is_number:
                value = raw[(now - 1) % longest, axis]
            raw[now, axis] = value
            total = 0.0
            for back in range(kept.spacing):
                total += raw[(now - back) % longest, axis]
            means[now, axis] = total / kept.spacing
            total = 0.0
            for tap in range(kept.count):
                total += taps[axis, tap] * means[(now - tap * kept.spacing) % longest, axis]
            filtered[n, axis] = total if is_number else math.nan
        at[0] = (now + 1) % longest
