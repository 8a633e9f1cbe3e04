"""Drives that are cut off on their way: whether that is what a model leaves unexplained of a response."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

COARSE = 0.97 * 0.93 ** np.arange(12)
"""Of a drive's peak: levels that are tried first, ..."""
FINE = 0.93 ** np.linspace(-0.75, 0.75, 7)
"""... and around the best of them."""
SHARE = 0.4
"""Of the unexplained response's power, that the cut must explain at least, ..."""
NEAR = 0.3
"""... times 1 +- this: what distorts otherwise is alike, but another time as large, or turned."""
AGREED = 0.1
"""By which the levels of two shots may differ, relative to each other."""


@dataclass(frozen=True)
class Cut:
    """A cut that explains a response.

    Parameters
    ----------
    coils : tuple of ints
        Counted from 0.
    level : float, V
    share : float, 1
        Of the power of what is unexplained without it.
    """

    coils: tuple[int, ...]
    level: float
    share: float


@dataclass(frozen=True)
class _Fit:
    """The cut times `factor` is what explains most; `share` of it."""

    level: float
    factor: complex
    share: float


def found_cut(drive: np.ndarray, unexplained: np.ndarray, heard: Callable[[np.ndarray], np.ndarray]) -> Cut | None:
    """Find the level at which drives are cut off, one coil's or all coils' alike.

    Parameters
    ----------
    drive : array, shape (frames, coils), V
        As it was meant.
    unexplained : complex array, shape (lines, outputs), m/s^2 s
        Response less what the model says of the drive, on lines which hold little of the drive itself.
    heard : callable(array, shape (frames, coils)) -> complex array, shape (lines, outputs)
        What the model says of another drive there.

    Returns
    -------
    Cut, or None where none explains `SHARE` of it by as much as it takes away.
    """
    power = float(np.vdot(unexplained, unexplained).real)
    peaks = np.abs(drive).max(axis=0)
    if power <= 0 or not peaks.min() > 0:
        return None

    def fit(coils: tuple[int, ...], level: float) -> _Fit:
        cut = np.zeros_like(drive)
        chosen = list(coils)
        cut[:, chosen] = np.clip(drive[:, chosen], -level, level) - drive[:, chosen]
        lost = heard(cut)
        size = float(np.vdot(lost, lost).real)
        if size <= 0:
            return _Fit(level, 0j, 0.0)
        factor = complex(np.vdot(lost, unexplained)) / size
        return _Fit(level, factor, abs(factor) ** 2 * size / power)

    every = tuple(range(drive.shape[1]))
    coarse = {}
    for coils in dict.fromkeys([every, *((coil,) for coil in every)]):
        top = float(peaks[list(coils)].max())
        coarse[coils] = max((fit(coils, top * part) for part in COARSE), key=lambda each: each.share)
    coils = max(coarse, key=lambda each: coarse[each].share)
    if coarse[coils].share < SHARE / 2:
        return None
    found = max((fit(coils, coarse[coils].level * part) for part in FINE), key=lambda each: each.share)
    if found.share < SHARE or abs(found.factor - 1) > NEAR:
        return None
    return Cut(coils, found.level, found.share)


class Clipping:
    """Follows whether drives are cut off: two shots that show it must agree on the level.

    Attributes
    ----------
    text : str
        Which drives, and where; nothing while none is.
    """

    def __init__(self) -> None:
        self.text = ""
        self._last: Cut | None = None

    def take(self, cut: Cut | None) -> Cut | None:
        """Take what a shot shows; return it when it is believed for the first time."""
        last, self._last = self._last, cut or self._last
        if cut is None or last is None or cut.coils != last.coils:
            return None
        if abs(cut.level - last.level) > AGREED * last.level:
            return None
        said = bool(self.text)
        self.text = f"{_names(cut.coils)} cut off at about {cut.level:.3g} V, as by an amplifier that goes no further"
        return None if said else cut


def _names(coils: tuple[int, ...]) -> str:
    names = " and ".join(str(coil + 1) for coil in coils)
    return f"drives {names} are" if len(coils) > 1 else f"drive {names} is"
