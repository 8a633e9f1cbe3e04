"""What every command has in common: --version, short names, what --out is, words that a shell completes."""

import os
import re
import subprocess
import sys

import pytest
from typer.main import get_command

from rigkit.command import USER_ERROR
from rigkit.common_options import SHORT
from tests.commands.dry_parse import APPLICATIONS, options, outs
from tests.commands.running import MAINS
from tests.contract.source_tree import ROOT
from tests.until import EVER

FOLDERS = {"RUN/", "DIR"}
MAKE_FOLDERS = {
    *("vibractl run", "vibractl import", "vibractl export"),
    *(f"stagectl {name}" for name in ("run", "midrange", "step", "cell", "ilc", "force", "robot-files", "export")),
    *("vibrostage study run", "vibrostage study replay"),
}
"""Commands whose --out is a folder; of all others it is a file."""
MODULES = {name: main.__module__ for name, main in MAINS.items()}


def test_every_command_says_its_version() -> None:
    assert {name for name, names in options().items() if "--version" not in names} == set()


def test_a_version_is_said_behind_a_command_that_wants_more(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["stagectl", "estimate-force", "--version"])
    assert MAINS["stagectl"]() == 0
    assert re.match(r"vibrostage \d", capsys.readouterr().out)


def test_a_common_option_has_its_short_name_everywhere_and_no_other_has_it() -> None:
    for name, names in options().items():
        for long, short in SHORT.items():
            assert (long in names) == (short in names), f"{name}: {long}, {short}"


def test_out_is_a_folder_or_a_file_as_the_page_lists_it() -> None:
    made = outs()
    folders = {name for name, metavar in made.items() if metavar in FOLDERS}
    assert folders == MAKE_FOLDERS, "MAKE_FOLDERS of this file, and the table of --out in docs/command-line.md"
    files = {name: metavar for name, metavar in made.items() if name not in MAKE_FOLDERS}
    assert [name for name, metavar in files.items() if not re.fullmatch(r"FILE|[A-Z]+\.\w+", metavar)] == []
    page = (ROOT / "docs/command-line.md").read_text()
    absent = [name for name in made if name.split()[-1] not in page and name.split()[0] != "calibrate"]
    assert absent == [], "the table of --out in docs/command-line.md"


def test_a_command_without_settings_says_that_it_has_no_set(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, names in options().items():
        if "--set" not in names:
            words = name.split()
            monkeypatch.setattr(sys, "argv", [*words, "--set", "a.b=3"])
            assert MAINS[words[0]]() == USER_ERROR
            assert "this command reads no settings" in capsys.readouterr().err, name


@pytest.mark.parametrize(
    ("line", "meant"),
    [
        ("vibractl jugde", "'judge'"),
        ("vibractl library lsit", "'list'"),
        ("vibrostage vibratr run", "'vibrator'"),
        ("vibractl run --refrence chirp:40:90:5", "--reference"),
        ("stagectl cell --confg cell.toml", "--config"),
        ("vibractl doctor --set reference.singal=x", "signal?"),
        ("vibractl doctor --set signal=x", "reference.signal?"),
    ],
)
def test_what_may_have_been_meant_is_named(
    line: str, meant: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", line.split())
    assert MAINS[line.split()[0]]() == USER_ERROR
    said = capsys.readouterr().err
    assert "id you mean" in said
    assert meant in said


@pytest.mark.sample(4)
@pytest.mark.parametrize(
    ("line", "completed"),
    [
        ("vibractl re", ["replay", "report"]),
        ("vibractl run --re", ["--reference", "--resume"]),
        ("vibractl run --reference ", ["chirp:F0:F1:SECONDS", "sine:F0:SECONDS"]),
        ("vibractl run --reference ref", []),
        ("stagectl run --scenario ", ["milling-x", "milling-y", "milling-z"]),
        ("stagectl plan POCKET.json --planner s", ["sequential"]),
        ("calibrate vibrator --around r", ["reference"]),
        ("firmware-sim draw s", ["signal", "stage"]),
        ("vibrostage cell mi", ["midrange"]),
        ("vibrostage vibrator run --li", ["--library"]),
    ],
)
def test_a_shell_completes(line: str, completed: list[str]) -> None:
    """Nothing is completed as a file, by the shell itself."""
    program, *words = line.split(" ")
    variable = f"_{program.replace('-', '_').upper()}_COMPLETE"
    asked = {variable: "complete_bash", "COMP_WORDS": "\n".join([program, *words]), "COMP_CWORD": str(len(words))}
    code = f"import sys; sys.argv = [{program!r}]; from {MODULES[program]} import main; sys.exit(main())"
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, **asked},
        capture_output=True,
        text=True,
        timeout=EVER,
        check=False,
    )
    assert (done.returncode, done.stdout.split()) == (0, completed), done.stderr


@pytest.mark.parametrize("program", APPLICATIONS)
def test_a_program_offers_its_completion(program: str) -> None:
    names = {name for each in get_command(APPLICATIONS[program]).params for name in each.opts}
    assert {"--install-completion", "--show-completion", "--version"} <= names
