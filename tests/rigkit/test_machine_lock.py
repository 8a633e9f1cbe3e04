"""What there is once on a machine is held by one process, whatever folder it works in, and goes with that process."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from rigkit.machine_lock import FOLDER, DeviceInUseError, MachineLock, holder_of

HOLDING = """
import sys
from rigkit.machine_lock import MachineLock
lock = MachineLock("card")
print("has it", flush=True)
sys.stdin.read()
"""
ROOT = Path(__file__).parents[2]


@pytest.fixture(autouse=True)
def _of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(FOLDER, str(tmp_path / "locks"))


def holding() -> subprocess.Popen[str]:
    """Start a process that holds the card."""
    pipe = subprocess.PIPE
    process = subprocess.Popen([sys.executable, "-c", HOLDING], cwd=ROOT, stdin=pipe, stdout=pipe, text=True)
    assert process.stdout is not None
    assert process.stdout.readline() == "has it\n"
    return process


def test_another_process_is_told_who_has_it_and_since_when() -> None:
    other = holding()
    assert holder_of("card") == other.pid
    with pytest.raises(DeviceInUseError, match=rf"card is in use by process {other.pid} \(-c.*\), since 20\d\d-"):
        MachineLock("card")
    MachineLock("another card").release()
    other.kill()
    other.communicate()
    assert holder_of("card") is None
    lock = MachineLock("card")
    assert holder_of("card") == os.getpid()
    lock.release()
    lock.release()
    assert holder_of("card") is None


def test_in_one_process_it_is_held_once() -> None:
    lock = MachineLock("card")
    with pytest.raises(DeviceInUseError, match="card is in use by process"):
        MachineLock("card")
    lock.release()


def test_a_link_in_the_place_of_a_lock_is_not_followed(tmp_path: Path) -> None:
    MachineLock("card").release()
    (file,) = (tmp_path / "locks").iterdir()
    file.unlink()
    (tmp_path / "precious").write_text("mine")
    file.symlink_to(tmp_path / "precious")
    with pytest.raises(OSError, match="symbolic link"):
        MachineLock("card")
    assert (tmp_path / "precious").read_text() == "mine"
    assert holder_of("card") is None


def test_nonsense_in_a_lock_names_nobody(tmp_path: Path) -> None:
    lock = MachineLock("card")
    (file,) = (tmp_path / "locks").iterdir()
    file.write_text("{")
    assert holder_of("card") is None
    with pytest.raises(DeviceInUseError, match="in use by another process"):
        MachineLock("card")
    lock.release()
