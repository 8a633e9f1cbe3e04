"""The path from which G_R is identified: chirps along x, y and z, above the workpiece, on top of a steady feed."""

from dataclasses import dataclass

import numpy as np

from rigkit.fade import rise
from stagectl.experiments.trials.tool_path import RATE, ToolPath
from stagectl.robot.pocket_config import Pocket
from stagectl.robot.tool_path import ramped

RAMP = 0.3
"""s in which the feed begins and ends."""
SETTLE = 1.0
"""s of rest before each pass, and of steady feed before and after its chirp."""


@dataclass(frozen=True)
class ChirpPath:
    """Two passes a direction: forth with a rising chirp, to fit to, and back with a falling one, for validation.

    A joint that turns around sticks, and then it follows otherwise than in a cut, where it goes on.  So the chirp rides
    on a steady feed and is slower than that: no joint turns around.

    Parameters
    ----------
    feed : float, m/s
    share : float, 1, < 1
        Speed of the chirp over the feed.
    largest : float, m
        Amplitude at low frequency, where its speed would allow more.
    seconds : float, s, of each chirp
    start, stop : float, Hz
    height : float, m, above the workpiece, of the middle
    """

    feed: float
    share: float
    largest: float
    seconds: float
    start: float
    stop: float
    height: float

    def path(self, pocket: Pocket) -> ToolPath:
        """Return the whole path."""
        parts = [np.zeros((round(pocket.lead * RATE), 3))]
        for direction in np.eye(3):
            forth, back = self._forth() - 0.5 * self._way, 0.5 * self._way - self._forth()
            out, home = self._moved(-0.5 * self._way), self._moved(0.5 * self._way) - 0.5 * self._way
            for along in (out, forth + self.chirp(False), back + self.chirp(True), home):
                parts.append(along[:, None] * direction)
        parts.append(np.zeros((round(pocket.tail * RATE), 3)))
        return ToolPath(pocket, np.array([0.0, 0.0, self.height]) + np.concatenate(parts))

    def part(self, pocket: Pocket, axis: int, is_held_back: bool) -> slice:
        """Return where a direction's chirp is, from the middle of the steady feed before it on."""
        there, along = len(self._moved(-0.5 * self._way)), len(self._forth())
        begin = round(pocket.lead * RATE) + axis * (2 * there + 2 * along) + there + int(is_held_back) * along
        lead = round((SETTLE + RAMP + 0.5 * SETTLE) * RATE)
        return slice(begin + lead, begin + along - round((RAMP + 0.5 * SETTLE) * RATE))

    @property
    def before(self) -> int:
        """Samples of a part before its chirp begins."""
        return round(0.5 * SETTLE * RATE)

    def slope(self, is_held_back: bool) -> float:
        """Return the steady feed of a pass, m/s, with its sign."""
        return -self.feed if is_held_back else self.feed

    def chirp(self, is_falling: bool) -> np.ndarray:
        """Return a pass' chirp alone, shape (samples of the pass,), m."""
        time = np.arange(round(self.seconds * RATE)) / RATE
        frequency = self.start + (self.stop - self.start) * time / self.seconds
        turns = self.start * time + (self.stop - self.start) * time**2 / (2 * self.seconds)
        size = np.minimum(self.largest, self.share * self.feed / (2 * np.pi * frequency))
        chirp = size * np.sin(2 * np.pi * turns)
        fade = round(0.05 * len(chirp))
        chirp[:fade] *= rise(fade)
        chirp[len(chirp) - fade :] *= rise(fade)[::-1]
        found = np.zeros(len(self._forth()))
        begin = round((2 * SETTLE + RAMP) * RATE)
        found[begin : begin + len(chirp)] = chirp[::-1] if is_falling else chirp
        return found

    @property
    def _way(self) -> float:
        """Length of a pass, m."""
        return self.feed * (self.seconds + 2 * SETTLE + RAMP)

    def _forth(self) -> np.ndarray:
        """Return a pass without its chirp, m: rest, then the steady feed."""
        seconds = self.seconds + 2 * SETTLE + RAMP
        time = np.arange(round((SETTLE + seconds + RAMP) * RATE)) / RATE - SETTLE
        return self.feed * ramped(time, seconds, RAMP)

    def _moved(self, way: float) -> np.ndarray:
        """Return the way from 0 to `way`, m, at twice the feed."""
        seconds = abs(way) / (2 * self.feed)
        time = np.arange(round((seconds + RAMP) * RATE) + 1) / RATE
        return np.asarray(np.sign(way) * 2 * self.feed * ramped(time, seconds, RAMP))
