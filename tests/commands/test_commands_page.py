"""The commands of docs/commands.md do what it says, in an empty folder, in their order.

`make test` runs them shortened as commands_page.toml states; `make soak` runs them as they are printed.
"""

import tomllib
from pathlib import Path

import pytest

from tests.commands.page_commands import commands
from tests.commands.running import HOUR, run, run_here
from tests.contract.source_tree import ROOT

STATED = tomllib.loads((Path(__file__).parent / "commands_page.toml").read_text())
COMMANDS = commands(ROOT / "docs" / "commands.md")


def test_what_is_stated_of_commands_is_of_commands_that_are_there_and_for_a_reason() -> None:
    printed = {each.text for each in COMMANDS}
    for table in ("appended", "not_run", "only_soak"):
        assert set(STATED[table]) <= printed
    assert set(STATED["not_run"].values()) <= set(STATED["reasons"])
    assert set(STATED["only_soak"].values()) <= set(STATED["soak"])
    assert len(printed) > 30


def test_they_work_in_order_when_they_are_shortened(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "kept"))
    for command in COMMANDS:
        if command.text in STATED["not_run"] or command.text in STATED["only_soak"]:
            continue
        run_here(command, STATED["appended"].get(command.text, ""), monkeypatch, capsys)


@pytest.mark.slow
@pytest.mark.timeout(2 * HOUR)
def test_they_work_in_order_as_they_are_printed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "kept"))
    folder = tmp_path / "lab"
    folder.mkdir()
    for command in COMMANDS:
        if command.text not in STATED["not_run"]:
            done = run(command, folder)
            assert done.returncode == 0, f"{command.text}: {done.stderr[-2_000:]}"
