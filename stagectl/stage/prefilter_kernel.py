"""The compiled kernel of prefilters, a sample at a time."""

import math

from numba import njit


@njit(cache=True, nogil=True)
def run(reference, filtered, filters, lines, at, has_begun):  # type: ignore[no-untyped-def]
    """Run one frame: shape (frames, axes) each, m; `at[0]` is where the next sample goes in `lines`."""
    (taps, count, spacing), (raw, means) = filters, lines
    longest = len(raw)
    for n in range(len(reference)):
        now = at[0]
        for axis in range(reference.shape[1]):
            value = reference[n, axis]
            is_number = not math.isnan(value)
            if is_number and not has_begun[axis]:
                has_begun[axis] = True
                raw[:, axis] = value
                means[:, axis] = value
            elif not is_number:
                value = raw[(now - 1) % longest, axis]
            raw[now, axis] = value
            total = 0.0
            for back in range(spacing[axis]):
                total += raw[(now - back) % longest, axis]
            means[now, axis] = total / spacing[axis]
            total = 0.0
            for tap in range(count[axis]):
                total += taps[axis, tap] * means[(now - tap * spacing[axis]) % longest, axis]
            filtered[n, axis] = total if is_number else math.nan
        at[0] = (now + 1) % longest
