"""A trial that was run: its recordings, and what they say."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ctlblocks.recording import Recording
from stagectl.experiments.trials.recorded import EVERY, SENT, SLOW
from stagectl.experiments.trials.signals import signals_of, truth
from stagectl.experiments.trials.tool_path import RATE
from stagectl.experiments.trials.trial import Trial
from stagectl.robot.milling.trial_error import TrialSignals, mae, slow

BESIDE = "sent"
"""Version 0.1.0 kept the path that was sent in a file of its own, written last, with what else is to be known."""
NEEDED = "trial", "tracker"
"""Without which of its recordings there is nothing of a trial."""


@dataclass(frozen=True, eq=False)
class DoneTrial:
    """A trial that was run.

    Parameters
    ----------
    name : str
        Of its files.
    trial : Trial
    records : mapping of str to Recording
        By name, as `recorded.RECORDED` has them.
    """

    name: str
    trial: Trial
    records: Mapping[str, Recording]

    @cached_property
    def signals(self) -> TrialSignals:
        """What was measured, with the force as the sensor has it."""
        return signals_of(self.trial, self.records)

    @cached_property
    def error(self) -> np.ndarray:
        """The error r - y_n as the tracker saw it, shape (N, 3), m."""
        assert self.signals.seen is not None
        return np.asarray(self.trial.path.wanted - self.signals.seen)

    @cached_property
    def true_error(self) -> np.ndarray | None:
        """The error without the tracker's noise, shape (N, 3), m, where the tracker has the workpiece; None live."""
        where = truth(self.trial, self.records)
        if where is None:
            return None
        assert self.signals.seen is not None
        milled = self._counted
        return np.asarray(self.trial.path.wanted - where - (self.signals.seen - where)[milled].mean(axis=0))

    @property
    def mae(self) -> np.ndarray:
        """Mean absolute error of the milled part along each axis, shape (3,), m, as the tracker saw it."""
        return mae(self.error[self._counted])

    @cached_property
    def slow_mae(self) -> np.ndarray:
        """Mean absolute error along each axis, shape (3,), m, up to `learning.cutoff`: with little of the noise."""
        return mae(slow(self.error, self.trial.cell.learning.cutoff, RATE)[self._counted])

    @cached_property
    def slow_noise(self) -> np.ndarray:
        """What of `slow_mae` the tracker's noise alone makes, shape (3,), m, if it is white and normal.

        It is told by what it has beyond `learning.highest`, where no tool of an arm follows and a path is smooth.
        """
        learning, half = self.trial.cell.learning, 0.5 * RATE
        fast = (self.error - slow(self.error, learning.highest, RATE))[self._counted]
        share = learning.cutoff / max(half - learning.highest, learning.cutoff)
        return np.asarray(fast.std(axis=0) * np.sqrt(2.0 / np.pi * share))

    @property
    def true_mae(self) -> np.ndarray | None:
        """The same without the tracker's noise, shape (3,), m; None live."""
        return None if self.true_error is None else mae(self.true_error[self._counted])

    @property
    def _counted(self) -> np.ndarray:
        """Which samples count: those of the path in the material."""
        return self.trial.path.milled

    @property
    def left(self) -> int | None:
        """Tick from which on the tool retreated, or None."""
        found = np.flatnonzero(self.records["trial"].select(["retreating"]).data[:, 0])
        return SLOW * int(found[0]) if len(found) else None


def trials_in(records: Mapping[str, Recording], first: Trial) -> Iterator[DoneTrial]:
    """Give what is recorded of a run's trials, in the order of their numbers; also of those that ended early.

    Parameters
    ----------
    records : mapping of str to Recording
        By track: a trial's name, and what it is of.
    first : Trial
        The first trial of their path.
    """
    names = {track.rpartition("-")[0] for track in records}
    there = [name for name in names if all(f"{name}-{each}" in records for each in NEEDED)]
    yield from sorted((done_trial(name, records, first) for name in there), key=lambda each: each.trial.number)


def done_trial(name: str, records: Mapping[str, Recording], first: Trial) -> DoneTrial:
    """Return a trial from its recordings.

    Parameters
    ----------
    name : str
    records : mapping of str to Recording
        By track.
    first : Trial
        The first trial of its path.
    """
    own = {each: records[f"{name}-{each}"] for each in EVERY if f"{name}-{each}" in records}
    told = records.get(f"{name}-{BESIDE}", own["trial"])
    about, sent = told.provenance, np.array(first.path.wanted)
    played = told.select(SENT.channels).data
    sent[: len(played)] = played[: len(sent)]
    zero, block = (np.array(about[key].split(), float) if key in about else None for key in ("zero", "block"))
    late, foreseen = (float(about.get(key, "0")) for key in ("late", "foreseen"))
    is_milled = about["milled"] == "1"
    trial = Trial(first.cell, first.path, int(about["number"]), sent, is_milled, zero, block, late, foreseen)
    return DoneTrial(name, trial, own)
