"""Without modules of POSIX, as on Windows, programs and doors are imported, and a run in this process works."""

import subprocess
import sys
from pathlib import Path

import pytest

from rigkit import posix
from rigkit.machine_lock import MachineLock
from tests.until import EVER
from tests.vibractl.linear_rig import linear_model

ABSENT = "import sys; sys.modules.update(dict.fromkeys(('fcntl', 'termios', 'tty', 'pty', 'resource', 'grp', 'pwd'))); "
IMPORTS = "; ".join(
    [
        "import vibrostage.ilc, vibrostage.sysid, vibrostage.planning, vibrostage.midranging",
        "import rigkit.lock, rigkit.machine_lock",
        "import stagectl.robot.live.person, rigkit.array_room, rigkit.study.performing, rigkit.study.engine",
        *(
            f"from {package}.application import PROGRAM as {package}; {package}.described()"
            for package in ("vibractl", "stagectl", "calibration", "firmware_sim", "vibrostage")
        ),
    ]
)


def run(code: str) -> subprocess.CompletedProcess[str]:
    words = [sys.executable, "-c", ABSENT + code]
    return subprocess.run(words, capture_output=True, text=True, timeout=EVER, check=False)


def test_programs_and_doors_are_imported_without_them() -> None:
    done = run(IMPORTS)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.slow
@pytest.mark.parametrize("package", ["vibractl", "calibration"])
def test_every_command_of_a_program_without_wires_is_imported_without_them(package: str) -> None:
    """Those of stagectl and firmware_sim import pyserial, which imports them itself on Linux."""
    done = run(f"from {package}.application import PROGRAM; PROGRAM.only()")
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.slow
def test_a_simulated_run_is_learned_replayed_and_reported_without_them(tmp_path: Path) -> None:
    model = linear_model(tmp_path)
    words = [
        "run",
        "--model",
        str(model),
        "--reference",
        "chirp:40:90:1",
        "--shots",
        "1",
        "--out",
        str(tmp_path / "run"),
    ]
    for each in (
        [*words, "--set", "audio.isolated=false"],
        ["replay", str(tmp_path / "run")],
        ["report", str(tmp_path / "run")],
    ):
        done = run(f"from vibractl.__main__ import main; sys.argv = ['vibractl', *{each!r}]; sys.exit(main())")
        assert done.returncode == 0, done.stderr


def test_a_device_is_not_opened_where_nothing_can_hold_it_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rigkit.machine_lock.fcntl", None)
    with pytest.raises(OSError, match="this system has no file locks, by which card is held alone"):
        MachineLock("card")


def test_what_needs_an_absent_module_says_so() -> None:
    posix.refuse_without(posix.tty, "pseudo-terminals")
    with pytest.raises(OSError, match="this system has no pseudo-terminals: that needs Linux"):
        posix.refuse_without(None, "pseudo-terminals")
