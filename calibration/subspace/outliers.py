"""Samples that are far off, as of a loose plug or a lost bit: found by what the samples around them tell."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve

from calibration.subspace.lagged import OWN, SAMPLES, lagged
from calibration.subspace.outlier_kernel import far_off

LAGS = 30
"""Lags of the inputs that outputs are foretold by."""
ROWS = 4
"""Samples that are wanted for each coefficient of that."""
BOUND = 6.0
"""Standard deviations of what is foretold wrongly, beyond which a sample is suspected."""
FLOOR = 0.005
"""The least of those, re the output's own: what is less does no harm."""
TAIL = 0.02
"""Part of what is foretold wrongly, the largest, that standard deviations are taken without."""
NEAR, CROWD = OWN, 3
"""Samples on either side of one, of which more than so many far off are no outliers: something happened there."""
MOST = 0.03
"""Part of an output's samples that can be outliers; more are what the output is like."""
ROUNDS = 5
START = max(OWN, LAGS)
"""Samples at the beginning of a record that nothing foretells."""
AROUND, PIECES = 100, 20
"""Samples in which the usual error is taken; stretches of long records, all over them, that the model is fitted to."""
BLOCK = 65_536
"""Samples that are looked at together."""
Outliers = Literal["replace", "keep"]

_WITHOUT_TAIL = 0.93
"""Root mean square of normal numbers without the largest `TAIL` of them."""
_NORMAL = 1.4826
"""Standard deviation of a normal distribution, re the median of its absolute values."""
_RIDGE = 1e-9
"""Of each regressor's power, that holds what inputs of few lines leave open."""


