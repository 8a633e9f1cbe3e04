"""How a run may go: the learning itself, in lines, on vibrators drawn from what the model leaves open."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from vibractl.decibels import decibels
from vibractl.learning.edges import with_edges
from vibractl.learning.law import reference_level
from vibractl.learning.shot import Shot
from vibractl.predict.plant import DrawnPlant
from vibractl.quality import holds_from
from vibractl.setup import Setup, judged_lines
from vibractl.spectrum import LineSpectrum

HELD = 5
"""Shots in a row that meet the objective, after which a simulated run is taken to go on so."""
SEED = 20


@dataclass(frozen=True)
class Forecast:
    """Simulated runs.

    Parameters
    ----------
    met : array, shape (runs,), shots
        From which shot on the objective holds, counted from 0; infinite where it is not met in `shots`.
    worst : array, shape (shots, runs), dB
        Worst line over the limit; NaN after the end of a run.
    place : array, shape (runs,), Hz
        The worst line's when a run ends.
    drives : complex array, shape (runs, lines, inputs), V s
        Each run's last drive.
    """

    met: np.ndarray
    worst: np.ndarray
    place: np.ndarray
    drives: np.ndarray

    @property
    def shots(self) -> int:
        """Shots simulated at most."""
        return len(self.worst)

    def quantile(self, part: float) -> float:
        """Return the shot by which the objective is met in a part of the runs; infinite if it is not in so many."""
        return float(np.quantile(self.met, part, method="inverted_cdf"))


def forecast(made: Setup, runs: int, tell: Callable[[int], None]) -> Forecast:
    """Learn on vibrators as they may be, for at most `session.shots`.

    They are drawn in lines, and know no beginning and no end of a shot: their drives have no edges.

    Parameters
    ----------
    made : Setup
    runs : int, >= 1
    tell : callable
        Called with the number of runs done.
    """
    made = replace(made, law=with_edges(made.law, 0.0, 0.0, made.law.importance))
    law, shots = made.law, made.config.session.shots
    step = made.config.learning.decimation
    band = float(law.matrix.frequency[0]), float(law.matrix.frequency[-1])
    spectrum = LineSpectrum(made.shot.frames // step, law.matrix.outputs, made.shot.rate / step, band, made.plans)
    worst, place = np.full((shots, runs), np.nan), np.zeros(runs)
    met, drives = np.full(runs, np.inf), np.zeros((runs, *law.start.shape), complex)
    for run in range(runs):
        plant = DrawnPlant(law, spectrum, np.random.default_rng([SEED, run]))
        worst[:, run], place[run], drives[run] = _learned(made, plant)
        met[run] = _met(worst[:, run])
        tell(run + 1)
    return Forecast(met, worst, place, drives)


def _learned(made: Setup, plant: DrawnPlant) -> tuple[np.ndarray, float, np.ndarray]:
    """Return the worst line of each shot, where it is in the last, and the last drive."""
    law, judged, algorithm = made.law, judged_lines(made.law, made.reference, made.config), made.algorithm()
    limit = reference_level(_heard(made, law.reference)) * 10 ** (made.config.quality.objective / 20)
    worst = np.full(made.config.session.shots, np.nan)
    held, place = 0, 0.0
    for shot in range(len(worst)):
        drive, level = algorithm.lines, algorithm.level
        response = plant.respond(drive)
        over = decibels(_heard(made, level * law.reference - response)[judged] / limit).max(axis=1)
        place = float(law.matrix.frequency[judged][over.argmax()])
        worst[shot] = over.max() if level == 1.0 else max(over.max(), -float(decibels(level)))
        held = held + 1 if worst[shot] <= 0 else 0
        if held == HELD or not np.isfinite(worst[shot]):
            break
        algorithm.step(Shot(drive, response, plant.noise))
    return worst, place, drive


def _heard(made: Setup, lines: np.ndarray) -> np.ndarray:
    """Return lines (lines, sensors learned from) as they are where the objective must hold."""
    if made.judged is made.learned:
        return lines
    heard: np.ndarray = (made.judged.transfer[:, :, list(made.learned.sensors)] @ lines[..., None])[..., 0]
    return heard


def _met(worst: np.ndarray) -> float:
    """Return from which shot on the objective holds; infinite if it does not."""
    first = holds_from((worst[~np.isnan(worst)] <= 0).tolist())
    return np.inf if first is None else float(first)
