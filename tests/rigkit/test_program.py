"""Programs of which only the command that is called is imported."""

import subprocess
import sys

import pytest
import typer

from calibration.application import PROGRAM as CALIBRATE
from rigkit.program import help_of
from stagectl.application import PROGRAM as STAGECTL
from vibractl.application import PROGRAM as VIBRACTL
from vibrostage.application import PROGRAM as VIBROSTAGE
from vibrostage.application import STUDY

PROGRAMS = {"vibractl": VIBRACTL, "stagectl": STAGECTL, "calibration": CALIBRATE, "study": STUDY}


@pytest.mark.parametrize("name", PROGRAMS)
def test_what_stands_in_the_help_is_what_each_command_says_of_itself(name: str) -> None:
    made = PROGRAMS[name].only(), PROGRAMS[name].described()
    called, known = (typer.main.get_command(each) for each in made)
    assert {each: command.help for each, command in known.commands.items()} == {  # type: ignore[attr-defined]
        each: command.help
        for each, command in called.commands.items()  # type: ignore[attr-defined]
    }


HEAVY = {"matplotlib", "scipy", "numba", "h5py", "httpx", "fastapi", "uvicorn", "pyfftw", "sounddevice", "soundfile"}
HEAVY |= {"can", "google.protobuf", "clarabel", "pyarrow", "dask", "jinja2"}
"""What no `--help` needs: each takes between a tenth of a second and a whole one."""


@pytest.mark.parametrize("option", ["--help", "--version"])
@pytest.mark.parametrize(
    ("module", "words"),
    [
        *((module, []) for module in ("vibractl", "stagectl", "calibration", "firmware_sim")),
        *(("vibrostage", [*word]) for word in ((), ("plan",), *((each,) for each in VIBROSTAGE.programs))),
    ],
)
def test_the_help_of_a_program_imports_nothing_heavy(module: str, words: list[str], option: str) -> None:
    code = f"import sys; sys.argv[1:] = {[*words, option]}; from {module}.__main__ import main\n"
    code += "try: status = main()\nexcept SystemExit as end: status = end.code\n"
    code += f"print('imported', *({HEAVY!r} & set(sys.modules))); sys.exit(status)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.rpartition("imported")[2].split() == []
    assert len(done.stdout.splitlines()) > 1


@pytest.mark.sample(2)
@pytest.mark.parametrize(
    ("name", "command", "unwanted"),
    [
        ("vibractl", "status", {"scipy", "matplotlib", "numba"}),
        ("vibractl", "example-config", {"scipy", "matplotlib", "numba"}),
        ("vibractl", "judge", {"vibractl.session", "httpx"}),
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
