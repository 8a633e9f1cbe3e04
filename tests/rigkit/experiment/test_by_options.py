"""An experiment that its options say all of: each key an option of the command, all of it checked in one place."""

import json
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import pytest

from rigkit import command as command_line
from rigkit.config import Section, setting
from rigkit.experiment.by_options import ByOptions
from rigkit.experiment.kind import Kind, Records
from rigkit.experiment.part import Part
from tests.rigkit.experiment.test_runner import part
from tests.rigkit.rig_file import RigFile


class CountOptions(Section):
    """What is counted."""

    run: str = setting("", "", "name of its folder")
    paced: bool = setting(False, "", "in real time")
    end: int = setting(300, "counts", "of it", ge=1, le=1000)
    by: Literal[1, 2] = setting(1, "1", "which column")
    loudly: bool = setting(False, "", "say so")


@dataclass
class Counting:
    """An experiment of one part."""

    config: RigFile
    asked: CountOptions
    seconds: float = 3.0
    room: int = 1_000

    @property
    def about(self) -> Mapping[str, str]:
        return {}

    @property
    def designed(self) -> Mapping[str, Any]:
        return self.asked.model_dump()

    def parts(self, *_: object) -> Iterator[Part]:
        yield part()

    def again(self, records: Records) -> Iterator[Part]:
        raise NotImplementedError

    def figures(self, records: Records) -> dict[str, Any]:
        return {"last": float(records["counts"].data[:, 0][-1]), **self.asked.model_dump()}

    def report(self, path: Path, *_: object) -> None:
        (path / "report.html").touch()


def _read(*_: object) -> Counting:
    raise NotImplementedError


COUNTING = ByOptions(
    Kind("counting", _read),
    RigFile,
    CountOptions,
    "device.isolated",
    Counting,
    lambda made: f"counting to {made.asked.end}",
    lambda _: pytest.fail("a command has no view"),
    lambda figures, out: print(f"{figures['last']:g}", file=out),
)


def called(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    app = command_line.application("Counts.")
    app.command("count")(COUNTING.command("Count."))
    monkeypatch.setattr(sys, "argv", ["program", "count", *words])
    return command_line.run(app, "tests")


def test_each_key_is_an_option_but_those_of_the_daemon(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert called(monkeypatch, "--help") == 0
    told = capsys.readouterr().out
    assert all(word in told for word in ("Count.", "--end", "COUNTS", "1|2", "--loudly", "--live", "In a process of"))
    assert "--run" not in told
    assert "--paced" not in told


def test_what_is_asked_is_what_is_made(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    assert called(monkeypatch, "--end", "5", "--by", "2", "--loudly", "--json", "-") == 0
    told = capsys.readouterr()
    asked = {"last": 299.0, "run": "", "paced": False, "end": 5, "by": 2, "loudly": True}
    assert json.loads(told.out) == asked
    assert "299" in told.err
    assert "counting to 5" in told.err


def test_what_cannot_be_asked_is_refused_in_a_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert called(monkeypatch, "--by", "3") == 2
    assert capsys.readouterr().err == "error: by is 3, must be 1 or 2\n"
