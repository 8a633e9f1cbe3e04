"""Runs of every experiment killed at random moments: what must be there afterwards, and go on."""

import json
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rigkit.experiment.kept import told
from rigkit.growing_wav import GROWING
from stagectl.robot.milling.milling_models import write_milling
from tests.stagectl.experiments.feed.small_pocket import QUICK
from tests.stagectl.experiments.feed.test_command import POCKET
from tests.stagectl.experiments.piezo.simulated_models import write_models
from tests.stagectl.experiments.toroid.short_cell import SHORT
from tests.stagectl.experiments.trials.short_trial import SMALL
from tests.stagectl.robot.milling.test_milling_models import models

LATE = 0.5
"""s before a kill up to which all that was recorded must be there."""
ILC = ("--task", "pocket", "--iterations", "2")


def _models() -> list[str]:
    return [word for axis in "xyz" for word in ("--model", f"{axis}.h5")]


def _set(*settings: str) -> list[str]:
    return [word for each in settings for word in ("--set", each)]


COMMANDS = {
    "run": [*_models(), *_set("session.lead=0.5", "session.seconds=3")],
    "midrange": ["--scenario", "toroid", *_set("midranging.session.lead=6")],
    "step": _set("midranging.session.lead=6"),
    "cell": ["--setup", "all", *_set(*SHORT)],
    "ilc": ["--model", "models.h5", *ILC, *_set(*SMALL, "pocket.feed=25e-3", "learning.free=1")],
    "force": ["--task", "pocket.json", "--paced", "--pockets", "2", *_set(*QUICK)],
}
RESUMED = {"cell", "ilc"}
"""Kinds that go on."""


@dataclass(frozen=True)
class Killed:
    """What came of a kill.

    Parameters
    ----------
    after : float, s
        Since the run had a folder.
    outcome : str
        In a word.
    """

    after: float
    outcome: str


def kills(kind: str, place: Path, times: int, seed: int) -> Iterator[Killed]:
    """Kill runs at moments drawn evenly over what a whole one takes to record; AssertionError where one leaves less.

    Parameters
    ----------
    kind : str, of `COMMANDS`
    place : Path
        An empty folder.
    times : int
    seed : int
    """
    write_milling(place / "models.h5", models(), {})
    write_models(place)
    (place / "pocket.json").write_text(json.dumps(POCKET))
    for name in ("first", "whole"):  # the first one may compile
        program, begun = _begun(kind, place, place / name)
        assert program.wait() == 0, f"{kind}: the run itself ends with {program.returncode}"
    now = time.time() - time.monotonic()
    recorded = [*(place / "whole").glob("*.wav"), *(place / "whole").glob("recording.csv")]
    length = max(file.stat().st_mtime for file in recorded) - (begun + now)
    drawn = np.random.default_rng([seed, len(kind)]).uniform(0.0, 1.05 * length, times)
    for number, after in enumerate(drawn.tolist()):
        path = place / f"run-{number}"
        program, begun = _begun(kind, place, path)
        time.sleep(max(0.0, begun + after - time.monotonic()))
        program.send_signal(signal.SIGKILL)
        program.wait()
        yield Killed(after, _outcome(kind, place, path, time.time()))
        shutil.rmtree(path, ignore_errors=True)


def _begun(kind: str, place: Path, path: Path) -> tuple[subprocess.Popen[bytes], float]:
    """Begin a run; return it, and when it had a folder, s of the monotonic clock."""
    words = [sys.executable, "-m", "stagectl", kind, *COMMANDS[kind], "--out", str(path)]
    program = subprocess.Popen(words, cwd=place, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while not (path / "run.json").exists() and program.poll() is None:
        time.sleep(0.005)
    return program, time.monotonic()


def _outcome(kind: str, place: Path, path: Path, moment: float) -> str:
    """Look what a kill has left; a run that nothing is recorded of says so."""
    if not (path / "run.json").exists():
        return "nothing begun"
    _refuse_late(path, moment)
    growing = {file.stem: file.stat().st_size for file in path.glob(f"*{GROWING}")}
    report = _stagectl(place, "report", str(path))
    if report.returncode:
        assert b"nothing" in report.stderr or b"had not begun" in report.stderr or b"no trial" in report.stderr, report
        outcome = "nothing to judge"
    else:
        _replay(place, path)
        outcome = "reported, replayed"
    for stem, size in growing.items():
        whole = path / f"{stem.removesuffix('.part')}.wav"
        assert not whole.exists() or whole.stat().st_size >= size - 4096, f"{whole} has lost what was in {stem}"
    if kind not in RESUMED:
        return outcome
    resumed = _stagectl(place, kind, "--resume", str(path))
    if resumed.returncode and b"nothing is left of it" in resumed.stderr:
        return f"{outcome}; it was whole"
    assert resumed.returncode == 0, resumed
    _replay(place, path)
    return f"{outcome}; gone on with"


def _refuse_late(path: Path, moment: float) -> None:
    """See that of a part under way nothing older than `LATE` is missing: its files have just been written to."""
    ended, begun = told(path, "ended"), told(path, "started")
    for part, event in begun.items():
        since = moment - time.mktime(time.strptime(event["time"][:19], "%Y-%m-%dT%H:%M:%S")) + time.timezone
        files = [file for file in path.glob(f"*{GROWING}") if file.name.startswith(part)]
        if part in ended or since < 2 * LATE or not files:
            continue
        newest = max(file.stat().st_mtime for file in files)
        assert moment - newest < LATE, f"{part}: the last thing that was recorded is {moment - newest:.2f} s old"


def _replay(place: Path, path: Path) -> None:
    replay = _stagectl(place, "replay", str(path))
    assert replay.returncode == 0, replay


def _stagectl(place: Path, *words: str) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run([sys.executable, "-m", "stagectl", *words], cwd=place, capture_output=True, check=False)
