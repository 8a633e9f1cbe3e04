"""How accurate the toroid became: its circle as a coordinate measuring machine sees it, and its surface."""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d

STEP = 10e-6
"""m along the path between two points."""
TRAVERSE = 25e-3
"""m, over which a profile of the surface is measured [Sörnmo 2015, fig. 2.29]."""
CUTOFF = 2.5e-3
"""m: waves shorter than that are roughness [ISO 21920-3]."""
GAUSS = 0.4697 / np.sqrt(2 * np.pi)
"""Standard deviation of the profile filter's weights over its cut-off [ISO 16610-21]."""


@dataclass(frozen=True, eq=False)
class Contour:
    """A toroid as it was milled, at points `STEP` apart along its path.

    Parameters
    ----------
    angle : array, shape (points,), rad
        From y to z, rising.
    radial : array, shape (points,), m
        Too far out: of the outer contour, the circle fitted in place by least squares, its radius as it is to be.
    axial : array, shape (points,), m
        Too deep.
    radius : float, m
    """

    angle: np.ndarray
    radial: np.ndarray
    axial: np.ndarray
    radius: float


@dataclass(frozen=True)
class Accuracy:
    """A row of Table 2.3, and more, m.

    Parameters
    ----------
    circle_mae, circle_std, circle_max : float, m
        Mean absolute, standard and largest deviation of the outer contour.
    surface_std : float, m
        Standard deviation of the surface along the tool's axis, over traverses of 25 mm less a straight line each (root
        of the mean square of all); of a shorter path, over all of it.
    roughness : float, m
        Root mean square of its waves shorter than `CUTOFF`.
    """

    circle_mae: float
    circle_std: float
    circle_max: float
    surface_std: float
    roughness: float


def contour(cut: np.ndarray, radius: float) -> Contour:
    """Return the contour that a tool has left.

    Parameters
    ----------
    cut : array, shape (samples, 3), m
        Where it was in the workpiece, x y z, from the toroid's centre.
    radius : float, m
        Of the circle that was to be milled.

    Raises
    ------
    ValueError : it has not moved on by so much as ten points.
    """
    angle = np.maximum.accumulate(np.unwrap(np.arctan2(cut[:, 2], cut[:, 1])))
    points = int((angle[-1] - angle[0]) * radius / STEP)
    if points < 10:
        raise ValueError(f"the tool moved by {points * STEP:.3g} m, must be >= {10 * STEP:g} m to be measured")
    grid = angle[0] + STEP / radius * np.arange(points)
    forward = np.concatenate([[True], np.diff(angle) > 0])
    radial, axial = (
        np.interp(grid, angle[forward], each[forward]) for each in (np.hypot(cut[:, 1], cut[:, 2]) - radius, cut[:, 0])
    )
    if grid[-1] - grid[0] > np.pi:  # of a shorter arc the place cannot be told from the form
        place = np.column_stack([np.cos(grid), np.sin(grid)])
        radial = radial - place @ np.linalg.lstsq(place, radial, rcond=None)[0]
    return Contour(grid, radial, axial, radius)


def accuracy(milled: Contour) -> Accuracy:
    """Return the measures of a contour."""
    size = np.abs(milled.radial)
    return Accuracy(
        float(size.mean()),
        float(milled.radial.std()),
        float(size.max()),
        float(np.sqrt(np.mean(np.concatenate([part**2 for part in profiles(milled)])))),
        float(np.sqrt(np.mean(roughness(milled) ** 2))),
    )


def profiles(milled: Contour) -> list[np.ndarray]:
    """Return the surface in traverses of 25 mm, each less its straight line: arrays, shape (points,), m."""
    length = min(len(milled.axial), round(TRAVERSE / STEP))
    whole = milled.axial[: len(milled.axial) // length * length].reshape(-1, length)
    line = np.column_stack([np.ones(length), np.arange(length) / length])
    return [part - line @ np.linalg.lstsq(line, part, rcond=None)[0] for part in whole]


def roughness(milled: Contour) -> np.ndarray:
    """Return what of the surface is shorter than `CUTOFF`, shape (points,), m, by the Gaussian profile filter."""
    waves = gaussian_filter1d(milled.axial, GAUSS * CUTOFF / STEP, mode="nearest")
    return np.asarray(milled.axial - waves)
