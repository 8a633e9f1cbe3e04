"""A run and a calibration under the daemon on a disk that fails at any call: a FAULT that says why, silence, no part.

Guards against procedures that end without a word, lines that stay open, and parts of files that pass for whole ones.
"""

import io
import json
import os
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from calibration import vibrator_procedure
from calibration.names import raw_folder
from ctlblocks import recording
from rigkit import atomic
from rigkit.run_folder import CONFIG, read_quality
from rigkit.service.state import State
from tests.rigkit.failing_calls import FAULTS, Failing
from tests.rigkit.killed_run import CALLS
from tests.scenario.failing_disk import SHOTS, check
from tests.vibractl.daemon.bench import Lab, lab_in
from tests.vibractl.daemon.kept_drive import KeptDrive
from tests.vibractl.daemon.killed import straight_model
from vibractl.daemon import running
from vibractl.model_file import read_model

KEPT = "reference.amplitude=1.0", "simulator.plant=tests.vibractl.daemon.kept_drive:KeptDrive", "simulator.options={}"
QUICK = 37
"""From one call that fails to the next, in `make test`."""
OPTIONS = {"run": {"run": "one", "shots": SHOTS}, "calibrate": {"model": "found.h5"}}

pytestmark = pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")


def labs(folder: Path, patch: pytest.MonkeyPatch, procedure: str, stride: int) -> Iterator[tuple[Lab, bool]]:
    """Begin a procedure in rig after rig, a call failing in each; yield the rig at its end, and whether one failed.

    For each kind of fault it ends with the pass in which nothing was left to fail.
    """
    calls, opened = {name: getattr(os, name) for name in CALLS}, io.open
    calls["fsync"] = os.fstat  # does nothing: some disks take 10 ms to sync
    for place, number in enumerate(FAULTS):
        for step in range(1 + place * stride // len(FAULTS), 10_000, stride):
            lab, failing = straight_lab(folder / f"{number}-{step}"), Failing(step, number)
            with patch.context() as patched:
                lab.control.arm(lab.key, "a test")
                for name, call in calls.items():
                    patched.setattr(os, name, failing.counted(name, call))
                patched.setattr(io, "open", failing.counted("open", opened))
                lab.begin(procedure, **OPTIONS[procedure])
                lab.ended()
            failing.is_over = True
            yield lab, failing.happened
            lab.control.close(60)
            lab.control.journal.close()
            if not failing.happened:
                break
        else:
            raise AssertionError("there is always one more call to fail")


def straight_lab(folder: Path) -> Lab:
    """Return a rig whose plant keeps what it is driven with, and follows it."""
    folder.mkdir()
    lab = lab_in(folder, *KEPT)
    (lab.data / "model.h5").unlink()
    straight_model(lab.data / "model.h5")
    KeptDrive.openings.clear()
    return lab


def fail_and_go_on(folder: Path, patch: pytest.MonkeyPatch, procedure: str, stride: int) -> int:
    """Let calls fail, look at what is left, and go on; return how many were told as a FAULT."""
    patch.setattr(running, "run_report", lambda _: None)
    patch.setattr(vibrator_procedure, "sweep_report", lambda *_: NoReport())
    told = 0
    for lab, failed in labs(folder, patch, procedure, stride):
        assert lab.state in ((State.FAULT, State.ARMED) if failed else (State.ARMED,)), lab.control.machine.last.why
        assert not any(opening[-1].any() for opening in KeptDrive.openings if opening)
        assert list(lab.rig.gauges())[0].name == "disk_free"  # the line is closed
        whole(lab)
        refused = "has not begun" in lab.control.machine.last.why  # the disk has no room for it, before anything moves
        if lab.state is State.FAULT or refused:
            told += 1
            assert lab.control.machine.last.why
            if lab.state is State.FAULT:
                lab.control.acknowledge(lab.key, "the disk is another")
            resumed = procedure == "run" and (lab.data / "runs" / "one" / CONFIG).exists()
            lab.begin(procedure, **OPTIONS[procedure], **({"resume": True} if resumed else {}))
            lab.ended()
            assert lab.state is State.ARMED, lab.control.machine.last.why
        whole(lab)
        if procedure == "run":
            assert check(lab.data / "runs" / "one") == len(read_quality(lab.data / "runs" / "one")) == SHOTS
        else:
            read_model(lab.data / "found.h5", (2, 2))
    return told


class NoReport:
    """A report that nobody reads: drawing it takes seconds."""

    def write(self, path: Path) -> None:
        path.write_text("")


def whole(lab: Lab) -> None:
    """Look at everything on the disk that has its name."""
    run = lab.data / "runs" / "one"
    if run.exists():
        check(run)
    raw = raw_folder(lab.data / "found.h5")
    for file in raw.glob("*.wav") if raw.exists() else ():
        assert np.isfinite(recording.read(file).data).all()
    for path in (lab.data, run, raw):
        assert not path.exists() or all(file.name.startswith(".") for file in atomic.leftovers(path))
    lab.control.journal.close()
    lines = (lab.data / "events.jsonl").read_text().splitlines()
    assert all("event" in json.loads(line) for line in lines)


@pytest.mark.slow
def test_a_call_that_fails_is_a_fault_and_the_run_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert fail_and_go_on(tmp_path, monkeypatch, "run", QUICK) >= 3


@pytest.mark.slow
@pytest.mark.parametrize("procedure", ["run", "calibrate"])
def test_whichever_call_fails_it_is_a_fault_and_the_procedure_goes_on(
    procedure: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert fail_and_go_on(tmp_path, monkeypatch, procedure, 1) >= 60
