"""The path of a trial as a Block: joint angles sample by sample, and a way out of the material at any moment."""

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.link.tell import Tell, nobody


class TrialPath(Block):
    """Play a path and its correction; on `retreat` stop where it is and lift the tool.

    Ports: `sent` (m, 3), the path in the workpiece, `nominal` (rad, 6), the joints of the path wanted, `correction`
    (rad, 6), what learning adds to them, `retreating` (1 from a retreat on), and `resting` (1 while the tool rests in
    the air) out.

    Parameters
    ----------
    sent : array, shape (N, 3), m
    nominal, correction, raised : arrays, shape (N, 6), rad
        `raised` has the same path with the tool lifted to its clearance.
    seconds : float, s
        In which a retreat lifts the tool.
    moves : (float, float), s
        When the path begins to move, and rests again.
    tell : callable(event, fields)
        Told of a retreat.
    """

    outputs = (
        Port("sent", "m", 3), Port("nominal", "rad", 6), Port("correction", "rad", 6), Port("retreating"),
        Port("resting"),
    )  # fmt: skip

    def __init__(
        self,
        sent: np.ndarray,
        nominal: np.ndarray,
        correction: np.ndarray,
        raised: np.ndarray,
        seconds: float,
        moves: tuple[float, float],
        tell: Tell = nobody,
    ) -> None:
        self._sent, self._nominal, self._correction, self._raised = sent, nominal, correction, raised
        self._seconds, self._moves, self._tell = seconds, moves, tell
        self.reason = ""

    def prepare(self, rate: float, frames: int) -> None:
        """Begin at the path's first sample."""
        self._at, self._lifted, self._steps, self.reason = 0, 0, max(1, round(self._seconds * rate)), ""
        self._begins, self._ends = (round(each * rate) for each in self._moves)

    def process(
        self,
        sent: np.ndarray,
        nominal: np.ndarray,
        correction: np.ndarray,
        retreating: np.ndarray,
        resting: np.ndarray,
    ) -> None:
        """Go on for one frame; after the end stay there."""
        for n in range(len(nominal)):
            at = min(self._at, len(self._nominal) - 1)
            up = 0.5 - 0.5 * np.cos(np.pi * min(1.0, self._lifted / self._steps))
            nominal[n] = self._nominal[at] + up * (self._raised[at] - self._nominal[at])
            sent[n], correction[n], retreating[n, 0] = self._sent[at], self._correction[at], bool(self.reason)
            resting[n, 0] = not self.reason and not self._begins <= self._at < self._ends
            if self.reason:
                self._lifted += 1
            else:
                self._at += 1

    def retreat(self, reason: str) -> None:
        """Leave the material from where the tool is; the first reason counts."""
        if not self.reason:
            self.reason = reason
            self._tell("retreat", {"reason": reason})
