"""Where a command is to write is looked at before it does anything."""

import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import pytest
import typer

from rigkit import atomic, command
from rigkit.command import JsonOption, PngOption
from rigkit.written import written_file

Call = Callable[..., int]
app = command.application("Reads and writes.")
done: list[str] = []


@app.command("work")
def work(
    data: Annotated[Path, typer.Argument(metavar="DATA")],
    model: Annotated[list[Path] | None, typer.Option(metavar="FILE", help="Read.")] = None,
    out: Annotated[Path | None, written_file("FILE", "Written.")] = None,
    page: Annotated[Path | None, written_file("FILE", "Written.", "--report")] = None,
    png: PngOption = None,
    json: JsonOption = None,
) -> None:
    """Work for hours."""
    if out is not None and out.is_file():
        if model:
            out.rename("old")  # set aside, as a calibration does that is made again
        atomic.write(out, "new")
    done.append(f"{data} {model} {out} {page} {png} {json}")


@app.command("rest")
def rest() -> None:
    """Do nothing: one command alone has no name."""


@pytest.fixture
def call(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Call:
    """Return what calls it in a folder with a file and a folder."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").touch()
    (tmp_path / "folder").mkdir()
    done.clear()

    def called(*words: str) -> int:
        monkeypatch.setattr(sys, "argv", ["rig", "work", *words])
        return command.run(app, "tests")

    return called


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("in", "--json", "folder"), "--json folder is a folder, must be a file"),
        (("in", "--out", "folder"), "'folder' is a directory"),
        (("in", "--out", "no/x"), "--out no/x cannot be: no is no folder"),
        (("in", "--json", "no/x"), "--json no/x cannot be: no is no folder"),
        (("in", "--json", "file/x"), "--json file/x cannot be: file is no folder"),
        (("in", "--png", "file"), "'file' is a file"),
        (("in", "--png", "file/x/y"), "--png file/x/y cannot be: file is no folder"),
        (("file", "--out", "./file"), "--out file is DATA's file, must be another: it would be written over"),
        (("in", "--model", "a", "--model", "file", "--json", "file"), "--json file is --model's file, must be another"),
        (
            ("in", "--out", "new", "--report", "folder/../new"),
            "--report folder/../new is --out's file, must be another",
        ),
        (("in", "--out", "new", "--json", "new"), "--json new is --out's file, must be another"),
    ],
)
def test_what_cannot_be_written_is_refused_at_once(
    call: Call, capsys: pytest.CaptureFixture[str], words: tuple[str, ...], message: str
) -> None:
    assert call(*words) == 2
    error = capsys.readouterr().err
    assert message in error
    assert (error.count("\n"), done) == (1, [])


def test_what_can_be_written_is_left_to_the_command(call: Call) -> None:
    assert call("file", "--model", "file", "--out", "new", "--png", "a/b/c", "--json", "-") == 0
    assert call("folder", "--png", "folder", "--json", "other") == 0
    assert done == ["file [PosixPath('file')] new None a/b/c -", "folder None None None folder other"]


def test_a_folder_that_may_not_be_written_in_is_refused_at_once(
    call: Call, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """As the system says it: whoever runs the tests as root may write anywhere."""
    access = os.access
    monkeypatch.setattr(os, "access", lambda path, mode: Path(path).name != "folder" and access(path, mode))
    for words in (("--out", "folder/x"), ("--png", "folder/x/y"), ("--json", "folder/x")):
        assert call("in", *words) == 2
        assert "cannot be: nothing may be written in folder\n" in capsys.readouterr().err
    assert done == []


def test_a_file_that_was_written_over_is_named_and_one_that_was_set_aside_or_left_is_not(
    call: Call, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call("in", "--out", "file", "--json", "told.json") == 0
    assert capsys.readouterr().err == "written over: file\n"
    assert call("in", "--out", "file", "--model", "in", "--json", "told.json") == 0
    assert call("in", "--report", "file") == 0
    assert capsys.readouterr().err == ""
