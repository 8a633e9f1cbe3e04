"""The commands of the pages in docs/ can be given by a stranger, who has an empty folder and what the page says.

`make test` reads each as its program does, looks where its files come from, and runs the quick ones in order; `make
soak` runs all that need no hardware as they are printed (docs.toml).
"""

import inspect
import re
import tomllib
from pathlib import Path

import pytest

from rigkit import config as rig_file
from rigkit.study.file import StudyFile
from stagectl.config import StageConfig
from stagectl.robot.config import CellConfig
from tests.commands.brought import BROUGHT
from tests.commands.dry_parse import APPLICATIONS, Parsed, helps, parse
from tests.commands.page_commands import TOOLS, block_commands, command_of, commands
from tests.commands.page_files import is_made, reads, writes
from tests.commands.running import HOUR, run, run_here
from tests.contract.source_tree import ROOT
from vibractl.config import RigConfig

STATED = tomllib.loads((Path(__file__).parent / "docs.toml").read_text())
COMMANDS_PAGE = tomllib.loads((Path(__file__).parent / "commands_page.toml").read_text())
ALL = {
    page.relative_to(ROOT).as_posix(): found
    for page in sorted((ROOT / "docs").rglob("*.md"))
    if (found := block_commands(page))
}
README = {"README.md": block_commands(ROOT / "README.md")}
TABLES = {each.text for each in commands(ROOT / "docs" / "commands.md")}
"""The commands of docs/commands.md, which test_commands_page.py runs."""
KINDS = {"vibractl": (RigConfig,), "stagectl": (StageConfig, CellConfig), "vibrostage": (StudyFile, RigConfig)}
"""What the rig files of a program can be; of the others any."""
EXAMPLE = re.compile(rf"(?:`|^ {{4}})((?:{'|'.join(APPLICATIONS)}) [^`]+?)(?:`|$)", re.MULTILINE)
LINE_BREAK = re.compile(r"(?<=\S)\n {4}(?=\S)")
"""Inside an example that is too long for a line."""
QUICK = [page for page, found in ALL.items() if {each.text for each in found} & set(STATED["appended"])]
READ = ALL | README
pages = pytest.mark.parametrize("page", ALL)
read_pages = pytest.mark.parametrize("page", READ)


def test_what_is_stated_of_commands_is_of_commands_that_are_there_and_for_a_reason() -> None:
    printed = {each.text for page in ALL.values() for each in page}
    assert set(STATED["appended"]) <= printed
    assert set(STATED["not_run"]) <= printed
    assert set(STATED["not_run"].values()) == set(STATED["reasons"])
    assert set(STATED["brought"]) <= set(ALL)
    assert len(printed) > 80


def test_each_of_the_readme_is_one_that_is_run() -> None:
    texts = {each.text for each in README["README.md"]}
    assert len(texts) > 10
    assert texts <= TABLES - set(COMMANDS_PAGE["not_run"])


@read_pages
def test_each_is_a_command_with_options_and_values_that_can_be(page: str) -> None:
    for command in READ[page]:
        if command.words[0] not in TOOLS:
            _refuse_wrong_settings(command.words[0], parse(command.words))


def test_so_is_each_example_of_a_help() -> None:
    texts = [LINE_BREAK.sub(" ", inspect.cleandoc(text)) for text in helps()]
    examples = [command_of(found) for text in texts for found in EXAMPLE.findall(text)]
    for example in examples:
        if example.words[-1] != "...":
            _refuse_wrong_settings(example.words[0], parse(example.words))
    assert len(examples) > 30


@read_pages
def test_each_file_that_one_reads_was_made_before_or_is_brought_by_the_reader(page: str) -> None:
    made = [Path(name) for name in STATED["brought"].get(page, ())]
    for command in READ[page]:
        parsed = Parsed("", {}) if command.words[0] in TOOLS else parse(command.words)
        absent = [str(path) for path in reads(parsed) if not is_made(path, made)]
        assert not absent, f"{command.text}: nothing has made {', '.join(absent)}"
        made += [*writes(parsed), *([Path(command.into)] if command.into else [])]


@read_pages
def test_no_two_make_the_same(page: str) -> None:
    """A run's folder and a model that are there already are refused."""
    named = [parse(each.words).options.get("--out", ()) for each in READ[page] if each.words[0] not in TOOLS]
    made = [str(path) for out in named for path in out]
    assert sorted(set(made)) == sorted(made)


@pytest.mark.parametrize("page", QUICK)
def test_the_quick_ones_work_in_order(
    page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    _bring(page, tmp_path)
    for command in ALL[page]:
        if command.words[0] in TOOLS and command.into:
            assert run(command, tmp_path).returncode == 0
        if command.text not in STATED["appended"]:
            continue
        run_here(command, STATED["appended"][command.text], monkeypatch, capsys)


@pytest.mark.slow
@pytest.mark.timeout(2 * HOUR)
@pages
def test_all_work_in_order_as_they_are_printed(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "kept"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    folder = tmp_path / "lab"
    folder.mkdir()
    _bring(page, folder)
    for command in ALL[page]:
        if command.text not in STATED["not_run"]:
            done = run(command, folder)
            assert done.returncode == 0, f"{command.text}: {done.stderr[-2_000:]}"


def _bring(page: str, folder: Path) -> None:
    for name in STATED["brought"].get(page, ()):
        if name in BROUGHT:
            BROUGHT[name](folder / name)


def _refuse_wrong_settings(program: str, parsed: Parsed) -> None:
    """Raise what a rig file of the program raises for the values of --set; of those that it can be, the last one's."""
    settings = [str(each) for each in parsed.options.get("--set", ())]
    *others, last = KINDS.get(program, (RigConfig, StageConfig, CellConfig))
    for kind in others:
        try:
            rig_file.load(None, kind, settings)
        except ValueError:
            continue
        return
    rig_file.load(None, last, settings)
