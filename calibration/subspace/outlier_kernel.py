"""The compiled search for samples that are far from what those around them tell."""

import numpy as np

from rigkit.compiled import njit

EVIDENCE = 10.0
"""By which one of two must explain the samples after it better: twice a logarithm of likelihood, 150 to 1."""
CERTAIN = 4.0
"""Times the bound beyond which it is the plant that wants evidence, not the mistake."""
STANDS_OUT = 0.6
"""Of what is foretold wrongly, that a sample must be away from its neighbours' mean: where a step begins, half is."""


@njit(cache=True, nogil=True)
def _is_real(
    records: tuple[np.ndarray, np.ndarray, np.ndarray],
    cleaned: np.ndarray,
    memory: np.ndarray,
    scale: np.ndarray,
    bound: float,
    place: tuple[int, int],
    miss: float,
) -> bool:
    """Return whether samples after n have heard of what was measured there, rather than of what was foretold.

    They are foretold with either of the two, `cleaned[n]` being what was foretold, and what that leaves is compared.
    """
    (pushed, _, believed), (n, channel) = records, place
    lags, outputs = memory.shape[0], memory.shape[1]
    measured, foretold, most = 0.0, 0.0, bound * bound
    for later in range(1, min(lags, believed.shape[0] - 1 - n) + 1):
        for output in range(outputs):
            told = pushed[n + later, output]
            for lag in range(1, min(lags, n + later) + 1):
                at = n + later - lag
                for other in range(outputs):
                    seen = believed[at, other] if at > n else cleaned[at, other]
                    told += memory[lag - 1, other, output] * seen
            left = (believed[n + later, output] - told) / scale[n + later, output]
            heard = memory[later - 1, channel, output] * miss / scale[n + later, output]
            foretold += min(left * left, most)
            measured += min((left - heard) ** 2, most)
    if abs(miss) > CERTAIN * bound * scale[n, channel]:
        return measured < foretold - EVIDENCE
    return measured < foretold + EVIDENCE


@njit(cache=True, nogil=True)
def far_off(
    records: tuple[np.ndarray, np.ndarray, np.ndarray],
    memory: np.ndarray,
    scale: np.ndarray,
    bound: float,
    start: int,
    cleaned: np.ndarray,
    found: np.ndarray,
) -> None:
    """Write records without samples that are far off, and which those are, shapes (N, p), from sample `start` on.

    `records` are the part of each sample that inputs foretell, what was measured, and what is thought of samples that
    are still to come; `memory`, shape (lags, p, p), is the weight of earlier outputs (lag, of, for), `scale`, shape
    (N, p), the usual error.
    """
    pushed, measured, believed = records
    lags, outputs = memory.shape[0], memory.shape[1]
    told = np.empty(outputs)
    cleaned[:start] = believed[:start]
    for n in range(start, measured.shape[0]):
        cleaned[n] = believed[n]
        told[:] = pushed[n]
        for lag in range(1, lags + 1):
            for other in range(outputs):
                for output in range(outputs):
                    told[output] += memory[lag - 1, other, output] * cleaned[n - lag, other]
        after = min(n + 1, measured.shape[0] - 1)
        for output in range(outputs):
            miss = measured[n, output] - told[output]
            away = measured[n, output] - (cleaned[n - 1, output] + believed[after, output]) / 2
            cleaned[n, output] = told[output]
            if (
                abs(miss) > bound * scale[n, output]
                and away * miss > STANDS_OUT * miss * miss
                and not _is_real(records, cleaned, memory, scale, bound, (n, output), miss)
            ):
                found[n, output] = True
            else:
                cleaned[n, output] = measured[n, output]
