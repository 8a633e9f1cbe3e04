"""What a task whose commands did not end well is said to have come to."""

import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from rigkit.study import programs
from rigkit.study.performing import perform
from rigkit.study.task import Task


@pytest.mark.parametrize(
    ("status", "printed", "told", "message"),
    [
        (1, "| x | on |\n1 of 3 loops is off\n", "z-chirp, 83 s of signal 100 %\n", "1 of 3 loops is off"),
        (1, "", "z-chirp, 83 s of signal 100 %\n", "z-chirp, 83 s of signal 100 %"),
        (2, "| x | on |\n", "z-chirp 40 %\nerror: limits.travel is 0\n", "error: limits.travel is 0"),
    ],
)
def test_a_verdict_is_what_was_printed_and_a_refusal_what_was_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, status: int, printed: str, told: str, message: str
) -> None:
    def run(_words: Sequence[str]) -> int:
        sys.stdout.write(printed)
        sys.stderr.write(told)
        sys.stdout.flush()
        sys.stderr.flush()
        return status

    found = _performed(tmp_path, monkeypatch, run)
    assert (found.status, found.failed, found.message) == (status, 1, message)


def test_a_fault_of_a_program_is_the_last_line_of_its_traceback(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def run(_words: Sequence[str]) -> int:
        sys.stdout.write("| x | on |\n")
        sys.stdout.flush()
        raise ZeroDivisionError("by nought")

    assert _performed(tmp_path, monkeypatch, run).message == "ZeroDivisionError: by nought"


def _performed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, run):  # type: ignore[no-untyped-def]
    monkeypatch.setattr(programs, "call", run)
    monkeypatch.setattr(sys, "stdout", open(1, "w", closefd=False))  # noqa: SIM115  # a program's, not the test's
    monkeypatch.setattr(sys, "stderr", open(2, "w", closefd=False))  # noqa: SIM115
    files = tmp_path / "files"
    files.mkdir()
    return perform(Task("k", "m", 1, {}, (("stagectl",),), {}, 60.0, "nothing"), files, tmp_path / "scratch")
