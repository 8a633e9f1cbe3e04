"""An experiment in batches: excite, save raw, compute only then; stopped or killed, it goes on where it was."""

import hashlib
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol, Self

import numpy as np

from ctlblocks import recording
from ctlblocks.recording import Recording
from ctlblocks.room import bytes_of
from rigkit import atomic
from rigkit.disk_space import require
from rigkit.json_file import JsonError, read_json
from rigkit.json_text import json_text
from rigkit.lock import Lock
from rigkit.provenance import now

Emit = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
"""Plays a drive, shape (samples, drives); returns what was emitted and what was heard, one row a sample, float32."""
_LOCK = ".lock"


class RawFolderError(ValueError):
    """A raw folder does not belong to the experiment that is asked for."""


def refuse_to_emit(drive: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Stand for a device where only recordings may be used.

    Parameters
    ----------
    drive : array, shape (samples, drives), any unit

    Raises
    ------
    RawFolderError : always.
    """
    raise RawFolderError(f"a recording of {len(drive)} samples is missing, and nothing is to be measured")


class Batch(Protocol):
    """One recording of an experiment, made again from its parameters whenever it is needed."""

    @property
    def samples(self) -> int:
        """Length of the drive."""

    def drive(self) -> np.ndarray:
        """Return the drive, shape (samples, drives)."""


@dataclass(frozen=True)
class Plan:
    """What is to be recorded.

    Parameters
    ----------
    name : str
        Begins the names of its files; another for each plan of a raw folder.
    settings : mapping of str to str
        Everything the drives, and what they meet, depend on: two plans are the same if these are.
    rate : float, samples/s
    drives, responses : sequences of (str, str)
        Name and unit of each channel.
    batches : sequence of Batch
    """

    name: str
    settings: Mapping[str, str]
    rate: float
    drives: Sequence[tuple[str, str]]
    responses: Sequence[tuple[str, str]]
    batches: Sequence[Batch]

    @property
    def fingerprint(self) -> str:
        """Tells this plan from another by a few characters."""
        text = json.dumps(dict(self.settings), sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    @property
    def seconds(self) -> float:
        """Length of all batches, s."""
        return sum(batch.samples for batch in self.batches) / self.rate


class RawFolder:
    """The raw recordings of an experiment, `NAME.json` and `NAME-000.wav` ... for each plan; a context manager.

    A file is there whole or not at all, and no recording is ever written twice.  While it is open it is locked
    against other processes.

    Parameters
    ----------
    path : Path
        Made if absent.

    Raises
    ------
    FolderInUseError : on entry, another process is working in it.
    """

    def __init__(self, path: Path) -> None:
        self.path = path

    def __enter__(self) -> Self:
        """Lock the folder and sweep up what a kill left."""
        self.path.mkdir(parents=True, exist_ok=True)
        self._lock = Lock(self.path / _LOCK)
        for leftover in [*atomic.leftovers(self.path), *self.path.glob(".*.tmp")]:
            leftover.unlink(missing_ok=True)
        return self

    def __exit__(self, *fault: object) -> None:
        """Release the lock; take the folder away again if nothing was recorded in it."""
        if not any(self.path.glob("*.wav")):
            for file in [*self.path.glob("*.json"), self.path / _LOCK]:
                file.unlink()
            with suppress(OSError):  # something else is in it
                self.path.rmdir()
        self._lock.release()

    def file(self, plan: Plan, number: int) -> Path:
        """Return where the recording of a batch belongs, counted from 0."""
        return self.path / f"{plan.name}-{number:03d}.wav"

    def recorded(self, plan: Plan) -> float:
        """Return how much of a plan is recorded, s."""
        there = (batch for number, batch in enumerate(plan.batches) if self.file(plan, number).is_file())
        return sum(batch.samples for batch in there) / plan.rate

    def left(self, names: Sequence[str]) -> Sequence[str]:
        """Return which of several plans, each for where the one before it is too loud, are still to be tried, by name.

        From the last on that was begun; all of them where none was.
        """
        begun = [number for number, name in enumerate(names) if self._settings_of(name).is_file()]
        return names[max(begun, default=0) :]

    def require_room(self, samples: int, channels: int) -> None:
        """Refuse, by a `DiskFault`, recordings that the disk has no room for beside those that are there.

        Parameters
        ----------
        samples : int
            Of all recordings.
        channels : int
        """
        there = sum(file.stat().st_size for file in self.path.glob("*.wav"))
        needed = bytes_of(samples, channels, "float32", "wav") - there
        require(self.path, max(needed, 0), "the recordings")

    def record(self, plan: Plan, emit: Emit) -> Iterator[tuple[Batch, Recording]]:
        """Yield every batch with its recording: those that are there, then those that `emit` still has to make.

        A recording is on the disk before it is yielded, and what is yielded is what the disk holds.

        Raises
        ------
        RawFolderError : the folder was recorded with other settings; it says which.
        RecordingError : a file of the folder is damaged.
        """
        self._keep(plan)
        names, units = zip(*plan.drives, *plan.responses, strict=True)
        for number, batch in enumerate(plan.batches):
            path = self.file(plan, number)
            if not path.is_file():
                emitted, response = emit(batch.drive())
                about = {"plan": plan.name, "batch": str(number), "fingerprint": plan.fingerprint, "date": now()}
                data = np.hstack([emitted, response]).astype(np.float32)
                recording.write(path, Recording(names, units, plan.rate, data, about))
            record = recording.read(path, rate=plan.rate, names=names)
            if record.provenance.get("fingerprint") != plan.fingerprint or len(record.data) != batch.samples:
                raise RawFolderError(f"{path}: is not batch {number} of this experiment; remove it to record it again")
            yield batch, record

    def _keep(self, plan: Plan) -> None:
        """Write what a plan was made from, or compare with what is written."""
        path = self._settings_of(plan.name)
        if not path.is_file():
            atomic.write(path, f"{json_text(dict(plan.settings), indent=2)}\n")
            return
        try:
            before = read_json(path, dict)
        except JsonError as fault:
            raise RawFolderError(f"{fault}; use another folder") from None
        differ = [key for key in {**before, **plan.settings} if before.get(key) != plan.settings.get(key)]
        if differ:
            key, more = differ[0], f" (and {len(differ) - 1} more)" if len(differ) > 1 else ""
            raise RawFolderError(
                f"{self.path}/ was recorded with {key} = {before.get(key)}, now it is {plan.settings.get(key)}{more}; "
                "go back to the old settings, or use another folder"
            )

    def _settings_of(self, name: str) -> Path:
        return self.path / f"{name}.json"
