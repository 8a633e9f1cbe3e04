"""Exporting at the shell: files whole or not there, and one line where it cannot be."""

import json
import sys
from pathlib import Path

import pytest

from tests.vibractl.export.exported_run import recorded_run
from vibractl.__main__ import main
from vibractl.export import run as exporting
from vibractl.export.run import export_run


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return recorded_run(tmp_path_factory.mktemp("run"))


def call(monkeypatch: pytest.MonkeyPatch, *arguments: object) -> int:
    monkeypatch.setattr("sys.argv", ["vibractl", "export", *map(str, arguments)])
    return main()


def test_every_format_goes_into_the_run_unless_told_otherwise(
    run: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(monkeypatch, run, "--json", "-") == 0
    files = json.loads(capsys.readouterr().out)["files"]
    tables = ["responses", "reference", "shot-0000", "shot-0002"]
    names = ["run.uff", "run.sgy", "run.mat", "run.mcap"]
    names += [f"{table}.{suffix}" for suffix in ("csv", "parquet") for table in tables]
    assert files == [str(run / "export" / name) for name in names]
    assert sorted(file.name for file in (run / "export").iterdir()) == sorted(names)


def test_one_format_can_be_a_file_of_any_name(run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    place = tmp_path / "new" / "sweeps.segy"
    assert call(monkeypatch, run, "--format", "segy", "--out", place, "--shots", "1") == 0
    assert [file.name for file in place.parent.iterdir()] == ["sweeps.segy"]


def test_an_export_that_fails_leaves_what_was_there(run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def half(path: Path, _: object) -> None:
        path.write_text("half")
        raise RuntimeError("the disk is gone")

    (tmp_path / "run.mat").write_text("before")
    monkeypatch.setitem(exporting._WRITERS, "mat", ("run.mat", half))  # noqa: SLF001
    with pytest.raises(RuntimeError):
        export_run(run, ("mat",), tmp_path)
    assert [(file.name, file.read_text()) for file in tmp_path.iterdir()] == [("run.mat", "before")]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--format", "seg-y"], "--format is 'seg-y', must be one of uff, segy, mat, mcap, csv, parquet"),
        (["--format", "csv", "--out", "OUT/run.mat"], "run.mat, must be a folder for --format csv"),
        (["--out", "OUT/run.mat"], "run.mat, must be a folder for --format uff, segy, mat, mcap, csv, parquet"),
        (["--shots", "7", "--out", "OUT/x"], "--shots asks for 7, must rise within 0 to 2"),
    ],
)
def test_what_cannot_be_exported_is_one_line_and_writes_nothing(
    run: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    arguments: list[str],
    words: str,
) -> None:
    assert call(monkeypatch, run, *[part.replace("OUT", str(tmp_path)) for part in arguments]) == 2
    errors = capsys.readouterr().err.splitlines()
    assert len(errors) == 1
    assert words in errors[0]
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("formats", "missing"), [(["mcap"], "mcap"), (["csv", "segy"], "segyio"), ([], "pyuff")])
def test_a_format_whose_package_is_not_installed_leaves_no_folder_and_no_file_of_another(
    formats: list[str],
    missing: str,
    run: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    for name in [name for name in sys.modules if name.split(".")[0] == missing] or [missing]:
        monkeypatch.setitem(sys.modules, name, None)
    options = [word for name in formats for word in ("--format", name)]
    assert call(monkeypatch, run, *options, "--out", tmp_path / "new" / "folder", "--shots", "1") == 2
    assert f"this format needs {missing}" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_a_folder_without_a_run_is_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(monkeypatch, tmp_path) == 2
    assert "is not the folder of a run" in capsys.readouterr().err
