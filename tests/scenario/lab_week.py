"""What a week in the lab does to each command, tried: `python -m tests.scenario.lab_week --write` writes its page.

Each cell works on a copy of one lab: a model, a run of two shots, and what finished calibrations of a stage, of joints
and of a feed leave.  What came of it is refused, with nothing changed; said, and done; or done with the same bits.
"""

import contextlib
import hashlib
import io
import json
import re
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.page_table import put, table
from calibration.__main__ import main as calibrate
from calibration.joint_clamping.session import KIND as JOINTS
from calibration.output import Wish, output
from calibration.stage_axes.experiment import KIND as STAGE
from ctlblocks import recording
from ctlblocks.recording import Recording
from rigkit import config as rig_file
from rigkit.config import Section
from rigkit.lock import Lock
from rigkit.origin import RUN
from stagectl.config import StageConfig
from stagectl.robot.config import CellConfig
from vibractl.__main__ import main as vibractl
from vibractl.config import RigConfig

SITUATIONS = ("repeated", "after an edit", "with another machine's model", "moved", "beside another")
NAME = "a week"
RIG = (
    "audio.isolated=false", "characterisation.records=3", "characterisation.period=1", "characterisation.run_in=0.3",
    "reference.signal=chirp:40:90:1", "session.shots=2",
)  # fmt: skip
WIDER = "audio.input_full_scale=200.0"


