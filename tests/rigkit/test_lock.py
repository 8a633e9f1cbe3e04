"""The lock on a folder."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from rigkit.lock import FolderInUseError, Lock

HOLDER = """
import sys
from pathlib import Path
from rigkit.lock import Lock
lock = Lock(Path(sys.argv[1]))
print("held", flush=True)
input()
"""


def test_a_second_holder_is_refused_and_told_who_has_it(tmp_path: Path) -> None:
    lock = Lock(tmp_path / ".lock")
    with pytest.raises(FolderInUseError, match=f"{tmp_path}/ is in use by process {os.getpid()}$"):
        Lock(tmp_path / ".lock")
    lock.release()


def test_a_released_lock_can_be_had_again(tmp_path: Path) -> None:
    lock = Lock(tmp_path / ".lock")
    lock.release()
    lock.release()
    Lock(tmp_path / ".lock").release()


def test_a_lock_is_gone_with_a_killed_holder(tmp_path: Path) -> None:
    command = [sys.executable, "-c", HOLDER, str(tmp_path / ".lock")]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as holder:
        assert holder.stdout is not None
        holder.stdout.readline()
        with pytest.raises(FolderInUseError, match=f"in use by process {holder.pid}$"):
            Lock(tmp_path / ".lock")
        holder.send_signal(signal.SIGKILL)
        holder.wait()
    Lock(tmp_path / ".lock").release()
