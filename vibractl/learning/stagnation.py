"""Whether shots still get better, and if they do not, what stands in the way; whether they get worse."""

import numpy as np

from vibractl.learning.algorithm import Algorithm
from vibractl.learning.decision import Decision, tidy
from vibractl.learning.disturbance import noise_reach
from vibractl.learning.shot import Shot

WAIT = 6
"""Shots in a row without gain after which learning stands still."""
GAIN = 1.0
"""dB by which a shot must be better than the best before."""
GROWN, GROWING = 10.0, 2
"""dB above the first shot at full level, and shots in a row of so much, from which on errors grow."""
LARGE = 0.5
"""Of the error's power: by so much distortion may change until the reference's own lines are right."""


class Stagnation:
    """Follows the worst line of shot after shot.

    Attributes
    ----------
    text : str
        Why learning stands still, or by how much errors grow; nothing while neither is so.
    """

    def __init__(self) -> None:
        self.text = ""
        self._best, self._since = np.inf, 0
        self._first: float | None = None
        self._grown = 0

    def take(
        self, over_db: float, hz: float, shot: Shot, algorithm: Algorithm, is_hidden: bool = False
    ) -> Decision | None:
        """Take a shot that was learned from; return the decision by which it is told that no shot gets better.

        Parameters
        ----------
        over_db : float, dB
            Of its worst judged line, over the limit.
        hz : float, Hz
            Where that is.
        shot : Shot
        algorithm : Algorithm
            After it.
        is_hidden : bool
            Whether the ambience may explain all that is over the limit.
        """
        if self._first is None and algorithm.level == 1.0:
            self._first = over_db
        grows = self._first is not None and over_db > max(self._first, 0.0) + GROWN and not is_hidden
        self._grown = self._grown + 1 if grows else 0
        if self._first is not None and self._grown >= GROWING:
            said, self._since = self._grown > GROWING, self._since + 1
            self.text = (
                f"errors grow, from {self._first:.0f} to {over_db:.0f} dB over the limit: the response differs from "
                "the model; calibrate again"
            )
            fields = {"over_db": tidy(over_db), "first_db": tidy(self._first), "at_hz": tidy(hz)}
            return None if said else Decision("errors_grow", fields)
        if over_db <= 0 or over_db < self._best - GAIN:
            self._best, self._since, self.text = over_db, 0, ""
            return None
        self._since += 1
        if self._since < WAIT:
            return None
        said = bool(self.text)
        self.text = f"learning has stalled: {_reason(hz, shot, algorithm, is_hidden)}"
        if said:
            return None
        return Decision("stands_still", {"over_db": tidy(over_db), "at_hz": tidy(hz), "because": self.text})


def _reason(hz: float, shot: Shot, algorithm: Algorithm, is_hidden: bool) -> str:
    """Say what stands in the way at the line of a frequency, Hz."""
    law, daring = algorithm.law, algorithm.daring
    frequency = law.matrix.frequency
    line = int(np.argmin(np.abs(frequency - hz)))
    where = f"at {hz:.1f} Hz"
    hidden = f"noise and hum {where} are about as strong as the error"
    if is_hidden:
        return hidden
    if abs(frequency[line] - hz) > 0.5 * (frequency[1] - frequency[0]) or not daring.is_open[line]:
        return f"nothing is learned {where}"
    error = law.reference - shot.response
    if np.all(np.abs(error[line]) ** 2 <= noise_reach(shot.noise[line], len(frequency))):
        return hidden
    follows = algorithm.belief.disturbance(shot, daring.nominal * error)[line] - shot.noise[line].sum()
    if follows < LARGE * float(np.sum(np.abs(error[line]) ** 2)):
        bound = f"the bound on what is left of an error is {daring.certificate[line]:.2f}"
        return f"{where} the error returns after each update: the plant changes, or differs from the model ({bound})"
    strong = algorithm.belief.strong
    off = np.linalg.norm(error[strong]) / np.linalg.norm(law.reference[strong])
    return f"distortion {where} follows the reference's own bins, whose error is still {100 * off:.0f} % off"
