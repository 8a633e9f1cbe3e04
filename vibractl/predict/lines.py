"""Where convergence is not certified, line by line, and what stands in the way."""

from dataclasses import dataclass

import numpy as np

from vibractl.learning.daring import DEVIATIONS
from vibractl.setup import Setup, judged_lines
from vibractl.transfer_matrix import contraction

REASONS = ("outside the model", "too few coils", "regularisation", "near singular", "variance", "doubt")
"""In the order in which they are looked for."""
MEANINGS = {
    "outside the model": "judged, but not learned: beyond learning.band",
    "too few coils": "fewer coils than accelerometers: part of the error cannot be reached",
    "regularisation": "the weakest direction is learned at less than half the gain, see learning.epsilon and floor",
    "near singular": "G's weakest direction is ten times weaker than its strongest: small errors count tenfold",
    "variance": "the model is too uncertain for the gain",
    "doubt": "certified by the model, not with adaptation.doubt, by which G while a sweep passes may differ",
}
CONDITION = 10.0
"""Ratio of singular values from which a matrix counts as near singular."""
HALF = 0.5
"""Part of the gain below which regularisation is the reason."""


@dataclass(frozen=True)
class Certificates:
    """The bound on what the first update leaves of the error, and what stands in the way of one below 1.

    Parameters
    ----------
    frequency : array, shape (lines,), Hz
        Learned lines, and judged ones beyond.
    bound : array, shape (lines,), 1
        Infinite on lines that are not learned.
    reason : array of str, shape (lines,)
        One of `REASONS`; empty where the bound is below 1.
    """

    frequency: np.ndarray
    bound: np.ndarray
    reason: np.ndarray

    @property
    def certified(self) -> np.ndarray:
        """Which lines are certified to converge, bool (lines,)."""
        below: np.ndarray = self.bound < 1
        return below

    @property
    def learned(self) -> np.ndarray:
        """Which lines are learned, bool (lines,); the others are only judged."""
        inside: np.ndarray = self.reason != REASONS[0]
        return inside

    def ranges(self) -> list[tuple[float, float, str, float]]:
        """Return the uncertified lines by neighbours of one reason: first, last, Hz, reason, largest bound."""
        found = []
        edges = np.flatnonzero(self.reason[1:] != self.reason[:-1]) + 1
        for part in np.split(np.arange(len(self.reason)), edges):
            if self.reason[part[0]]:
                ends = float(self.frequency[part[0]]), float(self.frequency[part[-1]])
                found.append((*ends, str(self.reason[part[0]]), float(self.bound[part].max())))
        return found


def certificates(made: Setup) -> Certificates:
    """Bound the first update at every line, and say what stands in the way where the bound is not below 1.

    Parameters
    ----------
    made : Setup

    Source
    ------
    Sörnmo 2015, eq. (6.12), (6.18), with the model's uncertainty: `transfer_matrix.contraction`.
    """
    algorithm, law = made.algorithm(), made.law
    learned = law.active > 0
    bound = algorithm.daring.certificate[learned]
    response, inverse = law.matrix.response[learned], law.inverse[learned]
    reason = _reasons(response, inverse, law.matrix.variance[learned], algorithm.daring.gain[learned])
    reason[bound < 1] = ""
    beyond = _beyond(made)
    frequency = np.concatenate([law.matrix.frequency[learned], beyond])
    order = np.argsort(frequency)
    bound = np.concatenate([bound, np.full(len(beyond), np.inf)])
    reason = np.concatenate([reason, np.full(len(beyond), REASONS[0])])
    return Certificates(frequency[order], bound[order], reason[order])


def _reasons(response: np.ndarray, inverse: np.ndarray, variance: np.ndarray, gain: np.ndarray) -> np.ndarray:
    """Return what stands in the way of each line, were it not certified."""
    size = np.linalg.svd(response, compute_uv=False)
    weakest = np.linalg.svd(response @ inverse, compute_uv=False)[:, -1]  # part of the gain that is left to it
    by_model = contraction(response, variance, inverse, gain, DEVIATIONS)
    few = np.full(len(gain), response.shape[2] < response.shape[1])
    cases = [few, weakest < HALF, size[:, 0] >= CONDITION * size[:, -1], ~(by_model < 1)]
    reason: np.ndarray = np.select(cases, REASONS[1:5], REASONS[5])
    return reason


def _beyond(made: Setup) -> np.ndarray:
    """Return the judged lines that are not learned, Hz: of a sine its overtones, else the grid's."""
    quality, frequency = made.config.quality, made.law.matrix.frequency
    if made.reference.root is not None:
        overtones = made.reference.root * np.arange(2, made.config.learning.overtones + 2)
        learned = frequency[judged_lines(made.law, made.reference, made.config)]
        apart = overtones[overtones <= quality.judged_to]
        return apart[[not np.any(np.abs(learned - line) < 1e-3) for line in apart]]
    spacing = frequency[1] - frequency[0]
    grid = np.arange(np.ceil(quality.above / spacing - 1e-9), np.floor(quality.judged_to / spacing + 1e-9) + 1)
    lines: np.ndarray = grid * spacing
    outside: np.ndarray = lines[(lines < frequency[0] - spacing / 2) | (lines > frequency[-1] + spacing / 2)]
    return outside
