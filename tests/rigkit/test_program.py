"""Command lines of which only the command that is called is imported."""

import subprocess
import sys

import pytest
import typer

from calibration import application as calibrate
from rigkit.lazy_commands import help_of, program
from stagectl import application as stagectl
from vibractl import application as vibractl

PROGRAMS = {"vibractl": vibractl, "stagectl": stagectl, "calibration": calibrate}


@pytest.mark.parametrize("name", PROGRAMS)
def test_what_stands_in_the_help_is_what_each_command_says_of_itself(name: str) -> None:
    called, known = (typer.main.get_command(PROGRAMS[name].application(one)) for one in (None, "no such command"))
    assert {each: command.help for each, command in known.commands.items()} == {  # type: ignore[attr-defined]
        each: command.help
        for each, command in called.commands.items()  # type: ignore[attr-defined]
    }


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
    code = f"import sys; from {name}.application import application; application({command!r}); print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert unwanted & set(done.stdout.split()) == set()


def test_a_command_that_is_not_there_is_told_with_those_that_are() -> None:
    app = program("A rig.", vibractl.COMMANDS, "jugde")
    with pytest.raises(typer.TyperException, match="No such command 'jugde'. Did you mean 'judge'"):
        app(["jugde"], standalone_mode=False)


def test_help_that_stands_nowhere_is_a_fault_of_the_program() -> None:
    with pytest.raises(LookupError, match="vibractl.replay_command:other: there is no such function"):
        help_of("vibractl.replay_command:other")
