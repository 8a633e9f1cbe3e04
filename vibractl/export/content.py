"""What leaves a run folder in other formats: its model, its reference, and the shots that are asked for."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ctlblocks import recording
from ctlblocks.recording import Recording
from rigkit.provenance import software
from vibractl.config import RigConfig
from vibractl.far_field import FarField
from vibractl.model_file import read_far_field, read_model
from vibractl.run_setup import MODEL, judging_of, shot_files
from vibractl.setup import Setup
from vibractl.transfer_matrix import TransferMatrix

TIMING = "loopback"
"""The channel of a shot that is proof of alignment and no measurement."""


@dataclass(frozen=True, eq=False)
class Content:
    """A run as it is exported; the shots are read from the disk one at a time.

    Parameters
    ----------
    path : Path
        The run folder.
    config : RigConfig
    text : str
        How the reference was asked for; the name of its file where it is a recording.
    reference : array, shape (samples, sides controlled), m/s^2
        On the time axis of a whole shot: silent before and after.
    sides : tuple of int
        Accelerometers controlled, counted from 1.
    lead, frames : int, samples
        Silence before the reference, and its length.
    matrix : TransferMatrix or None
        Where there is a model.
    files : mapping from shot, counted from 0, to its recording
    recorded : int
        Shots that there are.
    far : FarField or None
        Where there are hydrophones.
    """

    path: Path
    config: RigConfig
    text: str
    reference: np.ndarray
    sides: tuple[int, ...]
    lead: int
    frames: int
    matrix: TransferMatrix | None
    files: Mapping[int, Path]
    recorded: int
    far: FarField | None = None

    @property
    def rate(self) -> float:
        """Samples/s of the recordings."""
        return float(self.config.audio.rate)

    @property
    def reference_names(self) -> tuple[str, ...]:
        """What the columns of `reference` are called."""
        return tuple(f"reference_{side}" for side in self.sides)

    @property
    def about(self) -> dict[str, str]:
        """Where it comes from."""
        return {"rig": self.config.rig.name, "run": self.path.resolve().name, "reference": self.text} | {
            "exported_by": software()
        }

    def shot(self, number: int) -> Recording:
        """Read a shot: drives and responses by name, and what else was recorded, without the timing signal.

        Raises
        ------
        ValueError : the file is damaged, or of another length than the shots of this run.
        """
        path = self.files[number]
        record = recording.read(path, rate=self.rate)
        if len(record.data) != len(self.reference):
            raise ValueError(f"{path}: {len(record.data)} samples, must be {len(self.reference)}")
        return record.select([name for name in record.names if name != TIMING])

    def recordings(self) -> Iterator[tuple[str, Recording]]:
        """Read reference and shots one after the other: a name, and what it is with all that is known of it."""
        about = self.about | {"reference_begins_at_sample": str(self.lead)}
        units = ("m/s^2",) * len(self.sides)
        yield "reference", Recording(self.reference_names, units, self.rate, self.reference, about)
        for number in self.files:
            record = self.shot(number)
            said = {**about, "shot": str(number), **record.provenance}
            yield f"shot-{number:04d}", Recording(record.names, record.units, record.rate, record.data, said)


def read_content(path: Path, shots: str | None = None) -> Content:
    """Read a run folder.

    Parameters
    ----------
    path : Path
    shots : str, optional
        "all", or numbers and ranges as in "0,5,10-20"; the first and the last without it.

    Raises
    ------
    ValueError : it is no run's folder, it lacks a part, or there is no such shot.
    """
    if not (path / "config.toml").is_file():
        raise ValueError(f"{path}/ is not the folder of a run: it has no config.toml")
    made = judging_of(path)
    recorded = shot_files(path)
    if not recorded:
        raise ValueError(f"{path}: 0 shots are recorded, must be at least 1")
    wanted, has_model = selected(shots, len(recorded)), isinstance(made, Setup)
    reference = np.zeros((made.shot.total, made.reference.signal.shape[1]))
    reference[made.shot.window] = made.reference.signal
    return Content(
        path,
        made.config,
        Path(made.reference.text).name,
        reference,
        tuple(output + 1 for output in made.places[0].sensors),
        made.shot.lead,
        made.shot.sounded,
        read_model(path / MODEL) if has_model else None,
        {number: recorded[number] for number in wanted},
        len(recorded),
        read_far_field(path / MODEL, len(made.config.audio.far_field_channels)) if has_model else None,
    )


def selected(shots: str | None, recorded: int) -> list[int]:
    """Return the shots that a text asks for, rising.

    Parameters
    ----------
    shots : str or None
        As for `read_content`.
    recorded : int, shots there are, >= 1

    Raises
    ------
    ValueError : another text, or a shot that is not there.

    Examples
    --------
    >>> selected("7,0-2", 8)
    [0, 1, 2, 7]
    >>> selected(None, 8)
    [0, 7]
    """
    if shots is None:
        return sorted({0, recorded - 1})
    if shots.strip() == "all":
        return list(range(recorded))
    wanted: set[int] = set()
    for part in shots.split(","):
        first, dash, last = (end.strip() for end in part.partition("-"))
        if not (first.isdecimal() and (last.isdecimal() if dash else True)):
            raise ValueError(f"--shots is {shots!r}, must be all, or numbers and ranges as in 0,5,10-20")
        low, high = int(first), int(last) if dash else int(first)
        if not low <= high < recorded:
            raise ValueError(f"--shots asks for {part.strip()}, must rise within 0 to {recorded - 1}")
        wanted |= set(range(low, high + 1))
    return sorted(wanted)
