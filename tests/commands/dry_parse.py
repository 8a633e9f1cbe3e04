"""A command line read as its program reads it, without doing what it says."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

from typer.main import get_command

from calibration.application import PROGRAM as CALIBRATE
from firmware_sim.application import PROGRAM as FIRMWARE_SIM
from stagectl.application import PROGRAM as STAGECTL
from vibractl.application import PROGRAM as VIBRACTL
from vibrostage.application import PROGRAM as VIBROSTAGE
from vibrostage.application import STUDY

APPLICATIONS = {
    "vibractl": VIBRACTL.only(),
    "stagectl": STAGECTL.only(),
    "calibrate": CALIBRATE.only(),
    "firmware-sim": FIRMWARE_SIM.only(),
    "vibrostage": VIBROSTAGE.only(),
}
APPLICATIONS["vibrostage"].add_typer(STUDY.only(), name="study")


@dataclass(frozen=True)
class Parsed:
    """What a command was given.

    Parameters
    ----------
    name : str
        Of the command, such as "library add"; empty for the program itself.
    options : mapping of str to tuple
        Texts and numbers by the option's longest spelling, or by the argument's name.
    """

    name: str
    options: Mapping[str, tuple[Any, ...]]


def parse(words: tuple[str, ...]) -> Parsed:
    """Read a command line: program, command, options.

    Raises
    ------
    TyperException : no such command or option, one that is missing, or a value that cannot be one.
    """
    found = _program(words[0]).main([*words[1:]], prog_name=words[0], standalone_mode=False)
    return found if isinstance(found, Parsed) else Parsed("", {})


def helps() -> list[str]:
    """Return what every command says of itself."""
    return [command.help or "" for name in APPLICATIONS for _, command in _leaves(_program(name))]


def options() -> dict[str, set[str]]:
    """Return the names of every command's options, by the command with its program."""
    leaves = ((name, words, command) for name in APPLICATIONS for words, command in _leaves(_program(name)))
    return {
        " ".join((name, *words)): {option for each in command.params for option in each.opts}
        for name, words, command in leaves
    }


def outs() -> dict[str, str]:
    """Return how each command that has --out names what is given to it."""
    leaves = ((name, words, command) for name in APPLICATIONS for words, command in _leaves(_program(name)))
    return {
        " ".join((name, *words)): str(each.metavar)
        for name, words, command in leaves
        for each in command.params
        if "--out" in each.opts
    }


@cache
def _program(name: str) -> Any:
    """Return a program whose commands return what they are given."""
    program = get_command(APPLICATIONS[name])
    for words, command in _leaves(program):
        spelling = {each.name: max(each.opts, key=len) for each in command.params}
        command.callback = _returner(" ".join(words), spelling)
    return program


def _leaves(command: Any, words: tuple[str, ...] = ()) -> list[tuple[tuple[str, ...], Any]]:
    below = getattr(command, "commands", {})
    found = [leaf for name, each in below.items() for leaf in _leaves(each, (*words, name))]
    return found or [(words, command)]


def _returner(name: str, spelling: Mapping[str, str]) -> Callable[..., Parsed]:
    def given(**values: Any) -> Parsed:
        return Parsed(name, {spelling[key]: _several(value) for key, value in values.items() if value is not None})

    return given


def _several(value: Any) -> tuple[Any, ...]:
    return tuple(value) if isinstance(value, list | tuple) else (value,)
