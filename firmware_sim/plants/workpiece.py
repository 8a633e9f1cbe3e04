"""A fresh block of material, as the kernels of a workpiece have it."""

from math import ceil

import numpy as np

from firmware_sim.plants.workpiece_kernel import GRID

LARGEST = 2e7
"""Points of a block."""


def fresh_block(
    length: float, width: float, thickness: float, cell: float, layer: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the distances to a block's own sides, shape (y, x, layers), m, float32, and the grid of the kernels.

    Parameters
    ----------
    length, width, thickness : float, m, along x, y and z
    cell, layer : float, m, of the grid
    """
    columns, rows = (ceil(0.5 * side / cell) + 2 for side in (length, width))
    layers = max(1, round(thickness / layer))
    x, y = (np.arange(-n, n + 1) * cell for n in (columns, rows))
    away = np.minimum(0.5 * length - np.abs(x)[None, :], 0.5 * width - np.abs(y)[:, None])
    distance = np.repeat(away[:, :, None].astype(np.float32), layers, axis=2)
    return distance, np.array([(cell, thickness / layers, columns * cell, rows * cell)], GRID)
