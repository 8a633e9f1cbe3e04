"""What every command line shares: settings, figures as JSON, tables, and an end that says what went wrong."""

import sys
from collections.abc import Iterable, Mapping, Sequence
from dis import opname
from pathlib import Path
from typing import Annotated, Any, TextIO

import typer
from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from rigkit import atomic, os_fault
from rigkit.common_options import SHORT, VersionOption
from rigkit.json_text import json_text
from rigkit.stop import Stopped
from rigkit.written import Application, made_folder

USER_ERROR = 2
STOPPED = 130
"""Exit statuses: what was asked for cannot be done; ended by Ctrl-C."""

WIDEST_TABLE = 200
"""Columns, where the output is no terminal."""


ConfigOption = Annotated[
    Path | None, typer.Option("--config", metavar="FILE", help="Rig file (TOML); without one, the defaults.")
]
SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="TABLE.KEY=VALUE", help="Set one key over the rig file; may be repeated."),
]
JsonOption = Annotated[
    str | None,
    typer.Option("--json", metavar="FILE", help="Write the figures as JSON; - for the standard output."),
]
PngOption = Annotated[Path | None, made_folder("DIR", "Write the figures as PNG files as well.", "--png")]
RunArgument = Annotated[Path, typer.Argument(metavar="RUN/", help="Folder of a run.")]


def laid_over(settings: list[str] | None, flags: Mapping[str, object]) -> list[str]:
    """Return what a command line lays over the rig file: what was set, then the keys that its options stand for.

    An option that was not given is None or False, and stands for nothing.
    """
    given = {key: value for key, value in flags.items() if value is not None and value is not False}
    return [*(settings or []), *(f"{key}={'true' if value is True else value}" for key, value in given.items())]


def application(purpose: str) -> typer.Typer:
    """Make a command line without commands that says `purpose` in its help; `command` of the result adds them.

    Its own options say which software it is, and install or show what completes it in the shell that called it.
    """
    app = Application(pretty_exceptions_enable=False, rich_markup_mode="markdown")
    app.callback(help=purpose)(_own_options)  # so that a lone command keeps its name, too
    return app


def run(app: typer.Typer, *packages: str) -> int:
    """Run a command line and return its exit status.

    What a person can put right becomes one line on stderr and status 2: a wrong option, a file or device that fails
    (OSError), and a ValueError, TypeError or LookupError that one of our own `raise` statements made.  Any other
    exception, and the same ones from within numpy or a slip of ours, is a fault of the program: it gives a traceback
    and status 1.  Ctrl-C gives 130.

    Parameters
    ----------
    packages : str
        The packages whose `raise` statements speak to the user, beside those of rigkit and ctlblocks.
    """
    try:
        status = app(standalone_mode=False)
        return status if isinstance(status, int) else 0
    except typer.TyperException as fault:
        return _end(f"error: {_misread(fault)}; --help shows how to call this", USER_ERROR)
    except Stopped as end:
        return _end(str(end), STOPPED)
    except OSError as fault:
        return _end(f"error: {os_fault.told(fault)}", USER_ERROR)
    except (ValueError, TypeError, LookupError) as fault:
        if not _is_raised_by(fault, {"rigkit", "ctlblocks", *packages}):
            raise
        return _end(f"error: {fault.args[0]}", USER_ERROR)


def write_json(target: str | None, figures: Mapping[str, Any]) -> None:
    """Write the figures that `--json` asked for: to a file in one step, to stdout for "-", nowhere for None.

    It is one object.  Numpy numbers and arrays are written as numbers and lists; what is not finite as null.
    """
    if target == "-":
        sys.stdout.write(f"{json_text(figures, indent=2)}\n")
    elif target is not None:
        atomic.write(target, f"{json_text(figures, indent=2)}\n")


def words(target: str | None) -> TextIO:
    """Return where text for people goes: stdout, or stderr when `--json -` has taken that."""
    return sys.stderr if target == "-" else sys.stdout


def print_table(title: str, head: Sequence[str], rows: Iterable[Sequence[str]], stream: TextIO) -> None:
    """Print a table, the first column to the left and the others, figures, to the right.

    Parameters
    ----------
    title : str
    head : sequence of str
        What each column holds, with its unit.
    rows : sequences of str, as many as `head`
    stream : text stream
    """
    table = Table(title=Text(title), title_justify="left", box=box.SIMPLE_HEAD)
    for number, name in enumerate(head):
        table.add_column(Text(name), justify="right" if number else "left")
    for row in rows:
        table.add_row(*map(Text, row))
    Console(file=stream, width=None if stream.isatty() else WIDEST_TABLE).print(table)


def _own_options(version: VersionOption = False) -> None:  # noqa: ARG001 (read by its callback)
    """Stand for the command line itself."""


def _misread(fault: typer.TyperException) -> str:
    """Return what is wrong with a command line; of an option that is not there, those that may have been meant."""
    option: str = getattr(fault, "option_name", "")
    if option in ("--set", SHORT["--set"]):
        return f"No such option: {option}: this command reads no settings that it could lay over"
    near: Sequence[str] = getattr(fault, "possibilities", None) or ()
    if option and near:
        return f"No such option: {option}. Did you mean {' or '.join(sorted(near))}?"
    return fault.format_message().rstrip(".")


def _end(text: str, status: int) -> int:
    sys.stderr.write(" ".join(text.split()) + "\n")
    return status


def _is_raised_by(fault: BaseException, packages: set[str]) -> bool:
    """Whether a `raise` statement in one of `packages` made `fault`, rather than a call that failed there."""
    place = fault.__traceback__
    while place is not None and place.tb_next is not None:
        place = place.tb_next
    if place is None:
        return False
    package = str(place.tb_frame.f_globals.get("__package__"))
    instruction = opname[place.tb_frame.f_code.co_code[place.tb_lasti]]
    return package.split(".")[0] in packages and instruction == "RAISE_VARARGS"
