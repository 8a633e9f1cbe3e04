"""A system call that fails: the first, the second, and so on until a pass in which none is left to fail."""

import errno
import io
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.rigkit.killed_run import CALLS

FAULTS = (errno.ENOSPC, errno.EIO, errno.EMFILE)


class Failing:
    """Counts system calls; the one numbered `step` fails.  One that writes has written a half by then.

    Parameters
    ----------
    step : int
    number : int, an error of the system
    """

    def __init__(self, step: int, number: int) -> None:
        self.happened = self.is_over = False
        """Whether it has failed; whether none fails any more: a finalizer may hold on to a call beyond the patch."""
        self._left, self._number = step, number

    def counted(self, name: str, call: Callable[..., Any]) -> Callable[..., Any]:
        def replacement(*arguments: Any, **options: Any) -> Any:
            self._left -= not self.is_over
            if self._left or self.is_over:
                return call(*arguments, **options)
            self.happened = True
            if name in ("write", "pwrite"):
                call(arguments[0], arguments[1][: len(arguments[1]) // 2], *arguments[2:])
            if name == "close":
                call(*arguments)  # the handle is gone, whatever it says
            named = [str(arguments[0])] if isinstance(arguments[0], str | Path) else []  # as the system does
            raise OSError(self._number, os.strerror(self._number), *named)

        return replacement


def every_fault(
    work: Callable[[Path], object], folder: Path, patch: pytest.MonkeyPatch, stride: int = 1
) -> Iterator[tuple[Path, Exception | None]]:
    """Do `work` in folder after folder, a call of it failing; yield each folder and what `work` raised.

    For each kind of fault it ends with the pass in which nothing was left to fail.

    Parameters
    ----------
    work : callable(Path)
    folder : Path
    patch : MonkeyPatch
    stride : int
        From a call that fails to the next one that does; each kind of fault begins with another.
    """
    calls, opened = {name: getattr(os, name) for name in CALLS}, io.open
    calls["fsync"] = os.fstat  # does nothing: some disks take 10 ms to sync
    for place_of_fault, number in enumerate(FAULTS):
        for step in range(1 + place_of_fault * stride // len(FAULTS), 10_000, stride):
            failing, place, raised = Failing(step, number), folder / f"{number}-{step}", None
            place.mkdir()
            with patch.context() as patched:
                for name, call in calls.items():
                    patched.setattr(os, name, failing.counted(name, call))
                patched.setattr(io, "open", failing.counted("open", opened))
                try:
                    work(place)
                except (OSError, ValueError) as fault:
                    raised = fault
            failing.is_over = True
            assert failing.happened or raised is None
            yield place, raised
            if not failing.happened:
                break
        else:
            raise AssertionError("there is always one more call to fail")
