"""A short run of the vibrator on disks that fail, taken up again: `python -m tests.scenario.failing_disk KIND FOLDER`.

KIND is `size`, where no file may pass a number of bytes, or `files`, where no more than a number of files may be open;
both are the system's own limits (RLIMIT_FSIZE, RLIMIT_NOFILE), so that libsndfile and HDF5 meet them too.  Prints how
many runs failed.
"""

import os
import resource
import shutil
import sys
from pathlib import Path

import h5py
import numpy as np

from ctlblocks import recording
from rigkit.run_folder import CONFIG, RunFolder, read_events, read_quality
from tests.rigkit.killed_run import in_a_child
from tests.vibractl.linear_rig import linear_config, linear_model
from vibractl.run_setup import create, setup_of
from vibractl.session import Session
from vibractl.shot_file import split

SHOTS = 2
SIZES = (0, 10, 1_000, 3_000, 40_000, 200_000, 400_000, 1_000_000)
"""Bytes: below, within and above those of configuration, plans, lines, model and shots."""
FAILED = 3
"""Exit status of a run that ended by an error of ours or of the system."""


def learn(path: Path, model: Path) -> None:
    """Begin a run, or take it up, and emit all its shots."""
    if (path / CONFIG).exists():
        with RunFolder.open(path) as run:
            _emit(Session(run, setup_of(path)))
        return
    run, made = create(path, linear_config(), model)
    with run:
        _emit(Session(run, made))


def _emit(session: Session) -> None:
    session.run(SHOTS, lambda *_: None, lambda: False)
    session.summary()


def check(path: Path) -> int:
    """Return the shots that are there; every file that has its name must be whole."""
    for file in path.glob("shots/*.h5"):
        with h5py.File(file) as lines:
            assert np.isfinite(lines["gain"][()]).all()
    assert all(event["event"] for event in read_events(path))
    return sum(len(recording.read(file).data) > 0 for file in path.glob("shots/*.wav"))


def check_the_end(path: Path, whole: Path) -> None:
    """All shots must be there, with the drives of a run in which nothing failed."""
    assert check(path) == len(read_quality(path)) == SHOTS
    for number in range(SHOTS):
        drives = [_drive(folder, number) for folder in (path, whole)]
        assert drives[0].tobytes() == drives[1].tobytes()


def _drive(path: Path, number: int) -> np.ndarray:
    return split(recording.read(path / "shots" / f"{number:04d}.wav"), linear_config())[0]


def _limited(limit: int, value: int, path: Path, model: Path) -> None:
    resource.setrlimit(limit, (value, resource.getrlimit(limit)[1]))
    try:
        learn(path, model)
    except (OSError, ValueError) as fault:
        resource.setrlimit(limit, (resource.getrlimit(limit)[1],) * 2)
        os._exit(FAILED if str(fault) else 1)


def main(kind: str, folder: Path) -> int:
    model, failed = linear_model(folder), 0
    learn(folder / "whole", model)
    opened = len(os.listdir("/proc/self/fd"))
    values = range(opened, opened + 6) if kind == "files" else SIZES
    limit = resource.RLIMIT_NOFILE if kind == "files" else resource.RLIMIT_FSIZE
    for value in values:
        path = folder / "run"
        shutil.rmtree(path, ignore_errors=True)
        _, status = os.waitpid(in_a_child(lambda value=value, path=path: _limited(limit, value, path, model)), 0)
        assert os.waitstatus_to_exitcode(status) in (0, FAILED), f"{kind} {value}: {status}"
        failed += status != 0
        if path.exists():
            check(path)
        learn(path, model)
        check_the_end(path, folder / "whole")
    return failed


if __name__ == "__main__":
    sys.stdout.write(str(main(sys.argv[1], Path(sys.argv[2]))))
