"""How many states stand out of the noise."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError, cholesky, solve_triangular, svd

from calibration.subspace.windows import Layout

_MARGIN = 2.5
"""Over the square root of the number of correlations: how far, in parts, chance takes the largest beyond its limit."""


@dataclass(frozen=True)
class Candidate:
    """An order that was tried.

    Parameters
    ----------
    order : int
    free_run, one_step : float, %
        100 less the error in parts of the outputs' spread (2.7), all outputs together, on records or parts of them that
        the model was not identified from.
    horizon : int, samples
    """

    order: int
    free_run: float
    one_step: float
    horizon: int

    @property
    def error(self) -> float:
        """Product of both errors, in parts of the outputs' spread: what counts where several are compared."""
        return (1 - self.free_run / 100) * (1 - self.one_step / 100)


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


def _noise_edge(small: float, large: float) -> float:
    """Return the largest canonical correlation of independent noise whose sizes are such parts of the sample."""
    return float(np.sqrt(small * (1 - large)) + np.sqrt(large * (1 - small))) if small + large < 1 else 1.0


def _rank(explained: np.ndarray) -> int:
    return int(np.linalg.matrix_rank(explained, rtol=1e-8))
