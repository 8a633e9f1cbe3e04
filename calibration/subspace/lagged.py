"""Outputs beside their own past and the inputs': what an ARX model is fitted to."""

from collections.abc import Sequence

import numpy as np

OWN = 12
"""Lags of the outputs."""
SAMPLES = 10_000
"""Samples that are looked at, the first of all records."""


def lagged(
    drives: Sequence[np.ndarray], responses: Sequence[np.ndarray], lags: int
) -> tuple[np.ndarray, np.ndarray, list[tuple[int, int]]]:
    """Return lagged outputs (lags from 1) and inputs (from 0), and the outputs.

    Parameters
    ----------
    drives : sequence of arrays, each of shape (N, m), any unit
    responses : sequence of arrays, each of shape (N, p), any unit
    lags : int
        Of the inputs.

    Returns
    -------
    regressors : array, shape (samples, OWN p + (lags + 1) m), the inputs' and the outputs' units
    wanted : array, shape (samples, p), the outputs' units
    pieces : list of (int, int)
        Rows, first and after the last, that follow one another in a record.
    """
    rows, wanted, pieces, room = [], [], [], SAMPLES
    start, done = max(OWN, lags), 0
    for drive, response in zip(drives, responses, strict=True):
        stop = min(len(drive), start + room)
        if stop <= start:
            continue
        past = [response[start - lag : stop - lag] for lag in range(1, OWN + 1)]
        pushed = [drive[start - lag : stop - lag] for lag in range(lags + 1)]
        rows.append(np.concatenate(past + pushed, axis=1))
        wanted.append(response[start:stop])
        pieces.append((done, done + stop - start))
        done, room = done + stop - start, room - (stop - start)
    if not rows:
        inputs, outputs = drives[0].shape[1], responses[0].shape[1]
        return np.zeros((0, OWN * outputs + (lags + 1) * inputs)), np.zeros((0, outputs)), []
    return np.concatenate(rows), np.concatenate(wanted), pieces
