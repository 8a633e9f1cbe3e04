"""Reidentification of a band while the reference goes on being emitted: a quiet chirp on one input after the other."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import maximum_filter1d

from vibractl.learning.shot import Shot

LEAST = 0.3
"""Part of the limit that a probe is given even where the error takes up all of it."""
EDGE = 0.3
"""Of the band, over which a probe fades in and out."""
DEVIATIONS = 2.0
"""Standard deviations of G that the probe's amplitude allows for."""


@dataclass(frozen=True)
class Probe:
    """The chirps of one reidentification.

    Parameters
    ----------
    band : (float, float), Hz
    lines : complex array, shape (inputs, lines), V s
        What is added to each input, one after the other.
    """

    band: tuple[float, float]
    lines: np.ndarray

    @property
    def inside(self) -> np.ndarray:
        """Which lines it reaches, bool (lines,)."""
        reached: np.ndarray = np.any(self.lines != 0, axis=0)
        return reached

    def added(self, coil: int) -> np.ndarray:
        """Return what is added to the drive, (lines, inputs), when `coil` is probed."""
        step = np.zeros(self.lines.shape[::-1], complex)
        step[:, coil] = self.lines[coil]
        return step


class Reidentification:
    """The shots of one reidentification: the drive of an earlier shot, and the probe on one input after the other.

    Parameters
    ----------
    probe : Probe
    centre : float, Hz
    base : Shot
        The earlier shot.
    zeroed : bool
        Take the drive of the band away meanwhile, as the text says: then the change of response is not the chirp's
        alone, and the estimate is wrong.
    """

    def __init__(self, probe: Probe, centre: float, base: Shot, zeroed: bool) -> None:
        self.probe, self.centre, self.base = probe, centre, base
        self._under = np.where(probe.inside[:, None], 0.0, base.drive) if zeroed else base.drive
        self._heard: list[Shot] = []

    @property
    def drive(self) -> np.ndarray:
        """The next drive, (lines, inputs), V s."""
        drive: np.ndarray = self._under + self.probe.added(len(self._heard))
        return drive

    def take(self, shot: Shot) -> bool:
        """Take the shot made with `drive`; say whether it was the last."""
        self._heard.append(shot)
        return len(self._heard) == len(self.probe.lines)

    @property
    def repeatability(self) -> float:
        """The power, (m/s^2 s)^2, by which responses differ from shot to shot at an unchanged drive."""
        outside = ~self.probe.inside
        changes = [np.abs(change[outside]) ** 2 for _, change, _ in self.evidence()]
        return float(np.median(np.concatenate(changes)) / np.log(2))

    def evidence(self) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Yield of each shot what was added, how the response changed, and the noise in that, see `LineFilter.observe`.

        Returns
        -------
        iterator of arrays, shapes (lines, inputs), V s; (lines, outputs), m/s^2 s; (lines, outputs), (m/s^2 s)^2

        Source
        ------
        Sörnmo 2015, eq. (6.23).
        """
        for coil, shot in enumerate(self._heard):
            yield self.probe.added(coil), shot.response - self.base.response, shot.noise + self.base.noise


def probe(
    frequency: np.ndarray,
    response: np.ndarray,
    variance: np.ndarray,
    room: np.ndarray,
    centre: float,
    half_width: float,
    share: float,
) -> Probe:
    """Make the chirps for a band around `centre`.

    Parameters
    ----------
    frequency : array, shape (lines,), Hz
    response : complex array, shape (lines, outputs, inputs), m/s^2 per V
    variance : array, shape (lines, outputs, inputs), (m/s^2 per V)^2
    room : array, shape (lines,), m/s^2 s
        Up to where the probe's response may go at each line.
    centre, half_width : float, Hz
        f_ri and f_D.
    share : float, 1
        kappa: part of the room that is used.

    Returns
    -------
    Probe

    Source
    ------
    Sörnmo 2015, eq. (6.21), (6.22).

    Departs
    -------
    The chirp is made of lines with a quadratic phase: its frequency rises evenly over the shot as in (6.21), but its
    spectrum has no ripple, so that (6.22) holds at every line.  The largest |G| within a quarter of f_D counts, with
    two standard deviations: G has moved, or there would be no reidentification.
    """
    spacing = frequency[1] - frequency[0]
    place = (frequency - centre) / half_width
    inside = np.abs(place) <= 1
    shape = np.zeros(len(frequency))
    from scipy.signal.windows import tukey  # noqa: PLC0415 (takes half a second, and few runs come here)

    shape[inside] = tukey(int(inside.sum()) + 2, EDGE)[1:-1]
    # The group delay rises from a tenth to nine tenths of the shot, 1 / spacing, over the band.
    phase = -2 * np.pi * half_width / spacing * (0.5 * place + 0.2 * place**2)
    largest = (np.abs(response) + DEVIATIONS * np.sqrt(variance)).max(axis=1)
    reach = 2 * max(round(half_width / 4 / spacing), 1) + 1
    bound = maximum_filter1d(largest, reach, axis=0, mode="nearest")
    amplitude = share * shape[:, None] * room[:, None] / bound
    band = (float(frequency[inside][0]), float(frequency[inside][-1]))
    return Probe(band, (amplitude * np.exp(1j * phase)[:, None]).T)