@dataclass(frozen=True)
class Lab:
    """A folder of a lab."""

    path: Path

    def call(self, program: Callable[[], int], *words: str) -> tuple[int, str]:
        """Call a command in the folder; return its status, and what it has said to people."""
        said, argv = io.StringIO(), sys.argv
        sys.argv = [program.__module__.split(".")[0], *words]
        try:
            with (
                contextlib.chdir(self.path),
                contextlib.redirect_stderr(said),
                contextlib.redirect_stdout(io.StringIO()),
            ):
                return program(), said.getvalue()
        finally:
            sys.argv = argv

    def edit(self, name: str, model: type[Section], *overrides: str) -> None:
        """Edit a rig file, or a run's."""
        config = rig_file.load(self.path / name, model, overrides, as_written=True)
        (self.path / name).write_text(rig_file.dump(config))

    def sums(self) -> dict[str, str]:
        """Return every file's checksum, but for logs that tell that somebody was there."""
        files = (path for path in self.path.rglob("*") if path.is_file() and path.name not in (".lock", "events.jsonl"))
        return {str(path.relative_to(self.path)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def first_lab(path: Path) -> Lab:
    """Measure and learn, and leave what finished calibrations leave."""
    lab = Lab(path)
    path.mkdir()
    for name, model, overrides in (
        ("rig.toml", RigConfig, RIG),
        ("stage.toml", StageConfig, ()),
        ("cell.toml", CellConfig, ()),
    ):
        (path / name).write_text(rig_file.dump(rig_file.load(None, model, overrides)))
    for out, seed in (("model.h5", 1), ("other.h5", 9)):
        words = ("--config", "rig.toml", "--seed", str(seed), "--out", out)
        assert lab.call(calibrate, "vibrator", *words)[0] == 0
    assert (
        lab.call(vibractl, "run", "--config", "rig.toml", "--seed", "1", "--model", "model.h5", "--out", "RUN")[0] == 0
    )
    lab.edit("rig.toml", RigConfig, "simulator.options.seed=1")
    left(path / "s.h5", STAGE, StageConfig(), "s-x.h5", "s-y.h5", "s-z.h5", "s.toml")
    left(path / "joints.h5", JOINTS, CellConfig(), *(f"joints.raw/joint-{joint}.wav" for joint in range(1, 7)))
    (path / "velocity.h5").write_bytes(b"a model of x")
    (path / "velocity.csv").write_bytes(b"a record of x")
    return lab


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


RESUME = ("run", "--resume", "RUN", "--shots", "3")
NEW = ("run", "--config", "rig.toml", "--model", "model.h5", "--out", "NEW", "--shots", "1")
PREDICT = ("predict", "--config", "rig.toml", "--model", "model.h5", "--shots", "2")
KEEP = ("library", "add", "RUN", "--library", "LIB", "--name", "tank")
REPLAY = ("replay", "RUN")
VIBRATOR = ("vibrator", "--config", "rig.toml", "--out", "model.h5")
STAGE_WORDS = ("stage", "--config", "stage.toml", "--out", "s.h5")
JOINT_WORDS = ("joints", "--config", "cell.toml", "--out", "joints.h5")
VELOCITY = ("velocity", "--axis", "y", "--out", "velocity.h5")


def repeated(lab: Lab, program: Callable[[], int], *words: str) -> tuple[int, str]:
    """Call it twice."""
    assert lab.call(program, *words)[0] == 0
    return lab.call(program, *words)


def edited_run(lab: Lab, *words: str) -> tuple[int, str]:
    """Edit a run's settings, then call."""
    lab.edit("RUN/config.toml", RigConfig, WIDER)
    return lab.call(vibractl, *words)


def rewired(lab: Lab, program: Callable[[], int], *words: str) -> tuple[int, str]:
    """Edit the rig's wiring, then call."""
    lab.edit("rig.toml", RigConfig, WIDER)
    return lab.call(program, *words)


def other_model(lab: Lab, place: str, *words: str) -> tuple[int, str]:
    """Put another machine's model in the place of this one's, then call."""
    shutil.copyfile(lab.path / "other.h5", lab.path / place)
    return lab.call(vibractl, *words)


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


Cell = Callable[[Lab], tuple[int, str]]
CELLS: dict[str, tuple[Cell | None, ...]] = {
    "`vibractl run`": (
        lambda lab: repeated(lab, vibractl, *NEW),
        lambda lab: rewired(lab, vibractl, *NEW),
        lambda lab: other_model(lab, "model.h5", *NEW),
        lambda lab: moved(lab, vibractl, *NEW),
        None,
    ),
    "`vibractl run --resume`": (
        lambda lab: lab.call(vibractl, *RESUME),
        lambda lab: edited_run(lab, *RESUME),
        lambda lab: other_model(lab, "RUN/model.h5", *RESUME),
        lambda lab: moved(lab, vibractl, *RESUME),
        lambda lab: beside(lab, "RUN", vibractl, *RESUME),
    ),
    "`vibractl replay`": (
        lambda lab: repeated(lab, vibractl, *REPLAY),
        lambda lab: edited_run(lab, *REPLAY),
        lambda lab: other_model(lab, "RUN/model.h5", *REPLAY),
        lambda lab: moved(lab, vibractl, *REPLAY),
        lambda lab: beside(lab, "RUN", vibractl, *REPLAY),
    ),
    "`vibractl predict`": (
        lambda lab: lab.call(vibractl, *PREDICT),
        lambda lab: rewired(lab, vibractl, *PREDICT),
        lambda lab: other_model(lab, "model.h5", *PREDICT),
        lambda lab: moved(lab, vibractl, *PREDICT),
        None,
    ),
    "`vibractl library add`": (
        lambda lab: repeated(lab, vibractl, *KEEP),
        lambda lab: edited_run(lab, *KEEP),
        lambda lab: other_model(lab, "RUN/model.h5", *KEEP),
        lambda lab: moved(lab, vibractl, *KEEP),
        None,
    ),
    "`calibrate vibrator`": (
        lambda lab: lab.call(calibrate, *VIBRATOR),
        lambda lab: stopped_then_rewired(lab, "model.h5", RigConfig, "rig.toml", WIDER, *VIBRATOR),
        None,
        lambda lab: moved(lab, calibrate, *VIBRATOR),
        lambda lab: (unfinished(lab, "model.h5"), beside(lab, "model.raw", calibrate, *VIBRATOR))[1],
    ),
    "`calibrate stage`": (
        lambda lab: lab.call(calibrate, *STAGE_WORDS),
        lambda lab: stopped_then_rewired(
            lab, "s.h5", StageConfig, "stage.toml", "limits.travel=[3e-05, 0.0004]", *STAGE_WORDS
        ),
        None,
        lambda lab: moved(lab, calibrate, *STAGE_WORDS),
        None,
    ),
    "`calibrate joints`": (
        lambda lab: lab.call(calibrate, *JOINT_WORDS),
        lambda lab: stopped_then_rewired(lab, "joints.h5", CellConfig, "cell.toml", "robot.tool=0.2", *JOINT_WORDS),
        None,
        lambda lab: moved(lab, calibrate, *JOINT_WORDS),
        None,
    ),
    "`calibrate velocity`": (lambda lab: lab.call(calibrate, *VELOCITY), None, None, None, None),
}
"""A command's row: what is tried in each of `SITUATIONS`; None where that does not arise."""


def tried(cell: Cell, lab: Lab, place: Path) -> str:
    """Try a cell on a copy of the lab, and return what came of it."""
    copy = Lab(Path(shutil.copytree(lab.path, place / "lab")))
    before = copy.sums()
    status, said = cell(copy)
    now = Lab(place / "attic") if (place / "attic").exists() else copy
    recorded = {total for name, total in before.items() if name.endswith(".wav")}
    found = {total for name, total in now.sums().items() if name.endswith(".wav")}
    assert recorded <= found, "a recording is lost"
    refused = [line for line in said.splitlines() if line.startswith("error: ")]
    if refused:
        assert (status, len(refused)) == (2, 1)
        is_twice = "repeated" in cell.__code__.co_names
        assert is_twice or recorded == found, "it was refused, and has recorded all the same"
        return f"refused: {why(refused[0])}"
    notes = [line for line in said.splitlines() if " was " in line and " is " in line]
    if notes:
        return f"said: {why(notes[0])}"
    return "the same bits" if status == 0 else "said: drives differ"


def why(line: str) -> str:
    """Return what a line is about, in a few words."""
    if keys := re.findall(r"--accept (\S+)", line):
        return ", ".join(f"`{key}`" for key in keys)
    for words in ("is finished", "is in use", "is there already", "has an entry"):
        if words in line:
            return words.replace("has an entry", "is there already")
    found = re.search(r"([\w.]+) was \S+, is ", line)
    return f"`{found[1]}`" if found else line


def rows() -> list[list[str]]:
    """Try all cells; return the table."""
    with tempfile.TemporaryDirectory() as folder:
        lab = first_lab(Path(folder) / "first")
        found = []
        for number, (command, cells) in enumerate(CELLS.items()):
            row = [command]
            for column, cell in enumerate(cells):
                place = Path(folder) / f"{number}-{column}"
                place.mkdir()
                row.append("" if cell is None else tried(cell, lab, place))
            found.append(row)
        return found


if __name__ == "__main__":
    put(table(["command", *SITUATIONS], rows()), "origin.md", NAME)
