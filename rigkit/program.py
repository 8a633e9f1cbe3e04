"""A program of several commands, of which only the one that is called, or completed, is imported."""

import ast
import os
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import typer

from rigkit.code_name import resolve
from rigkit.command import application, run


@dataclass(frozen=True)
class Program:
    """What a program is for, and its commands.

    Parameters
    ----------
    purpose : str
        Said in its help.
    commands : mapping of str
        By name, "package.module:function", or a `Typer` of several; where the help stands elsewhere, that as well.
    packages : tuple of str
        As of `rigkit.command.run`.
    programs : mapping of str to str
        Other programs, "package.module:PROGRAM", that are called by a word ahead of their commands.
    """

    purpose: str
    commands: Mapping[str, str | tuple[str, str]]
    packages: tuple[str, ...]
    programs: Mapping[str, str] = field(default_factory=dict)

    def part(self, purpose: str, *names: str) -> "Program":
        """Return a program of some of its commands."""
        return Program(purpose, {name: self.commands[name] for name in names}, self.packages)

    def run(self) -> int:
        """Run the command line that this process was called with, and return its exit status."""
        if (typed := _typed()) is not None:
            return run(self.described(typed), *self.packages)
        called = next(iter(sys.argv[1:]), "")
        if called in self.programs:
            sys.argv[:2] = [f"{Path(sys.argv[0]).name} {called}"]
            program: Program = resolve(self.programs[called])
            return program.run()
        return run(self.only(called) if called in self.commands else self.described(), *self.packages)

    def only(self, *names: str) -> typer.Typer:
        """Make a command line of these commands alone, or of all where none is named."""
        app = application(self.purpose)
        for name in names or self.commands:
            self._add(app, name)
        return app

    def described(self, typed: Sequence[str] = ()) -> typer.Typer:
        """Make a command line that knows each command by its help, and imports none but the one that was typed.

        Parameters
        ----------
        typed : sequence of str
            The words that a shell is to complete, the program's own left out.
        """
        app, called = application(self.purpose), next(iter(typed), "")
        for name in self.commands:
            if name == called:
                self._add(app, name)
            else:
                app.command(name)(_described(help_of(self._places(name)[1])))
        for name, place in self.programs.items():
            program: Program = resolve(place)
            if name == called:
                app.add_typer(program.described(typed[1:]), name=name)
            else:
                app.command(name)(_described(program.purpose))
        return app

    def _add(self, app: typer.Typer, name: str) -> None:
        module, _, attribute = self._places(name)[0].partition(":")
        command = getattr(import_module(module), attribute)
        if isinstance(command, typer.Typer):
            app.add_typer(command, name=name)
        else:
            app.command(name)(command)

    def _places(self, name: str) -> tuple[str, str]:
        """Return where a command stands, and where its help does."""
        code = self.commands[name]
        return (code, code) if isinstance(code, str) else code


def _typed() -> list[str] | None:
    """Return what has been typed where a shell asks to complete it; None where a command is to be run."""
    name = Path(sys.argv[0]).name.replace("-", "_").upper()
    if f"_{name}_COMPLETE" not in os.environ:
        return None
    return (os.environ.get("COMP_WORDS") or os.environ.get("_TYPER_COMPLETE_ARGS", "")).split()[1:]


def help_of(code: str) -> str:
    """Return the docstring of "package.module:function", or the first text that a `Typer` is made with, unimported."""
    module, _, attribute = code.partition(":")
    package, *inside = module.split(".")
    spec = find_spec(package)  # of a module in a package it would import that
    assert spec is not None
    assert spec.origin is not None
    source = Path(spec.origin).parent.joinpath(*inside).with_suffix(".py")
    for node in ast.walk(ast.parse(source.read_text(encoding="utf-8"))):
        if isinstance(node, ast.FunctionDef) and node.name == attribute:
            return ast.get_docstring(node) or ""
        if isinstance(node, ast.Assign) and any(ast.unparse(each) == attribute for each in node.targets):
            texts = (each.value for each in ast.walk(node.value) if isinstance(each, ast.Constant))
            return next((text for text in texts if isinstance(text, str)), "")
    raise LookupError(f"{code}: there is no such function")


def _described(text: str) -> Any:
    """Return a command that stands in the help alone."""

    def command() -> None:
        raise AssertionError("a command that is there was not imported")

    command.__doc__ = text
    return command
