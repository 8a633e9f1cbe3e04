"""What an innovation model's matrices, names and units must be, and what is said when they are not."""

from collections.abc import Mapping

import numpy as np

MATRICES = ("A", "B", "C", "D", "K", "innovation")
_ROUNDING = 1e-9
"""Of a covariance, relative to its largest entry."""


def check_matrices(parts: Mapping[str, np.ndarray]) -> None:
    """Refuse matrices, named as in `MATRICES`, whose sizes do not fit together or whose values are not usable.

    Parameters
    ----------
    parts : mapping of arrays, any shape and any unit

    Raises
    ------
    ValueError : with the name of the first such matrix, what it is and what it must be.
    """
    if parts["B"].ndim != 2 or parts["C"].ndim != 2:
        raise ValueError(f"B has shape {parts['B'].shape} and C {parts['C'].shape}, must be (n, m) and (p, n)")
    order, inputs = parts["B"].shape
    outputs = len(parts["C"])
    if not outputs:
        raise ValueError("the model has 0 outputs, must have at least one")
    shapes = ((order, order), (order, inputs), (outputs, order), (outputs, inputs), (order, outputs))
    for name, shape in zip(MATRICES, (*shapes, (outputs, outputs)), strict=True):
        if parts[name].shape != shape:
            raise ValueError(f"{name} has shape {parts[name].shape}, must be {shape}")
        if not np.isfinite(parts[name]).all():
            place = np.argwhere(~np.isfinite(parts[name]))[0].tolist()
            raise ValueError(f"{name} is not finite at row {place[0]}, column {place[1]}")
    covariance = parts["innovation"]
    rounding = _ROUNDING * float(np.abs(covariance).max())
    if not np.abs(covariance - covariance.T).max() <= rounding:
        raise ValueError("innovation is not symmetric, must be a covariance")
    if not (least := float(np.linalg.eigvalsh(covariance)[0])) >= -rounding:
        raise ValueError(f"innovation has the eigenvalue {least:g}, must be a covariance: none below 0")


def check_words(side: str, names: tuple[str, ...], units: tuple[str, ...], count: int) -> None:
    """Refuse names that are not one for each of `count` signals and all different, or units that are not as many.

    Raises
    ------
    ValueError : with what they are and how many there must be.
    """
    if len(names) != count or len(set(names)) != count or not all(names):
        raise ValueError(f"{side}_names is {names}, must be {count} different names")
    if len(units) != count or not all(units):
        raise ValueError(f"{side}_units is {units}, must be {count} units")
