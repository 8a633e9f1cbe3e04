"""How many states there are: those that stand out of the noise, and of these as many as the fit needs."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError, cholesky, solve_triangular, svd

from calibration.subspace.estimate import Compressed, estimate
from calibration.subspace.regression import Terms
from calibration.subspace.signals import Signals
from calibration.subspace.windows import Layout

_MARGIN = 2.5
"""Over the square root of the number of correlations: how far, in parts, chance takes the largest beyond its limit."""
_GAPS = 3
_GAP = 1.2
"""So many places where singular values fall by more than this factor are tried besides the last that stands out."""
_WORSE = 0.03
"""A smaller order is preferred while its errors are larger by no more than this part."""


@dataclass(frozen=True)
class Candidate:
    """An order that was tried.

    Parameters
    ----------
    order : int
    free_run, one_step : float, %
        100 less the error in parts of the outputs' spread (2.7), all outputs together, before the gain is refined.
    """

    order: int
    free_run: float
    one_step: float


def standing_out(triangle: np.ndarray, layout: Layout, windows: int) -> int:
    """Count the canonical correlations of past and future that independent noise does not have.

    Beside n true ones, the largest of noise is known from the sizes alone.  Gaps between singular values are not
    looked at.

    Parameters
    ----------
    triangle : array, shape (rows, rows), 1
    layout : Layout
    windows : int

    Source
    ------
    Wachter 1980, "The limiting empirical measure of multiple discriminant ratios", Ann. Stat. 8, 937-957.
    """
    _, past, future = layout.parts
    explained, left = triangle[future, past], triangle[future, future]
    try:
        root = cholesky(explained @ explained.T + left @ left.T, lower=True)
        correlations = svd(solve_triangular(root, explained, lower=True), compute_uv=False)
    except LinAlgError:
        return _rank(explained)
    for order, correlation in enumerate(correlations):
        rows, columns = layout.future * layout.outputs - order, explained.shape[1] - order
        free = windows - layout.future * layout.inputs - order
        if not correlation > (1 + _MARGIN / np.sqrt(min(rows, columns))) * _noise_edge(rows / free, columns / free):
            return order
    return len(correlations)


def candidates(compressed: Compressed, data: Signals, terms: Terms) -> tuple[Candidate, ...]:
    """Try the order that stands out of the noise, and smaller ones where the singular values fall.

    Parameters
    ----------
    compressed : Compressed
    data : Signals
    terms : Terms

    Returns
    -------
    tuple of Candidate
        By rising order.
    """
    layout = compressed.layout
    limit = max(1, min(standing_out(compressed.triangle, layout, compressed.windows), layout.largest_order))
    values = compressed.projection.singular_values
    falls = values[: limit - 1] / np.maximum(values[1:limit], np.finfo(float).tiny)
    steepest = np.argsort(-falls)[:_GAPS]
    orders = sorted({limit, *(int(place) + 1 for place in steepest if falls[place] > _GAP)})
    power = data.samples * layout.outputs
    tried = []
    for order in orders:
        found = estimate(compressed, order, data.drives, data.responses, terms)
        free = found.left / power
        ahead = min(free, float(np.trace(found.gain.innovation)) / layout.outputs)
        tried.append(Candidate(order, 100 * (1 - free**0.5), 100 * (1 - ahead**0.5)))
    return tuple(tried)


def proposed(tried: tuple[Candidate, ...]) -> int:
    """Return the smallest order whose errors are hardly larger than the smallest of any."""
    free, ahead = (100 - np.array([getattr(each, name) for each in tried]) for name in ("free_run", "one_step"))
    good = (free <= (1 + _WORSE) * free.min()) & (ahead <= (1 + _WORSE) * ahead.min())
    return tried[int(np.argmax(good)) if good.any() else -1].order


def _noise_edge(small: float, large: float) -> float:
    """Return the largest canonical correlation of independent noise whose sizes are such parts of the sample."""
    return float(np.sqrt(small * (1 - large)) + np.sqrt(large * (1 - small))) if small + large < 1 else 1.0


def _rank(explained: np.ndarray) -> int:
    return int(np.linalg.matrix_rank(explained, rtol=1e-8))
