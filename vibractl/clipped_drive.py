"""Whether the drives of a run are cut off behind the converter: looked for in every shot that is not good enough."""

import numpy as np
from scipy.fft import rfft

from vibractl.learning.clipping import Clipping, found_cut
from vibractl.learning.decision import Decision, tidy
from vibractl.learning.laws import strong_lines
from vibractl.learning.shot import Shot
from vibractl.setup import Setup, judged_lines
from vibractl.spectrum import Decimator

EVENT = "drive_cut_off"


class ClippedDrive:
    """Compares what the model leaves unexplained of a shot with what a cut drive would lack.

    It looks at learned lines that are judged, outside the reference's own, at the rate learned at.

    Parameters
    ----------
    made : Setup
    """

    def __init__(self, made: Setup) -> None:
        law, step = made.law, made.config.learning.decimation
        frequency = law.matrix.frequency
        spacing = frequency[1] - frequency[0] if len(frequency) > 1 else 1.0
        chosen = judged_lines(law, made.reference, made.config) & ~strong_lines(law.reference)
        self._bins = np.round(frequency[chosen] / spacing).astype(int)
        self._chosen, self._law, self._rate = chosen, law, made.shot.rate / step
        self._decimator, self._span = (
            Decimator(step),
            slice(made.shot.window.start // step, made.shot.window.stop // step),
        )
        self._response = law.matrix.response[chosen] @ np.linalg.pinv(law.spread)
        self._clipping = Clipping()

    @property
    def text(self) -> str:
        """Which drives are cut off, and where; nothing while none is."""
        return self._clipping.text

    def take(self, drive: np.ndarray, shot: Shot) -> Decision | None:
        """Look at a shot; return the decision by which it is told that drives are cut off.

        Parameters
        ----------
        drive : array, shape (samples, coils), V
            As it was emitted.
        shot : Shot
        """
        if not len(self._bins):
            return None
        played = self._decimator.apply(np.asarray(drive, dtype=float))[self._span]
        unexplained = shot.response[self._chosen] - self._heard(played)
        cut = self._clipping.take(found_cut(played, unexplained, self._heard))
        if cut is None:
            return None
        drives = [coil + 1 for coil in cut.coils]
        fields = {"drives": drives, "level": tidy(cut.level), "share": tidy(cut.share), "text": self.text}
        return Decision(EVENT, fields)

    def _heard(self, signal: np.ndarray) -> np.ndarray:
        """Return what the model says of a drive, (frames, coils) V at the rate learned at, on the lines looked at."""
        lines = rfft(self._law.window * signal, axis=0)[self._bins] / self._rate
        heard: np.ndarray = (self._response @ lines[..., None])[..., 0]
        return heard
