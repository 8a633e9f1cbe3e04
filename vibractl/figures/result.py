"""What the figures of a run are drawn from: its set-up, the table of its shots, and its first and last recording."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ctlblocks import recording
from rigkit.run_folder import read_quality
from vibractl.judging import Judging
from vibractl.lines_file import read_hum
from vibractl.model_file import read_model
from vibractl.quality import Judge
from vibractl.quality_table import is_reduced
from vibractl.run_setup import MODEL, judging_of, shot_files
from vibractl.setup import Setup
from vibractl.shot_file import far_field_of, split
from vibractl.transfer_matrix import TransferMatrix

Row = Mapping[str, str]


@dataclass(frozen=True)
class Shot:
    """One recorded shot.

    Parameters
    ----------
    number : int
    drive : array, shape (samples, driven coils), V, of the whole shot
    response : array, shape (samples, sides), m/s^2, of the whole shot
    error : array, shape (frames, sides), m/s^2
        In the far field sides are hydrophones, and m/s^2 are Pa.
        Reference minus response while the reference lasts, at the learner's rate.
    """

    number: int
    drive: np.ndarray
    response: np.ndarray
    error: np.ndarray


@dataclass(frozen=True)
class Result:
    """A run as its figures need it; only the first and the last recording are in memory.

    Parameters
    ----------
    made : Setup, or Judging where there is no model
    judge : Judge
    model : TransferMatrix, as measured, of the whole rig, or None
    rows : tuple of rows of `qc.csv`, one a shot
    ends : tuple of Shot
        The first shot of the whole reference and the last shot; one alone where that is the same.
    elsewhere : Result or None
        The same run as the sensors hear it that do not count, where there are hydrophones.
    """

    made: Setup | Judging
    judge: Judge
    model: TransferMatrix | None
    rows: tuple[Row, ...]
    ends: tuple[Shot, ...]
    elsewhere: "Result | None" = None

    @property
    def last(self) -> Shot:
        """The last shot."""
        return self.ends[-1]

    @property
    def sides(self) -> tuple[int, ...]:
        """Accelerometers controlled, or hydrophones, counted from 1 as on the rig."""
        return tuple(sensor + 1 for sensor in self.judge.place.sensors)

    @property
    def sensor(self) -> str:
        """What a side is called."""
        return "hydrophone" if self.judge.place.is_far else "side"

    @property
    def unit(self) -> str:
        """Of responses and errors, as it is written."""
        return self.judge.place.unit.replace("^2", "²")

    @property
    def coils(self) -> tuple[int, ...]:
        """Coils driven, counted from 1 as on the rig."""
        return tuple(coil + 1 for coil in self.made.coils)

    @property
    def rate(self) -> float:
        """The learner's rate, samples/s."""
        return self.made.shot.rate / self.made.config.learning.decimation

    @property
    def seconds(self) -> float:
        """Length of the frame that is judged, s."""
        return self.made.shot.frames / self.made.shot.rate

    @property
    def reference(self) -> np.ndarray:
        """The reference at the learner's rate, (frames, sides), m/s^2."""
        return self.judge.place.reference

    def cell(self, row: Row, name: str) -> str:
        """Return a cell of `qc.csv`, this place's where each place has one."""
        own = self.judge.place.prefix + name
        return row[own] if own in row else row[name]

    def column(self, name: str) -> np.ndarray:
        """Return a column of `qc.csv` as numbers, (shots,), of any unit; an empty cell is NaN."""
        return np.array([float(self.cell(row, name) or "nan") for row in self.rows])


def read_result(path: Path) -> Result:
    """Read a run folder.

    Raises
    ------
    ValueError : no shot is recorded and judged, or the folder lacks a part.
    """
    made = judging_of(path)
    files, rows = shot_files(path), read_quality(path)
    shots = min(len(files), len(rows))
    if not shots:
        raise ValueError(f"{path}: {len(files)} shots are recorded and {len(rows)} judged, must be at least 1 of each")
    model, found = read_model(path / MODEL) if isinstance(made, Setup) else None, None
    first = next((number for number, row in enumerate(rows[:shots]) if not is_reduced(row)), 0)
    for place in sorted(made.places, key=lambda place: place is made.judged):  # the one that counts comes last
        judge = Judge(made, place)
        ends = tuple(_shot(number, files[number], made, judge) for number in sorted({first, shots - 1}))
        found = Result(made, judge, model, tuple(rows[:shots]), ends, found)
    assert found is not None  # there are accelerometers
    return found


def _shot(number: int, path: Path, made: Setup | Judging, judge: Judge) -> Shot:
    record = recording.read(path, rate=made.shot.rate)
    if len(record.data) != made.shot.total:
        raise ValueError(f"{path}: {len(record.data)} samples, must be {made.shot.total}")
    drive, response = split(record, made.config)
    heard = far_field_of(record, made.config) if judge.place.is_far else response
    hum = read_hum(path) if isinstance(made, Setup) and judge.place is made.learned else None
    return Shot(number, drive[:, list(made.coils)], heard[:, list(judge.place.sensors)], judge.error(heard, hum))
