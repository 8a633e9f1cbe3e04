"""Programs of which only the command that is called is imported."""

import subprocess
import sys

import pytest
import typer

from calibration.application import PROGRAM as CALIBRATE
from rigkit.program import help_of
from stagectl.application import PROGRAM as STAGECTL
from vibractl.application import PROGRAM as VIBRACTL

PROGRAMS = {"vibractl": VIBRACTL, "stagectl": STAGECTL, "calibration": CALIBRATE}


@pytest.mark.parametrize("name", PROGRAMS)
def test_what_stands_in_the_help_is_what_each_command_says_of_itself(name: str) -> None:
    made = PROGRAMS[name].only(), PROGRAMS[name].described()
    called, known = (typer.main.get_command(each) for each in made)
    assert {each: command.help for each, command in known.commands.items()} == {  # type: ignore[attr-defined]
        each: command.help
        for each, command in called.commands.items()  # type: ignore[attr-defined]
    }


@pytest.mark.sample(2)
@pytest.mark.parametrize(
    ("name", "command", "unwanted"),
    [
        ("vibractl", "--help", {"scipy", "matplotlib", "httpx", "numba"}),
        ("vibractl", "status", {"scipy", "matplotlib", "numba"}),
        ("vibractl", "example-config", {"scipy", "matplotlib", "numba"}),
        ("vibractl", "judge", {"vibractl.session", "httpx"}),
        ("stagectl", "--help", {"scipy", "matplotlib", "httpx", "numba"}),
        ("calibration", "compare", {"stagectl", "calibration.subspace", "httpx"}),
    ],
)
def test_a_command_imports_nothing_that_is_not_its_own(name: str, command: str, unwanted: set[str]) -> None:
    code = f"import sys; sys.argv[1:] = {[command, '--help']}; from {name}.application import PROGRAM; PROGRAM.run(); "
    done = subprocess.run(
        [sys.executable, "-c", f"{code} print('modules', *sys.modules)"], capture_output=True, text=True, check=True
    )
    assert unwanted & set(done.stdout.rpartition("modules")[2].split()) == set()


def test_a_command_that_is_not_there_is_told_with_those_that_are() -> None:
    app = VIBRACTL.described()
    with pytest.raises(typer.TyperException, match="No such command 'jugde'. Did you mean 'judge'"):
        app(["jugde"], standalone_mode=False)


def test_help_that_stands_nowhere_is_a_fault_of_the_program() -> None:
    with pytest.raises(LookupError, match="vibractl.replay_command:other: there is no such function"):
        help_of("vibractl.replay_command:other")