@dataclass(frozen=True)
class _Foreteller:
    """An ARX model of what most of the samples are like: weights (lag, of, for), levels, the least of its errors."""

    pushed: np.ndarray
    memory: np.ndarray
    level: np.ndarray
    least: np.ndarray

    def told(self, drive: np.ndarray) -> np.ndarray:
        """Return what inputs tell, shape (N, p)."""
        told = np.tile(self.level, (len(drive), 1))
        for lag, weights in enumerate(self.pushed):
            told[lag:] += drive[: len(drive) - lag] @ weights
        return told

    def usual(self, told: np.ndarray, believed: np.ndarray) -> np.ndarray:
        """Return the usual errors around each sample, shape (N, p): where a machine is loud, they are larger."""
        left = believed - told
        for lag, weights in enumerate(self.memory, 1):
            left[lag:] -= believed[:-lag] @ weights
        size = np.abs(left[START:])
        near = _NORMAL * _medians(size, max(1, len(size) // AROUND))
        place = START + (np.arange(len(near)) + 0.5) * len(size) / len(near)
        local = [np.interp(np.arange(len(told)), place, column) for column in np.transpose(near)]
        return np.asarray(np.maximum(np.stack(local, axis=1), self.least))

    def searched(self, drive: np.ndarray, measured: np.ndarray, believed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return a record without outliers, and where they are, with what was believed of it before."""
        found = believed != measured
        if len(measured) <= START:
            return believed, found
        told = self.told(drive)
        clean, found[START:] = np.empty_like(measured), False
        far_off((told, measured, believed), self.memory, self.usual(told, believed), BOUND, START, clean, found)
        around = [np.convolve(each, np.ones(2 * NEAR + 1), "same") for each in found.T.astype(float)]
        crowded = found & (np.stack(around, axis=1) > CROWD)
        return np.where(crowded, measured, clean), found & ~crowded


def _medians(size: np.ndarray, count: int) -> np.ndarray:
    """Return the medians of `count` blocks of samples of equal length, or nearly, shape (count, p)."""
    length, longer = divmod(len(size), count)
    cut = longer * (length + 1)
    width = size.shape[1]
    parts = size[:cut].reshape(longer, length + 1, width), size[cut:].reshape(count - longer, length, width)
    return np.concatenate([np.median(part, axis=1) for part in parts if len(part)])


def treated(
    drives: Sequence[np.ndarray], responses: Sequence[np.ndarray], outliers: Outliers
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Return outputs without outliers, and where those are; as they are, and none, where outliers are to be kept.

    Parameters
    ----------
    drives : sequence of arrays, each of shape (N, m), any unit
    responses : sequence of arrays, each of shape (N, p), any unit
    outliers : "replace" or "keep"

    Raises
    ------
    ValueError : another word.
    """
    if outliers not in get_args(Outliers):
        raise ValueError(f"outliers is {outliers!r}, must be one of {', '.join(get_args(Outliers))}")
    if outliers == "replace":
        return without_outliers(drives, responses)
    return list(responses), [np.zeros(response.shape, bool) for response in responses]


def without_outliers(
    drives: Sequence[np.ndarray], responses: Sequence[np.ndarray]
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Replace single samples of outputs that are far off by what those before them tell.

    Outputs are foretold by an ARX model of all samples but those that are found, in turn.  Found is what is foretold
    wrongly by 6 standard deviations, stands out from its neighbours, and was not heard of by the samples after it, as
    they would have of a knock on the plant.  Of records too short for that, nothing is found.

    Parameters
    ----------
    drives : sequence of arrays, each of shape (N, m), any unit
    responses : sequence of arrays, each of shape (N, p), any unit

    Returns
    -------
    responses : list of arrays, each of shape (N, p), any unit
    found : list of arrays of bool, each of shape (N, p)

    Source
    ------
    Fox 1972, "Outliers in time series", J. R. Statist. Soc. B 34, 350-363: type I (additive) and II (innovational).

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> u = rng.standard_normal((1000, 1))
    >>> y = u + 0.1 * rng.standard_normal((1000, 1))
    >>> y[500] += 8.0
    >>> _, (found,) = without_outliers([u], [y])
    >>> np.flatnonzero(found).tolist()
    [500]
    """
    low = np.mean(np.concatenate(drives), axis=0)
    middle = np.median(np.concatenate(responses), axis=0)
    pushed = [drive - low for drive in drives]
    measured = [np.ascontiguousarray(response - middle) for response in responses]
    believed, found = _searched(pushed, measured)
    few = np.mean(np.concatenate(found), axis=0) <= MOST
    found = [where & few for where in found]
    return [
        np.where(where, clean + middle, response)
        for where, clean, response in zip(found, believed, responses, strict=True)
    ], found


def _searched(
    pushed: Sequence[np.ndarray], measured: Sequence[np.ndarray]
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Return records without outliers, and where they are, by foretellers of what was not found before."""
    found = [_jumps(response) for response in measured]
    believed = [_bridged(response, where) for response, where in zip(measured, found, strict=True)]
    for _ in range(ROUNDS):
        teller = _foreteller(pushed, believed, found)
        if teller is None:
            return list(measured), [np.zeros(response.shape, bool) for response in measured]
        before = found
        pairs = [teller.searched(*each) for each in zip(pushed, measured, believed, strict=True)]
        believed, found = [clean for clean, _ in pairs], [where for _, where in pairs]
        if all(np.array_equal(now, then) for now, then in zip(found, before, strict=True)):
            break
    return believed, found


def outlier_notes(found: Sequence[np.ndarray]) -> tuple[str, ...]:
    """Say in a sentence for each output how many of its samples are far off.

    Parameters
    ----------
    found : sequence of arrays of bool, each of shape (N, p)
        Where they are.

    Examples
    --------
    >>> outlier_notes([np.array([[False, True], [False, False]])])
    ('1 of 2 samples of output 2 is far off what those around it tell, and replaced',)
    """
    counts, samples = np.sum([where.sum(axis=0) for where in found], axis=0), sum(len(where) for where in found)
    return tuple(
        f"{count} of {samples} samples of output {output} {'is' if count == 1 else 'are'} far off what those around "
        f"{'it tell, and' if count == 1 else 'them tell, and are'} replaced"
        for output, count in enumerate(counts, 1)
        if count
    )


def _jumps(response: np.ndarray) -> np.ndarray:
    """Return where samples are far from the median of the seven around them, and of all."""
    mode: Literal["reflect", "edge"] = "reflect" if len(response) > 3 else "edge"
    padded, away = np.pad(response, ((3, 3), (0, 0)), mode=mode), np.empty_like(response)
    for first in range(0, len(response), BLOCK):  # the windows take seven times the memory
        part = slice(first, first + BLOCK)
        around = np.lib.stride_tricks.sliding_window_view(padded[first : first + BLOCK + 6], 7, axis=0)
        away[part] = response[part] - np.median(around, axis=-1)
    return np.asarray(np.abs(away) > BOUND * np.maximum(_spread(away), _spread(response)))


def _spread(values: np.ndarray) -> np.ndarray:
    """Return the standard deviations of most values, shape (p,)."""
    return np.asarray(_NORMAL * np.median(np.abs(values - np.median(values, axis=0)), axis=0))


def _bridged(response: np.ndarray, where: np.ndarray) -> np.ndarray:
    """Return a record with lines across the samples that are not believed."""
    full, time = response.copy(), np.arange(len(response))
    for column, wrong in zip(full.T, where.T, strict=True):
        if not wrong.all():
            column[wrong] = np.interp(time[wrong], time[~wrong], column[~wrong])
    return full


def _foreteller(
    drives: Sequence[np.ndarray], believed: Sequence[np.ndarray], found: Sequence[np.ndarray]
) -> _Foreteller | None:
    """Fit an ARX model to what is not far off; none where that is too little."""
    inputs, outputs = drives[0].shape[1], believed[0].shape[1]
    pieces = _pieces([len(each) for each in drives])
    drives, believed, found = (
        [side[number][first:last] for number, first, last in pieces] for side in (drives, believed, found)
    )
    regressors, wanted, _ = lagged(drives, believed, LAGS)
    is_sound = ~np.any(_rows(found), axis=1)
    known, wanted = np.pad(regressors[is_sound], ((0, 0), (0, 1)), constant_values=1.0), wanted[is_sound]
    if len(known) < ROWS * known.shape[1]:
        return None
    products = known.T @ known
    products[np.diag_indices_from(products)] *= 1 + _RIDGE
    try:
        weights = cho_solve(cho_factor(products), known.T @ wanted)
    except LinAlgError:
        return None
    left = np.sort(np.abs(wanted - known @ weights), axis=0)
    usual = np.sqrt(np.mean(left[: int((1 - TAIL) * len(left))] ** 2, axis=0)) / _WITHOUT_TAIL
    least = np.maximum(np.maximum(usual, _NORMAL * np.median(left, axis=0)), FLOOR * _spread(wanted))
    memory = weights[: OWN * outputs].reshape(OWN, outputs, outputs)
    return _Foreteller(weights[OWN * outputs : -1].reshape(LAGS + 1, inputs, outputs), memory, weights[-1], least)


def _pieces(lengths: Sequence[int]) -> list[tuple[int, int, int]]:
    """Return records, or stretches all over them (record, first, last), of no more samples than `lagged` looks at."""
    if sum(lengths) <= SAMPLES:
        return [(number, 0, length) for number, length in enumerate(lengths)]
    edges = [(number, np.linspace(0, length, PIECES + 1).astype(int)) for number, length in enumerate(lengths)]
    part = SAMPLES / sum(lengths)
    return [
        (number, int(first), int(first + part * (last - first)) + START)
        for number, cuts in edges
        for first, last in zip(cuts[:-1], cuts[1:], strict=True)
    ]


def _rows(found: Sequence[np.ndarray]) -> np.ndarray:
    """Return those of the samples that `lagged` explains, shape (samples, p)."""
    nothing = [np.zeros((len(each), 0)) for each in found]
    return np.asarray(lagged(nothing, [each.astype(float) for each in found], LAGS)[1], dtype=bool)
