"""What is believed of the vibrator: G with its uncertainty, how it moves, and what else changes a response."""

from collections.abc import Iterable

import numpy as np

from vibractl.config import Adaptation
from vibractl.learning.disturbance import Disturbance, smoothed
from vibractl.learning.law import Law, bounded_inverse
from vibractl.learning.line_filter import LineFilter
from vibractl.learning.shot import Shot
from vibractl.learning.stretch import Stretch
from vibractl.learning.update import update
from vibractl.learning.variation import Variation, swings_of

REACH = 10
"""Lines to each side over which powers are averaged."""

STEEPNESS = 4
"""Power of what G^+ leaves of a drive, by which it is let go: 0.0001 of it where a tenth is left, 0.66 where 0.9 is."""

Evidence = Iterable[tuple[np.ndarray, np.ndarray, np.ndarray]]
"""Steps of the drive (lines, inputs), V s; changes of the response (lines, outputs), m/s^2 s; E |v|^2 of those."""


class Belief:
    """The transfer matrix as it is believed now, and the drive that it asks for.

    With every part of `parts` off it stays the model, and the drive is the thesis' update.

    Parameters
    ----------
    law : Law
        Its matrix is believed at first.
    parts : Adaptation

    Attributes
    ----------
    inverse : complex array, shape (lines, inputs, outputs), V per m/s^2
        G^+.
    reach : int, lines
        To each side, over which powers are averaged; 0 where lines stand apart and say nothing of their neighbours.
    """

    def __init__(self, law: Law, parts: Adaptation) -> None:
        is_tonal, model = law.is_tonal, law.matrix
        neighbours = 0 if is_tonal else parts.neighbours
        linked = parts.model and neighbours > 0
        swings = swings_of(model.inputs) if parts.variation and linked else None
        couples = parts.model and not is_tonal
        variation = Variation(model.frequency, law.edge, law.rest, swings) if couples else None
        self._settings, self._parts = law.settings, parts
        self._filter = LineFilter(model.response, model.variance, parts.walk, parts.doubt, neighbours, variation)
        self._stretch = Stretch(model.frequency, model.response) if parts.stretch and linked else None
        self.reach = 0 if is_tonal else REACH
        self._disturbance = Disturbance(law.reference, parts.coupling, self.reach)
        self.inverse, self._weight = law.inverse, law.weight
        self._releases = law.counts_less
        self._before: Shot | None = None

    @property
    def before(self) -> Shot | None:
        """The last shot that was kept."""
        return self._before

    @property
    def response(self) -> np.ndarray:
        """G, (lines, outputs, inputs), m/s^2 per V."""
        return self._filter.response

    @property
    def variance(self) -> np.ndarray:
        """E |G_hat - G|^2, (lines, outputs, inputs), (m/s^2 per V)^2."""
        return self._filter.variance

    def explained(self, drive: np.ndarray) -> np.ndarray:
        """Return G U (lines, outputs), m/s^2 s, of lines U (lines, inputs), V s."""
        return self._filter.explained(drive)

    def emitted(self, drive: np.ndarray) -> np.ndarray:
        """Return what is emitted of lines (lines, inputs), V s: those of the drive with its edges."""
        return self._filter.emitted(drive)

    @property
    def strong(self) -> np.ndarray:
        """Lines of the reference's own band, bool (lines,): the others' distortion follows them."""
        return self._disturbance.strong

    @property
    def tones(self) -> np.ndarray:
        """Those of them that stand apart, bool (lines,): a sine's."""
        return self._disturbance.tones

    def noise(self, shot: Shot) -> np.ndarray:
        """Return E |N|^2 (lines,), (m/s^2 s)^2, of what is in a shot and in no other."""
        still = np.zeros_like(shot.noise)
        power: np.ndarray = self._disturbance.power(shot.noise, still, 0.0).sum(axis=1)
        return power

    def disturbance(self, shot: Shot, change: np.ndarray) -> np.ndarray:
        """Return E |v|^2 (lines,), (m/s^2 s)^2, of what changes a response by itself when G U changes by so much.

        At tones it is by how much G U may change otherwise.

        Parameters
        ----------
        shot : Shot
            The last one.
        change : complex array, shape (lines, outputs), m/s^2 s
        """
        share = self._disturbance.change(change, shot.response)
        power: np.ndarray = self._disturbance.power(shot.noise, np.abs(self._unexplained(shot)) ** 2, share).sum(axis=1)
        tones = self._disturbance.tones
        if tones.any():
            step = (self.inverse @ change[..., None])[..., 0]
            power = power + np.where(tones, self._filter.spread(step).sum(axis=1), 0.0)
        return power

    def follow(self, shot: Shot) -> None:
        """Correct G by what a shot shows beside the last one that was kept."""
        if not self._parts.model:
            return
        if self._before is None:
            self._doubt_tones(shot)
            return
        before = self._before
        step, change = shot.drive - before.drive, shot.response - before.response
        noise = self._noise_of(shot, before, step, change)
        if self._stretch is not None:
            surprise, played = change - self.explained(step), self.emitted(before.drive)
            shift = self._stretch.observe(played, surprise, noise + self._filter.spread(step))
            self._filter.shift(shift)
            change = change - (shift @ played[..., None])[..., 0]
        self._measure_coupling(shot, before, step, change)
        self._filter.observe(step, change, noise)
        self.inverse = bounded_inverse(self.response, self._settings)

    def keep(self, shot: Shot) -> None:
        """Keep a shot, for the next one to be compared with."""
        self._before = shot

    def relearn(self, lines: np.ndarray, doubt: float, evidence: Evidence) -> None:
        """Doubt G on some lines, bool (lines,), by a part `doubt` of its size, and learn it from experiments."""
        self._filter.forget(lines, doubt)
        for step, change, noise in evidence:
            self._filter.observe(step, change, noise)
        self.inverse = bounded_inverse(self.response, self._settings)

    def next_drive(self, drive: np.ndarray, error: np.ndarray, gain: np.ndarray, is_open: np.ndarray) -> np.ndarray:
        """Return the drive that is believed to take `gain` of the error away, and what the modes will do until then.

        Parameters
        ----------
        drive : complex array, shape (lines, inputs), V s
            That left the error.
        error : complex array, shape (lines, outputs), m/s^2 s
        gain : array, shape (lines,), 1
            Q2.
        is_open : array, shape (lines,), 1
            0 on lines whose drive stays.

        Source
        ------
        Sörnmo 2015, eq. (6.16), where G is steady.
        """
        coming = np.zeros_like(error)
        if self._stretch is not None:
            coming = (self._stretch.coming() @ self.emitted(drive)[..., None])[..., 0]
        if not self._filter.couples:
            return update(drive, self.inverse, error, gain)
        drive = drive - gain[:, None] * self._out_of_reach(drive)
        wanted, inverse = gain[:, None] * error - coming, self.inverse * is_open[:, None, None]
        changed: np.ndarray = drive + self._filter.step_for(wanted, inverse, self._weight)
        return changed

    def _out_of_reach(self, drive: np.ndarray) -> np.ndarray:
        """Return what is to be let go of a drive (lines, inputs), V s: what lies where G^+ hardly drives G.

        There the error would be learned for as long as a run lasts, by a drive that grows with every shot, and all that
        it disturbs with it.  So on lines that count least it ends where the part (I - G^+ G)^4 of the drive, taken
        away, is as large as what is added; a direction in which G^+ leaves less than a tenth of an error keeps it all.
        """
        left = np.eye(drive.shape[1]) - self.inverse @ self.response
        released: np.ndarray = (np.linalg.matrix_power(left, STEEPNESS) @ drive[..., None])[..., 0]
        released[~self._releases] = 0.0
        return released

    def _doubt_tones(self, shot: Shot) -> None:
        """Doubt G at tones by as much as it was off in the first shot: it was measured at another drive."""
        tones = self._disturbance.tones
        if tones.any():
            expected = float(np.linalg.norm(self.explained(shot.drive)[tones]))
            left = float(np.linalg.norm(self._unexplained(shot)[tones]))
            self._filter.forget(tones, left / max(expected, left, np.finfo(float).tiny))

    def drifted(self, shot: Shot) -> np.ndarray:
        """Return the power (lines, outputs), (m/s^2 s)^2, by which the plant's drift changes a response in a shot."""
        power: np.ndarray = (self._parts.drift * np.abs(self.explained(shot.drive))) ** 2
        return power

    def _measure_coupling(self, shot: Shot, before: Shot, step: np.ndarray, change: np.ndarray) -> None:
        """Measure by how many times distortion of the strong lines has changed as they have."""
        share = self._disturbance.change(shot.response - before.response, shot.response)
        surprise = np.abs(change - self.explained(step)) ** 2
        self._disturbance.observe(surprise, shot.noise + before.noise, self._distortion(shot, before), share)

    def _distortion(self, shot: Shot, before: Shot) -> np.ndarray:
        """Return the power (lines, outputs), (m/s^2 s)^2, of what G explains of neither of two shots."""
        power: np.ndarray = np.abs(self._unexplained(shot)) ** 2 + np.abs(self._unexplained(before)) ** 2
        return power

    def _noise_of(self, shot: Shot, before: Shot, step: np.ndarray, change: np.ndarray) -> np.ndarray:
        """Return E |v|^2 (lines, outputs) of what changed the response beside the step, G's own drift included."""
        power = self._distortion(shot, before)
        share = self._disturbance.change(change, shot.response)
        moved = self.drifted(shot)
        spilt = (self._parts.spill * np.abs(self.explained(step))) ** 2
        spilt = spilt + self._parts.scatter**2 * self._filter.around(step)
        noise = self._disturbance.power(shot.noise + before.noise, power, share)
        total: np.ndarray = noise + smoothed(moved + spilt, self.reach)
        return total

    def _unexplained(self, shot: Shot) -> np.ndarray:
        """Return what G does not explain of a response, (lines, outputs): distortion and noise."""
        left: np.ndarray = shot.response - self.explained(shot.drive)
        return left
