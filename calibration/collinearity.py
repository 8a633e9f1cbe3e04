"""Whether drives can be told apart: how strong the weakest combination of them is beside the strongest."""

import numpy as np

TOGETHER = 1e-3
"""The weakest combination of drives over the strongest, in power, below which they go together: errors are 16 times
those with independent drives there."""


def together(power: np.ndarray) -> np.ndarray:
    """Return the weakest combination of drives over the strongest, in power, each in units of its own.

    Parameters
    ----------
    power : complex array, shape (..., drives, drives), products of the drives' units
        Hermitian: spectra, or sums of products.

    Returns
    -------
    array, shape (...), 0 to 1
        0 where they go together.

    Examples
    --------
    >>> float(together(np.array([[1.0, 1.2], [1.2, 1.44]])).__round__(9))
    0.0
    """
    values = np.linalg.eigvalsh(in_own_units(power))
    part: np.ndarray = np.clip(values[..., 0] / np.maximum(values[..., -1], np.finfo(float).tiny), 0.0, 1.0)
    return part


def in_own_units(power: np.ndarray) -> np.ndarray:
    """Return products of drives with each drive in units of its own root mean square.

    Parameters
    ----------
    power : complex array, shape (..., drives, drives), products of the drives' units
        Hermitian.

    Returns
    -------
    complex array, shape (..., drives, drives), 1
        Ones on the diagonal, or zeros where a drive is at rest.
    """
    size = np.sqrt(np.maximum(np.real(np.einsum("...ii->...i", power)), 0.0))
    size = np.where(size > 0, size, 1.0)
    scaled: np.ndarray = power / (size[..., :, None] * size[..., None, :])
    return scaled
