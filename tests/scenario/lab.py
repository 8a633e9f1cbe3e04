"""A folder of a lab in which commands are called, and what a week does to it: an edit, a move, others at work."""

import contextlib
import io
import json
import multiprocessing
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from calibration.__main__ import main as calibrate
from calibration.output import Wish, output
from ctlblocks import recording
from ctlblocks.recording import Recording
from rigkit import config as rig_file
from rigkit.config import Section
from rigkit.lock import Lock
from rigkit.origin import RUN, checksum
from tests.until import until

Cell = Callable[["Lab"], tuple[int, str]]
"""Does something in a lab; returns a command's status, and what it has said to people."""


@dataclass(frozen=True)
class Lab:
    """A folder of a lab."""

    path: Path

    def call(self, program: Callable[[], int], *words: str) -> tuple[int, str]:
        """Call a command in the folder; return its status, and what it has said to people."""
        return self._called(program, words, io.StringIO())

    def heard(self, program: Callable[[], int], *words: str) -> tuple[int, str]:
        """Call a command; return its status, and what it has said, its tables included."""
        table = io.StringIO()
        status, said = self._called(program, words, table)
        return status, said + table.getvalue()

    def _called(self, program: Callable[[], int], words: Sequence[str], table: io.StringIO) -> tuple[int, str]:
        said, argv = io.StringIO(), sys.argv
        sys.argv = [program.__module__.split(".")[0], *words]
        try:
            with (
                contextlib.chdir(self.path),
                contextlib.redirect_stderr(said),
                contextlib.redirect_stdout(table),
            ):
                return program(), said.getvalue()
        finally:
            sys.argv = argv

    def edit(self, name: str, model: type[Section], *overrides: str) -> None:
        """Edit a rig file, or a run's."""
        config = rig_file.load(self.path / name, model, overrides, as_written=True)
        (self.path / name).write_text(rig_file.dump(config))

    def recordings(self) -> set[str]:
        """Return the checksums of all recordings."""
        return {checksum(path) for path in recorded(self.path)}


def recorded(folder: Path) -> Iterator[Path]:
    """Find all recordings in a folder and below."""
    yield from folder.rglob("*.wav")
    yield from (path for path in folder.rglob("*.csv") if path.read_bytes()[:1] == b"#")


def left(out: Path, kind: str, config: Section, *names: str) -> None:
    """Leave what a finished calibration leaves."""
    writes = output(out, kind, config, Wish())
    with writes.begun():
        for name in ("a.wav", *(Path(name).name for name in names if name.endswith(".wav"))):
            recording.write(writes.raw / name, Recording(("u",), ("V",), 100.0, np.zeros((3, 1), np.float32)))
    for name in (out.name, *(name for name in names if not name.endswith(".wav"))):
        (out.parent / name).write_bytes(b"a result")
    writes.finish()


def unfinished(lab: Lab, out: str) -> None:
    """Make a finished calibration one that was stopped."""
    (lab.path / out).unlink()
    note = (lab.path / out).with_suffix(".raw") / RUN
    note.write_text(json.dumps(json.loads(note.read_text()) | {"finished": ""}))


@contextlib.contextmanager
def at_work(path: Path) -> Iterator[None]:
    """Stand for another process that works in a folder."""
    lock = Lock(path / ".lock")
    try:
        yield
    finally:
        lock.release()


@contextlib.contextmanager
def at_work_on(lab: "Lab", program: Callable[[], int], until_there: str, *words: str) -> Iterator[None]:
    """Have a command at work in another process, from when a file of its is there; it is killed afterwards."""
    process = multiprocessing.get_context("fork").Process(target=lab.call, args=(program, *words))
    process.start()
    try:
        until(lambda: not process.is_alive() or (lab.path / until_there).exists())
        yield
        assert process.is_alive(), "what was at work has ended"
    finally:
        process.kill()
        process.join()


def repeated(lab: Lab, program: Callable[[], int], *words: str) -> tuple[int, str]:
    """Call it twice."""
    assert lab.call(program, *words)[0] == 0
    return lab.call(program, *words)


def moved(lab: Lab, program: Callable[[], int], *words: str) -> tuple[int, str]:
    """Rename the whole lab, then call."""
    return Lab(lab.path.rename(lab.path.with_name("attic"))).call(program, *words)


def beside(lab: Lab, place: str, program: Callable[[], int], *words: str) -> tuple[int, str]:
    """Call it while another process works in the folder."""
    with at_work(lab.path / place):
        return lab.call(program, *words)


def stopped_then_rewired(
    lab: Lab, out: str, model: type[Section], file: str, edit: str, *words: str
) -> tuple[int, str]:
    """Edit the rig file of an unfinished calibration, then go on."""
    unfinished(lab, out)
    lab.edit(file, model, edit)
    return lab.call(calibrate, *words)


def same_bits(lab: "Lab", program: Callable[[], int], run: str, *words: str) -> tuple[int, str]:
    """Rename the whole lab and make a run anew; see that its recordings are those of the first one, bit for bit."""
    there = Lab(lab.path.rename(lab.path.with_name("attic")))
    status, said = there.call(program, *words, "--out", "ANEW")
    assert status == 0, said
    for file in recorded(there.path / run):
        before, now = (
            recording.read(each) for each in (file, there.path / "ANEW" / file.relative_to(there.path / run))
        )
        assert before.names == now.names
        assert np.array_equal(before.data, now.data, equal_nan=True), f"{file.name} differs"
    return status, said


def as_another(lab: "Lab", run: str, program: Callable[[], int], *words: str) -> tuple[int, str]:
    """Make a run whose folder another process is making at the same time."""
    (lab.path / run).mkdir()
    return beside(lab, run, program, *words, "--out", run)
