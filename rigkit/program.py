"""Command lines of which only the command that is called is imported: the others are known by their help alone."""

import ast
from collections.abc import Mapping
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import typer

from rigkit.command import application

Commands = Mapping[str, str | tuple[str, str]]
"""By name, "package.module:function", or a `Typer` of several; where the help stands elsewhere, that as well."""


def program(purpose: str, commands: Commands, called: str | None) -> typer.Typer:
    """Make the command line of a program.

    Parameters
    ----------
    purpose : str
        Said in its help.
    commands : Commands
    called : str, optional
        The first word of the command line; its command alone is imported.  All of them without it.
    """
    app = application(purpose)
    for name, code in commands.items():
        where, told = (code, code) if isinstance(code, str) else code
        if called in (None, name):
            module, _, attribute = where.partition(":")
            _add(app, name, getattr(import_module(module), attribute))
        else:
            app.command(name)(_named(help_of(told)))
    return app


def help_of(code: str) -> str:
    """Return the docstring of "package.module:function", or the first text that a `Typer` is made with, unimported."""
    module, _, attribute = code.partition(":")
    spec = find_spec(module)
    assert spec is not None
    assert spec.origin is not None
    for node in ast.walk(ast.parse(Path(spec.origin).read_text(encoding="utf-8"))):
        if isinstance(node, ast.FunctionDef) and node.name == attribute:
            return ast.get_docstring(node) or ""
        if isinstance(node, ast.Assign) and any(ast.unparse(each) == attribute for each in node.targets):
            texts = (each.value for each in ast.walk(node.value) if isinstance(each, ast.Constant))
            return next((text for text in texts if isinstance(text, str)), "")
    raise LookupError(f"{code}: there is no such function")


def _add(app: typer.Typer, name: str, command: Any) -> None:
    if isinstance(command, typer.Typer):
        app.add_typer(command, name=name)
    else:
        app.command(name)(command)


def _named(text: str) -> Any:
    """Return a command that stands in the help alone."""

    def command() -> None:
        raise AssertionError("another command was called")

    command.__doc__ = text
    return command
