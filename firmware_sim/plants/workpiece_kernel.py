"""The compiled kernels of a block of material: how far each of its points is from what a tool has swept.

The block is a stack of layers, each a grid of distances (m): to the nearest place that the tool's flank has reached, or
the block's own side; below zero where there is no material.  Distances are smooth across a wall, so that the wall is
found between the points of the grid: bilinearly to some 0.1 um.
"""

import math

import numpy as np

from firmware_sim.plants.record import Record
from rigkit.compiled import njit

GRID = np.dtype(
    [
        # m
        ("cell", "f8"),  # between points
        ("layer", "f8"),  # of a layer
        ("left", "f8"),  # from the first point to the block's middle along x
        ("low", "f8"),  # and along y
    ],
    align=True,
)
RIM = 2.0
"""Points' distances to either side of the tool's flank that are renewed."""


@njit(cache=True, nogil=True)
def swept_layers(tip: float, layer: float, layers: int) -> int:
    """Return how many layers a tool takes whose tip is at `tip` (m, 0 at the top): those with the middle above it."""
    return min(max(math.floor(0.5 - tip / layer), 0), layers)


@njit(cache=True, nogil=True)
def sweep(
    distance: np.ndarray, grid: Record, x: float, y: float, radius: float, first: int, last: int, whole: bool
) -> None:
    """Take the tool at (x, y) out of layers `first` to `last`: all of it where `whole`, else near its flank.

    `distance` has shape (rows along y, columns along x, layers).
    """
    cell = grid.cell
    outer = radius + RIM * cell
    inner = 0.0 if whole else radius - RIM * cell
    rows, columns = distance.shape[0], distance.shape[1]
    low = max(math.ceil((y - outer + grid.low) / cell), 0)
    high = min(math.floor((y + outer + grid.low) / cell), rows - 1)
    for row in range(low, high + 1):
        across = row * cell - grid.low - y
        reach = math.sqrt(max(outer * outer - across * across, 0.0))
        hole = math.sqrt(max(inner * inner - across * across, 0.0))
        left = max(math.ceil((x - reach + grid.left) / cell), 0)
        right = min(math.floor((x + reach + grid.left) / cell), columns - 1)
        column = left
        while column <= right:
            along = column * cell - grid.left - x
            if abs(along) < hole:  # on to the other side
                column = max(column + 1, math.ceil((x + hole + grid.left) / cell))
                continue
            away = np.float32(math.sqrt(along * along + across * across) - radius)
            for k in range(first, last):
                distance[row, column, k] = min(distance[row, column, k], away)
            column += 1


@njit(cache=True, nogil=True)
def look(distance: np.ndarray, grid: Record, x: float, y: float, first: int, last: int, found: np.ndarray) -> None:
    """Fill `found` (layers,) with layers `first` to `last` of the distance at (x, y), m; below zero beside the grid."""
    u, v = (x + grid.left) / grid.cell, (y + grid.low) / grid.cell
    column, row = math.floor(u), math.floor(v)
    if column < 0 or row < 0 or column >= distance.shape[1] - 1 or row >= distance.shape[0] - 1:
        for k in range(first, last):
            found[k] = -1.0
        return
    u, v = u - column, v - row
    a, b, c, d = (1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v
    for k in range(first, last):
        found[k] = (
            a * distance[row, column, k]
            + b * distance[row, column + 1, k]
            + c * distance[row + 1, column, k]
            + d * distance[row + 1, column + 1, k]
        )
