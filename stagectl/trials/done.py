"""A trial that was run: its recordings, what they say, and its files."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from ctlblocks import recording
from ctlblocks.recording import Recording
from stagectl.robot.milling.trial_error import TrialSignals, mae
from stagectl.trials.signals import signals_of, truth
from stagectl.trials.trial import Trial

SUFFIXES = {"trial": "csv", "truth": "csv", "tracker": "wav"}
"""Formats: of many channels a WAV is smaller and quicker; both keep every bit."""
WHOLE = "-sent.csv"
"""How the file ends that is written last of a trial."""
SENT = ("sent_x", "sent_y", "sent_z")


class TrialEnded(ValueError):
    """A trial that a fault has ended; the text says which, and that the tool has left the material or stands."""


@dataclass(frozen=True, eq=False)
class DoneTrial:
    """A trial that ran to its end.

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

    @property
    def true_mae(self) -> np.ndarray | None:
        """The same without the tracker's noise, shape (3,), m; None live."""
        return None if self.true_error is None else mae(self.true_error[self._counted])

    @property
    def _counted(self) -> np.ndarray:
        """Which samples count: those of the path in the material."""
        return self.trial.path.milled

    def write(self, folder: Path) -> None:
        """Write its recordings, and the path that was sent."""
        for name, kept in self.records.items():
            recording.write(folder / f"{self.name}-{name}.{SUFFIXES[name]}", kept)
        recording.write(folder / f"{self.name}{WHOLE}", self._sent())

    def _sent(self) -> Recording:
        trial = self.trial
        about = {"number": str(trial.number), "milled": str(int(trial.is_milled)), "late": repr(trial.late)}
        for name, place in (("zero", trial.zero), ("block", trial.block)):
            if place is not None:
                about[name] = " ".join(repr(float(each)) for each in place)
        return Recording(SENT, ("m",) * 3, self.records["trial"].rate, trial.sent, about)


def read_trial(folder: Path, name: str, first: Trial) -> DoneTrial:
    """Read a trial back.

    Parameters
    ----------
    folder : Path
    name : str
    first : Trial
        The first trial of its path.

    Raises
    ------
    RecordingError : a file that is not there, or not whole.
    """
    sent = recording.read(folder / f"{name}{WHOLE}")
    about = sent.provenance
    places = {key: np.array([float(each) for each in about[key].split()]) for key in ("zero", "block") if key in about}
    late = float(about.get("late", "0"))
    trial = Trial(first.cell, first.path, int(about["number"]), sent.data, about["milled"] == "1", **places, late=late)
    files = {each: folder / f"{name}-{each}.{suffix}" for each, suffix in SUFFIXES.items()}
    return DoneTrial(name, trial, {each: recording.read(file) for each, file in files.items() if file.exists()})


def has_trial(folder: Path, name: str) -> bool:
    """Whether a folder has a trial of that name; its path is written last."""
    return (folder / f"{name}{WHOLE}").exists()
