"""What an experiment is to whoever runs, reports, replays or serves it: one protocol, and a line in a registry."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from ctlblocks.recording import Recording
from rigkit.experiment.part import Part
from rigkit.origin import RUN, read_origin
from rigkit.stream_writer import Tell

Records = Mapping[str, Recording]
"""The recordings of a run, by the names of its tracks."""


class Experiment(Protocol):
    """One experiment, with its settings and what was asked for: no file, no clock, no thread."""

    @property
    def seconds(self) -> float:
        """How long all its parts take when nothing ends them before, s; or in the unit of their `progress`."""

    @property
    def about(self) -> Mapping[str, str]:
        """Provenance of its recordings."""

    @property
    def designed(self) -> Mapping[str, Any]:
        """What it is made again from, beside its rig file and its recordings, as JSON has it."""

    @property
    def room(self) -> int:
        """Bytes that its recordings may take, at most."""

    def parts(self, tell: Tell, stopped: Callable[[], bool]) -> Iterator[Part]:
        """Give its parts one after another, their devices open while each is in use: a generator.

        Parameters
        ----------
        tell : callable(event, fields)
            Told of what happens to the devices.
        stopped : callable() -> bool
            Asked while they are got ready.
        """

    def again(self, records: Records) -> Iterator[Part]:
        """Give the parts whose recordings there are, with the recorded sensors in place of the devices.

        Raises
        ------
        ValueError : they cannot be made again, and why.
        """

    def figures(self, records: Records) -> dict[str, Any]:
        """Return what a run comes to, from its recordings alone.

        Raises
        ------
        ValueError : nothing that could be judged is recorded.
        """

    def report(self, path: Path, records: Records, figures: Mapping[str, Any], png: Path | None) -> None:
        """Write the report of the run in a folder, and its figures as PNG files where they are wanted."""


@dataclass(frozen=True)
class Kind:
    """A kind of experiment.

    Parameters
    ----------
    name : str
        In the `run.json` of its runs.
    read : callable(Path, Records, settings) -> Experiment
        Makes the experiment of a run again, from its folder, with settings laid over its rig file.
    apart : tuple of str
        Keys of the rig file whose files it does not depend on.
    what_if : bool
        Whether a replay may lay settings over the rig file: what would have been made of the same sensors.
    reports_early : bool
        Whether a run that has ended before its end is reported at once; else whoever wants that asks for it.
    stands_in : str
        The track in whose place a log may stand, where a run has several.
    is_older : callable(Path) -> bool
        Whether a folder that does not say its kind, as those of version 0.1.0, is a run of this one.
    """

    name: str
    read: Callable[[Path, Records, Sequence[str]], Experiment]
    apart: tuple[str, ...] = ()
    what_if: bool = True
    reports_early: bool = True
    stands_in: str = ""
    is_older: Callable[[Path], bool] = lambda _: False


def kind_of(path: Path) -> str:
    """Return what kind of run a folder has; empty where it does not say so."""
    origin = read_origin(path / RUN)
    return "" if origin is None else origin.kind
