"""A polygon of straight sides in space with its corners blended into arcs, by the way along it."""

import numpy as np

STEP = 5e-6
"""m between two points of a path."""


def rounded(corners: np.ndarray, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Return points along a path, and how far along it they are.

    Every corner becomes an arc of `radius`, of less where its sides are too short: an arc takes no more than half of
    a side.

    Parameters
    ----------
    corners : array, shape (corners, 3), m
        Where it begins, its corners, where it ends; no two in a row alike.
    radius : float, m, > 0

    Returns
    -------
    points : array, shape (N, 3), m, at most `STEP` apart
    way : array, shape (N,), m, rising from 0
    """
    corners = np.asarray(corners, float)
    parts, at = [corners[:1]], corners[0]
    for before, corner, after in zip(corners, corners[1:], corners[2:], strict=False):
        back, on = (side / np.linalg.norm(side) for side in (before - corner, after - corner))
        half = 0.5 * np.arccos(np.clip(back @ on, -1.0, 1.0))
        if np.cos(half) < 1e-4:  # straight on
            continue
        sides = np.linalg.norm(before - corner), np.linalg.norm(after - corner)
        cut = min(radius / np.tan(half), *(0.5 * side for side in sides))
        first, last = corner + cut * back, corner + cut * on
        parts += [_line(at, first), _arc(first, last, corner, cut * np.tan(half))]
        at = last
    parts.append(_line(at, corners[-1]))
    points = np.concatenate(parts)
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    return points, way


def _line(first: np.ndarray, last: np.ndarray) -> np.ndarray:
    count = max(1, int(np.ceil(np.linalg.norm(last - first) / STEP)))
    part = np.arange(1, count + 1)[:, None] / count
    return np.asarray(first + part * (last - first))


def _arc(first: np.ndarray, last: np.ndarray, corner: np.ndarray, radius: float) -> np.ndarray:
    """Return an arc that begins and ends along the lines from both ends to the corner, without its first point."""
    middle = 0.5 * (first + last)
    towards = (middle - corner) / np.linalg.norm(middle - corner)
    centre = corner + towards * np.hypot(radius, np.linalg.norm(first - corner))
    start, end = (first - centre) / radius, (last - centre) / radius
    angle = np.arccos(np.clip(start @ end, -1.0, 1.0))
    count = max(2, int(np.ceil(angle * radius / STEP)))
    part = np.arange(1, count + 1)[:, None] / count
    weights = np.sin((1 - part) * angle) * start + np.sin(part * angle) * end
    return np.asarray(centre + radius * weights / np.sin(angle))
