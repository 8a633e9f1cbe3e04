"""What a week in the lab does to each command, tried: `python -m tests.scenario.lab_week --write` writes its page.

Each cell works on a copy of one lab: a model, a run of two shots, runs of the stage and of the cell, and what finished
calibrations of a stage, of joints, of milling and of a feed leave.  What came of it is refused, with nothing changed;
said, and done; or done with the same bits.
"""

import os
import re
import shutil
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from benchmarks.page_table import put, table
from calibration.__main__ import main as calibrate
from calibration.joint_clamping.session import KIND as JOINTS
from calibration.stage_axes.experiment import KIND as STAGE
from rigkit import config as rig_file
from rigkit.retention import AHEAD, DAY
from stagectl.config import StageConfig
from stagectl.robot.config import CellConfig
from tests.scenario.lab import (
    Cell,
    Lab,
    at_work_on,
    beside,
    left,
    moved,
    repeated,
    stopped_then_rewired,
    unfinished,
)
from tests.scenario.lab_week_stage import CELLS as STAGE_CELLS
from tests.scenario.lab_week_stage import add_runs
from tests.until import until
from vibractl.__main__ import main as vibractl
from vibractl.config import RigConfig

SITUATIONS = ("repeated", "after an edit", "with another machine's model", "moved", "beside another")
NAME = "a week"
RIG = (
    "audio.isolated=false", "characterisation.records=3", "characterisation.period=1", "characterisation.run_in=0.3",
    "reference.signal=chirp:40:90:1", "session.shots=2",
)  # fmt: skip
WIDER = "audio.input_full_scale=200.0"


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
    add_runs(lab)
    return lab


RESUME = ("run", "--resume", "RUN", "--shots", "3")
NEW = ("run", "--config", "rig.toml", "--model", "model.h5", "--out", "NEW", "--shots", "1")
PREDICT = ("predict", "--config", "rig.toml", "--model", "model.h5", "--shots", "2")
KEEP = ("library", "add", "RUN", "--library", "LIB", "--name", "tank")
REPLAY = ("replay", "RUN")
VIBRATOR = ("vibrator", "--config", "rig.toml", "--out", "model.h5")
STAGE_WORDS = ("stage", "--config", "stage.toml", "--out", "s.h5")
JOINT_WORDS = ("joints", "--config", "cell.toml", "--out", "joints.h5")
REPORT, EXPORT = ("report", "RUN"), ("export", "RUN", "--format", "csv", "--out", "EXPORTED")
PRUNE = ("prune", "runs", "--newest", "1")
VELOCITY = ("velocity", "--axis", "y", "--out", "velocity.h5")


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


def stored(lab: Lab) -> None:
    """Put two copies of the run into a folder of runs, `old` a day older than `new`."""
    for name, age in (("new", 0.0), ("old", DAY)):
        copy = Path(shutil.copytree(lab.path / "RUN", lab.path / "runs" / name))
        for path in copy.rglob("*"):
            os.utime(path, (time.time() - age, time.time() - age))


def beside_a_run(lab: Lab, *words: str) -> tuple[int, str]:
    """Call it while another process goes on with the run."""
    with at_work_on(lab, vibractl, "RUN/shots/0003.wav", "run", "--resume", "RUN", "--shots", "1000"):
        return lab.call(vibractl, *words)


def pruned_beside_a_run(lab: Lab) -> tuple[int, str]:
    """Prune while another process goes on with the run that is too old, and see that this goes on still."""
    stored(lab)
    shots = lab.path / "runs" / "old" / "shots"
    with at_work_on(lab, vibractl, "runs/old/shots/0003.wav", "run", "--resume", "runs/old", "--shots", "1000"):
        newest = time.time() + AHEAD / 2
        os.utime(lab.path / "runs" / "new" / "qc.csv", (newest, newest))
        done = lab.heard(vibractl, *PRUNE)
        number = len(list(shots.glob("*.wav")))
        until(lambda: (shots / f"{number + 1:04d}.wav").exists())
    return done


def of_a_run(words: Sequence[str], beside_another: Cell | None) -> tuple[Cell | None, ...]:
    """Return the row of a command that reads a run."""
    return (
        lambda lab: repeated(lab, vibractl, *words),
        lambda lab: edited_run(lab, *words),
        lambda lab: other_model(lab, "RUN/model.h5", *words),
        lambda lab: moved(lab, vibractl, *words),
        beside_another,
    )


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
    "`vibractl replay`": of_a_run(REPLAY, lambda lab: beside(lab, "RUN", vibractl, *REPLAY)),
    "`vibractl report`": of_a_run(REPORT, lambda lab: beside_a_run(lab, *REPORT)),
    "`vibractl export`": of_a_run(EXPORT, lambda lab: beside_a_run(lab, *EXPORT)),
    "`vibractl prune`": (
        lambda lab: (stored(lab), repeated(lab, vibractl, *PRUNE))[1],
        None,
        None,
        lambda lab: (stored(lab), moved(lab, vibractl, *PRUNE))[1],
        pruned_beside_a_run,
    ),
    "`vibractl predict`": (
        lambda lab: lab.call(vibractl, *PREDICT),
        lambda lab: rewired(lab, vibractl, *PREDICT),
        lambda lab: other_model(lab, "model.h5", *PREDICT),
        lambda lab: moved(lab, vibractl, *PREDICT),
        None,
    ),
    "`vibractl library add`": of_a_run(KEEP, None),
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


SAID = {"is at work": "is at work", "in progress, not deleted": "is at work", "written over": "is written over"}
REFUSED = {
    "is finished": "is finished",
    "is in use": "is in use",
    "is there already": "is there already",
    "has an entry": "is there already",
}
"""What a line says, and how the table says it."""


def tried(cell: Cell, lab: Lab, place: Path) -> str:
    """Try a cell on a copy of the lab, and return what came of it."""
    copy = Lab(Path(shutil.copytree(lab.path, place / "lab")))
    recorded = copy.recordings()
    status, said = cell(copy)
    found = (Lab(place / "attic") if (place / "attic").exists() else copy).recordings()
    assert recorded <= found, "a recording is lost"
    refused = [line for line in said.splitlines() if line.startswith("error: ")]
    if refused:
        assert (status, len(refused)) == (2, 1)
        is_twice = "repeated" in cell.__code__.co_names
        assert is_twice or recorded == found, "it was refused, and has recorded all the same"
        return f"refused: {why(refused[0])}"
    for line in said.splitlines():
        if (" was " in line and " is " in line) or any(words in line for words in SAID):
            return f"said: {why(line)}{', drives differ' * bool(status)}"
    return "the same bits" if status == 0 else "said: drives differ"


def why(line: str) -> str:
    """Return what a line is about, in a few words."""
    if keys := re.findall(r"--accept (\S+)", line):
        return ", ".join(f"`{key}`" for key in keys)
    for words, short in {**SAID, **REFUSED}.items():
        if words in line:
            return short
    found = re.search(r"([\w.]+) was \S+, is ", line)
    return f"`{found[1]}`" if found else line


def rows() -> list[list[str]]:
    """Try all cells; return the table."""
    with tempfile.TemporaryDirectory() as folder:
        lab = first_lab(Path(folder) / "first")
        found = []
        for number, (command, cells) in enumerate({**CELLS, **STAGE_CELLS}.items()):
            row = [command]
            for column, cell in enumerate(cells):
                place = Path(folder) / f"{number}-{column}"
                place.mkdir()
                row.append("" if cell is None else tried(cell, lab, place))
            found.append(row)
        return found


if __name__ == "__main__":
    put(table(["command", *SITUATIONS], rows()), "origin.md", NAME)
