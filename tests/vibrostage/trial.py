"""A program for studies in tests: `trial SEED --json FILE`, quick to begin, that ends in every way there is.

`programs_with_trial` puts it among the programs of this distribution, for this process and those that it starts.
"""

import json
import os
import random
import signal
import sys
from importlib.metadata import version
from pathlib import Path
from threading import Event

import pytest

from tests.contract.source_tree import ROOT


def main() -> int:
    """Draw a figure by a seed; then end as KIND says."""
    _, seed, kind, file, *_ = sys.argv
    if kind == "refused" and int(seed) % 3 == 0:
        sys.stderr.write(f"warning\nerror: seed {seed} in {Path.cwd() / 'x'}, must be odd\n")
        return 2
    if kind == "fault":
        raise RuntimeError(f"seed {seed}")
    if kind == "crash":
        os.kill(os.getpid(), signal.SIGSEGV)
    if kind == "killed":
        os.kill(os.getpid(), signal.SIGKILL)
    if kind == "stopped" and not (before := Path.cwd().parent / f"stopped-{seed}").exists():
        before.touch()
        return 130
    if kind == "silent" and file == "told.json":
        return 1
    if kind == "exit":
        sys.exit("no more")
    if kind == "hang":
        Event().wait()
    if kind in ("slow", "second"):
        Event().wait(0.05 if kind == "slow" else 1.0)
    drawn = random.Random(int(seed))
    told = {"gap": drawn.random(), "shots": [{"iae": drawn.random()} for _ in range(3)], "met": drawn.choice([5, None])}
    Path(file).write_text(json.dumps(told))
    sys.stdout.write(f"seed {seed}\n")
    return 0


def programs_with_trial(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let studies run `trial`."""
    about = folder / f"vibrostage-{version('vibrostage')}.dist-info"
    about.mkdir()
    (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: vibrostage\nVersion: {version('vibrostage')}\n")
    (about / "entry_points.txt").write_text("[console_scripts]\ntrial = tests.vibrostage.trial:main\n")
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(folder), str(ROOT)]))
