"""A shot in a recording of other software: where it lies, how late it is, by which clock, and how it is wired."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.fft import next_fast_len

from vibractl.foreign.estimate import Estimate
from vibractl.foreign.near import found_near, loudest, moved
from vibractl.foreign.recorded import Recorded
from vibractl.foreign.search import Likeness, correlations
from vibractl.foreign.shot_search import Probe, Sighting
from vibractl.foreign.slow_model import SlowModel
from vibractl.foreign.slow_view import slow
from vibractl.foreign.timing import Timing
from vibractl.foreign.wiring import Exchange, Sign, Wires, exchange, exchanges, signs, wired, witnesses
from vibractl.judging import Judging
from vibractl.proof import LARGEST_ROUND_TRIP
from vibractl.setup import Setup
from vibractl.transfer_matrix import TransferMatrix

ALIKE = 0.95
"""Least correlation of a response with the reference that tells its place and its sign: below, what a vibrator does
that has learned nothing may look like the reference inverted and late."""


@dataclass(frozen=True, eq=False)
class Examined:
    """What a recording shows of one shot; places are those of the reference's first sample, in the rig's samples.

    Parameters
    ----------
    likeness : float, 0 to 1
        Correlation of the drive with its monitors or, without those, of the response with the reference.
    played : Estimate, samples
        In the response's file, where the drive lies or, where it is not recorded, where it seems to lie.
    heard : Estimate or None, samples
        In the response's file, as the response is like the reference; None where that does not tell even its sign.
    late : Estimate or None, samples
        By how much the response comes later than the model expects it of a drive at `played`.
    clock : Estimate or None, ppm
        By how much the recorder's clock is faster than the player's; None where nothing tells.
    polarity : tuple of Sign
        Of each response that is controlled; without a model a response unlike the reference tells nothing.
    drives, responses : Exchange or None
        None where nothing tells.
    follows : array, shape (responses,), 0 to 1
        Correlation of each response with a drive at any delay, or with what the model expects.
    """

    likeness: float
    played: Estimate
    heard: Estimate | None
    late: Estimate | None
    clock: Estimate | None
    polarity: tuple[Sign, ...]
    drives: Exchange | None
    responses: Exchange | None
    follows: np.ndarray


class Examiner:
    """Examines the shots in one recording.

    Parameters
    ----------
    recorded : Recorded
    made : Setup, or Judging without a model
    matrix : TransferMatrix or None
        Of the whole rig.
    factor : int
        By which it is looked at slower than the rig's rate.
    """

    def __init__(self, recorded: Recorded, made: Setup | Judging, matrix: TransferMatrix | None, factor: int) -> None:
        self._recorded, self._factor, self.rate = recorded, factor, made.shot.rate / factor
        self._reference = slow(made.reference.signal, factor)
        self._frames, self._reach = len(self._reference), round(LARGEST_ROUND_TRIP * self.rate)
        self.before = made.shot.lead // factor + self._reach
        samples = next_fast_len(self.before + self._frames + made.shot.tail // factor + self._reach)
        self.after = samples - self.before - self._frames
        self._window = slice(self.before, self.before + self._frames)
        self._model = None if matrix is None else SlowModel(matrix, samples, self.rate)
        self._sides, self._coils = list(made.places[0].sensors), list(made.coils)
        self._parts = witnesses(made.reference.signal, made.shot.rate)
        self.begins = 0.0
        """Where the reference begins in the drive of one shot, samples."""
        self._wanted = self._placed(recorded.wanted) if recorded.wanted is not None else np.zeros((0, 0))

    @property
    def probes(self) -> list[Probe]:
        """What the search goes by."""
        columns = np.arange(self._recorded.monitors.stop)
        heard = columns[self._recorded.heard]
        sides, wanted = heard[self._sides].tolist(), self._wanted[self._window]
        if self._recorded.widths[2]:
            return [Probe(wanted, tuple(columns[self._recorded.monitors].tolist()))]
        found = [Probe(self._reference, tuple(sides))]
        if self._recorded.is_beside:
            coils = columns[self._recorded.played][self._coils].tolist()
            drive = self._reference[:, np.arange(len(coils)) % self._reference.shape[1]]
            return [*found, Probe(drive, tuple(coils))]
        if self._model is not None:
            expected = self._model.expected(self._wanted)[self._window]
            return [*found, Probe(expected, tuple(heard.tolist()))]
        if wanted.shape[1] == len(heard):
            found.append(Probe(wanted, tuple(heard.tolist())))
        return found

    def examined(self, seen: Sighting, with_wires: bool) -> Examined:
        """Examine a shot that was found; with a model its wires as well, which takes as long as all else."""
        heard = seen.stretch[:, self._recorded.heard]
        response, part = found_near(self._reference, heard[:, self._sides], self.rate, seen.at, self._reach)
        polarity = tuple(
            each if abs(each.correlation) >= ALIKE else Sign(each.correlation, 0.5)
            for each in signs(self._reference, part, self._parts)
        )
        is_told = all(each.is_sure for each in polarity)
        drive, begins, monitored = self._drive(seen)
        at = begins.value
        clock, late, drives = monitored, None, None
        if self._model is None:
            follows = self._follows(drive, heard, at)
            responses = self._order(self._reference, part)
        else:
            late, polarity, follows = self._expected(drive, heard, at)
            drives, responses = self._exchanged(drive, heard, at) if with_wires else (None, None)
            clock = clock or late
        if monitored is not None:
            drives = self._order(self._wanted[self._window], seen.stretch[:, self._recorded.monitors])
        like = float(response.likeness.min()) if monitored is None else float(monitored.likeness.min())
        return Examined(
            like,
            begins.moved(seen.origin).times(self._factor),
            _centre(response).moved(seen.origin).times(self._factor) if is_told else None,
            None if late is None else _late(late, round(at), monitored).times(self._factor),
            None if clock is None else Estimate(clock.drift, clock.drift_error, clock.drift_misfit),
            polarity,
            drives,
            responses,
            follows,
        )

    def _drive(self, seen: Sighting) -> tuple[np.ndarray, Estimate, Timing | None]:
        """Return the drive in a stretch, (samples, drives), V, where the reference begins, and by which timing."""
        recorded = self._recorded
        if recorded.is_beside:
            drive = seen.stretch[:, recorded.played]
            if recorded.begins is not None:
                return drive, Estimate(recorded.begins / self._factor - seen.origin, 0.0), None
            return drive, self._beginning(drive, seen.at), None
        index = np.arange(len(self._wanted), dtype=float)
        if not recorded.widths[2]:
            unknown = Estimate(float(seen.at), 0.0, float(self._reach))
            return moved(self._wanted, index - (seen.at - self.before)), unknown, None
        wanted, monitors = self._wanted[self._window], seen.stretch[:, recorded.monitors]
        found, _ = found_near(wanted, monitors, self.rate, seen.at, self._reach)
        middle = (self._frames - 1) / 2
        turned = (index - found.centre - middle) / (1 + 1e-6 * found.drift) + self.before + middle
        return moved(self._wanted, turned), _centre(found), found

    def _beginning(self, drive: np.ndarray, at: int) -> Estimate:
        """Return where the reference begins in a drive: as it is like it, else as it is loud."""
        coils = drive[:, self._coils]
        wanted = self._reference[:, np.arange(len(self._coils)) % self._reference.shape[1]]
        first = max(at - self._reach, 0)
        like, _ = Likeness(wanted).most(coils[first : at + self._frames + self._reach])
        if like < ALIKE:
            place, error = loudest(drive, self._frames, at, self._reach)
            return Estimate(place, 0.0, error)
        return _centre(found_near(wanted, coils, self.rate, at, self._reach)[0])

    def _expected(self, drive: np.ndarray, heard: np.ndarray, at: float) -> tuple[Timing, tuple[Sign, ...], np.ndarray]:
        """Find what the model expects of a drive in what is heard of it."""
        assert self._model is not None
        first = round(at)
        template = self._model.expected(drive)[first : first + self._frames]
        found, part = found_near(template, heard, self.rate, first, self._reach)
        every = signs(template, part, self._parts)
        return found, tuple(every[side] for side in self._sides), found.likeness

    def _exchanged(self, drive: np.ndarray, heard: np.ndarray, at: float) -> tuple[Exchange, Exchange]:
        model, first = self._model, round(at)
        part = heard[max(first - self._reach, 0) : first + self._frames + self._reach]

        def likeness(drives: Wires, responses: Wires) -> float:
            assert model is not None
            expected = model.expected(wired(drive, drives))[first : first + self._frames]
            return Likeness(expected).most(wired(part, responses))[0]

        return exchanges(likeness, drive.shape[1], heard.shape[1], self._parts)

    def _order(self, wanted: np.ndarray, part: np.ndarray) -> Exchange | None:
        """Return in which order channels are that should be like those wanted; None where those are all the same."""
        if not np.ptp(wanted, axis=1).any():
            return None

        like = Likeness(wanted)

        def likeness(wires: Wires) -> float:
            return like.most(wired(part, wires))[0]

        return exchange(likeness, wanted.shape[1], self._parts)

    def _follows(self, drive: np.ndarray, heard: np.ndarray, at: float) -> np.ndarray:
        """Return the largest correlation of each response with a drive, (responses,), 0 to 1, at any delay."""
        first = round(at)
        part = heard[max(first - self._reach, 0) : first + self._frames + self._reach]
        played = drive[first : first + self._frames].T
        found = [np.abs(correlations(one, part)).max(axis=0) for one in played if one.any()]
        return np.max(found, axis=0) if found else np.zeros(heard.shape[1])

    def _placed(self, wanted: np.ndarray) -> np.ndarray:
        """Return a drive, slow, in an empty stretch, so that the reference begins in it where it should."""
        seen = slow(wanted, self._factor)
        begins = self._recorded.begins
        self.begins = begins / self._factor if begins is not None else loudest(seen, self._frames, 0, len(seen))[0]
        at = np.arange(self.before + self._frames + self.after, dtype=float) - self.before + self.begins
        self.begins *= self._factor
        return moved(seen, at)


def _centre(found: Timing) -> Estimate:
    """Return where a signal begins, if its middle is where it is."""
    return Estimate(found.centre, found.centre_error, found.centre_misfit)


def _late(found: Timing, first: int, monitored: Timing | None) -> Estimate:
    """Return by how much a response is late, with what monitors leave open of where the drive begins."""
    if monitored is None:
        return _centre(found).moved(-first)
    noise = math.hypot(found.centre_error, monitored.centre_error)
    return Estimate(found.centre - first, noise, math.hypot(found.centre_misfit, monitored.centre_misfit))
