"""What is watched while a run learns: bands that diverge are reidentified, and frozen where that does not help."""

from dataclasses import dataclass

import numpy as np

from vibractl import config
from vibractl.learning.belief import Belief
from vibractl.learning.decision import Decision, tidy
from vibractl.learning.law import Law
from vibractl.learning.reidentify import LEAST, Probe, Reidentification, probe
from vibractl.learning.shot import Shot
from vibractl.learning.watch import Trouble, Watch
from vibractl.transfer_matrix import contraction, norm

DOUBT = 1.0
"""Of its size: how uncertain G is where a band has diverged."""


@dataclass(frozen=True)
class Sighting:
    """What one look has found.

    Parameters
    ----------
    decisions : tuple of Decision
    drive : complex array, shape (lines, inputs), V s, optional
        The first of a reidentification, to be made instead of learning.
    frozen : bool array, shape (lines,), optional
        Lines on which nothing is to be learned any more.
    """

    decisions: tuple[Decision, ...] = ()
    drive: np.ndarray | None = None
    frozen: np.ndarray | None = None


class Lookout:
    """Looks at every shot's error, and leads the reidentifications.

    Parameters
    ----------
    law : Law
    watching : config.Watch
    limit : float, m/s^2 s
        Of the objective.

    Source
    ------
    Sörnmo 2015, eq. (6.20)-(6.23).
    """

    def __init__(self, law: Law, watching: config.Watch, limit: float) -> None:
        self._law, self._watching, self._limit = law, watching, limit
        self._watch = Watch(law, watching, limit)
        self._running: Reidentification | None = None
        self._treated: list[float] = []

    @property
    def probing(self) -> np.ndarray | None:
        """The next drive of a reidentification under way, (lines, inputs), V s; None where there is none."""
        return None if self._running is None else self._running.drive

    def look(self, shot: Shot, error: np.ndarray, bound: np.ndarray, belief: Belief) -> Sighting:
        """Judge a shot; begin to reidentify a band, or freeze it when that has been done often enough.

        Parameters
        ----------
        shot : Shot
        error : complex array, shape (lines, outputs), m/s^2 s
        bound : array, shape (lines,), m/s^2 s
            How large it was expected to be at most.
        belief : Belief
        """
        trouble = self._watch.judged(shot.drive, error, bound)
        if trouble is None:
            return Sighting()
        frequency = self._law.matrix.frequency
        near = np.abs(frequency - trouble.centre) <= self._watching.half_width
        band = {"band_hz": [tidy(frequency[near][0]), tidy(frequency[near][-1])], "at_hz": tidy(trouble.centre)}
        diverges = Decision("divergence", {**band, "test": trouble.test, **trouble.values})
        if self._rounds(trouble) >= self._watching.rounds:
            self._watch.dismiss(near)
            return Sighting((diverges, Decision("frozen", {**band, "rounds": self._watching.rounds})), frozen=near)
        made = self._probe(trouble, error, belief)
        self._treated.append(trouble.centre)
        self._running = Reidentification(made, trouble.centre, shot, self._watching.input == "zeroed")
        begun = Decision("reidentify", {**band, "shots": len(made.lines)})
        return Sighting((diverges, begun), drive=self._running.drive)

    def take(self, shot: Shot, belief: Belief, gain: float) -> tuple[Shot, Decision] | None:
        """Take a shot of the reidentification; after the last one correct the belief.

        Parameters
        ----------
        shot : Shot
        belief : Belief
        gain : float, 1
            Of the updates, for what is told.

        Returns
        -------
        the shot from which it began, to be learned from, and what has come of it; None before the last one
        """
        running = self._running
        assert running is not None  # its shots are taken by `take`, others are looked at by `look`
        if not running.take(shot):
            return None
        before, old, repeats = belief.response.copy(), belief.inverse, running.repeatability
        evidence = ((step, change, noise + repeats) for step, change, noise in running.evidence())
        belief.relearn(running.probe.inside, DOUBT, evidence)
        self._watch.forgive(running.centre)
        self._running = None
        return running.base, _gained(running.probe, before, old, belief, gain)

    def _rounds(self, trouble: Trouble) -> int:
        """Return how often its band has been reidentified."""
        return sum(abs(centre - trouble.centre) <= self._watching.half_width for centre in self._treated)

    def _probe(self, trouble: Trouble, error: np.ndarray, belief: Belief) -> Probe:
        watching, law = self._watching, self._law
        room = np.maximum(self._limit - np.abs(error).max(axis=1), LEAST * self._limit) * law.active
        return probe(
            law.matrix.frequency,
            belief.response,
            belief.variance,
            room,
            trouble.centre,
            watching.half_width,
            watching.share,
        )


def _gained(probed: Probe, before: np.ndarray, old: np.ndarray, belief: Belief, gain: float) -> Decision:
    """Say how far G has moved in the band, and what its error map was with the old inverse and is with the new."""
    inside = probed.inside
    now = belief.response[inside]
    moved, sure = norm(now - before[inside]) / norm(before[inside]), np.zeros(now.shape)
    was, will = (contraction(now, sure, inverse[inside], gain).max() for inverse in (old, belief.inverse))
    fields = {"band_hz": [tidy(edge) for edge in probed.band], "moved": tidy(np.median(moved))}
    return Decision("reidentified", {**fields, "contraction_before": tidy(was), "contraction_after": tidy(will)})
