"""The commands `daemon`, `status` and `stop` of a rig's command line."""

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.live import Live
from rich.table import Table
from rich.text import Text

from rigkit.code_name import resolve
from rigkit.command import ConfigOption, JsonOption, SetOption, words, write_json
from rigkit.command import run as run_commands
from rigkit.config import Section
from rigkit.service.access import TOKENS, new_tokens
from rigkit.service.client import Client
from rigkit.service.config import Daemon
from rigkit.service.daemon import run
from rigkit.service.own_table import daemon_table
from rigkit.service.read_again import ReadAgain
from rigkit.service.rig import Rig
from rigkit.service.show import Output
from rigkit.service.stopping import client_of, is_answered, stopped

_QUICK = (["status"], ["stop"], ["--version"])
"""First words of command lines which are not to wait for anything."""

TokenOption = Annotated[
    Path | None,
    typer.Option(
        "--token",
        metavar="FILE",
        help="File that holds one token alone, to view or to operate; the daemon's own file of tokens unless given.",
    ),
]

_OUTPUT: dict[Output, str] = {"on": "on", "zero": "zero", "unknown": "not measured"}
_COLOURS = {"good": "green", "near": "yellow", "over": "red", "unknown": "dim", "free": ""}


@dataclass(frozen=True)
class Kind:
    """One kind of rig that a command line serves.

    Parameters
    ----------
    model : subclass of Section
        What a whole rig file of it holds; its table `daemon` is a `Daemon`.
    rig : str
        "package.module:Class", which makes the `Rig` from a function that reads the rig file again; imported by the
        daemon alone.
    """

    model: type[Section]
    rig: str


Choose = Callable[[Path | None, Sequence[str]], Kind]
"""From a rig file, or none, and the settings to lay over it, to the kind of rig that it is of."""


def add_daemon_commands(app: typer.Typer, choose: Choose) -> None:
    """Add the commands to a rig's command line.

    Parameters
    ----------
    app : Typer
    choose : callable(config, settings) -> Kind
    """
    _add_daemon(app, choose)
    _add_status(app)
    _add_stop(app)


def run_application(app: typer.Typer, commands: str, *packages: str) -> int:
    """Run a rig's command line and return its exit status; what is quick waits for no other command's imports.

    Parameters
    ----------
    app : Typer
        With the daemon's commands.
    commands : str
        Module that adds the others to it.
    packages : str
        As of `rigkit.command.run`.
    """
    if sys.argv[1:2] not in _QUICK:
        import_module(commands)
    return run_commands(app, *packages)


def _add_daemon(app: typer.Typer, choose: Choose) -> None:
    @app.command("daemon")
    def daemon_command(
        config: ConfigOption = None,
        settings: SetOption = None,
        renew: Annotated[
            bool, typer.Option("--new-tokens", help="Make new tokens; the old are worth nothing.")
        ] = False,
    ) -> None:
        """Run as a service: states, page, API, metrics.  It begins DISARMED; Ctrl-C stops and ends.

        Example: `daemon --config rig.toml`, then open its address in a browser
        """
        kind = choose(config, settings or ())
        load = ReadAgain(config, kind.model, settings or ())
        table: Daemon = load().daemon  # type: ignore[attr-defined]  # as `Kind` says
        if renew:
            Path(table.data).mkdir(parents=True, exist_ok=True)
            new_tokens(Path(table.data) / TOKENS)
        made: Rig = resolve(kind.rig)(load)
        run(made, table, _say, config)


def _add_status(app: typer.Typer) -> None:
    @app.command("status")
    def status_command(
        config: ConfigOption = None,
        settings: SetOption = None,
        watch: Annotated[bool, typer.Option("--watch", help="Go on showing it until Ctrl-C.")] = False,
        token: TokenOption = None,
        json: JsonOption = None,
    ) -> None:
        """Show how the daemon of this rig file stands; status 1 in FAULT.

        Example: `status --config rig.toml --watch`
        """
        table = daemon_table(config, settings or ())
        with _client(table, token) as client:
            if watch:
                _watch(client)
            shown = client.snapshot()
        Console(file=words(json)).print(_table(shown))
        write_json(json, shown)
        if shown["state"]["name"] == "FAULT":
            raise typer.Exit(1)


def _add_stop(app: typer.Typer) -> None:
    @app.command("stop")
    def stop_command(
        config: ConfigOption = None,
        settings: SetOption = None,
        why: Annotated[str, typer.Option(metavar="TEXT", help="For the event log.")] = "from the command line",
        token: TokenOption = None,
        json: JsonOption = None,
    ) -> None:
        """Bring the output to zero and disarm, whoever has control.  No emergency stop: that one cuts the mains.

        Any of the daemon's tokens will do, the one to view as well.  A rig file that was edited since may be wrong.

        Example: `stop --config rig.toml --why "smoke"`
        """
        try:
            table: Daemon | str = daemon_table(config, settings or ())
        except (ValueError, OSError) as fault:
            table = str(fault)
        how = stopped(table, config, token, why)
        words(json).write(f"{how}\n")
        write_json(json, {"stopped": how})


def _client(table: Daemon, token: Path | None) -> Client:
    """Return a client for a daemon, with the token in a file, or with the one that its own file has to operate.

    Raises
    ------
    ValueError, OSError : there is no token; the text says whether something answers there.
    """
    try:
        return client_of(table, token)
    except OSError as fault:
        there = "something answers" if is_answered(table) else "nothing answers"
        raise ValueError(f"{fault.filename}: {fault.strerror}; {there} at {table.address}") from None


def _say(text: str) -> None:
    sys.stderr.write(f"{text}\n")


def _watch(client: Client) -> None:
    """Show every snapshot until Ctrl-C."""
    with Live(console=Console(), auto_refresh=False) as live:
        try:
            for shown in client.watch():
                live.update(_table(shown), refresh=True)
        except KeyboardInterrupt:
            return


def _table(shown: dict[str, Any]) -> Table:
    state, procedure, control = shown["state"], shown["procedure"], shown["control"]
    table = Table(title=f"{shown['program']} {shown['rig']}, {shown['time']}", show_header=False, box=None)
    rows = {"state": f"{state['name']} since {state['since']}: {state['why']} ({state['who']})"}
    rows["output"] = _OUTPUT[shown["output"]]
    rows["control"] = control["who"] if control else "nobody"
    if procedure:
        left = "" if procedure["seconds_left"] is None else f", {procedure['seconds_left']:.0f} s left"
        done = f"{procedure['done']:g} of {procedure['total']:g} {procedure['unit']}{left}"
        rows[procedure["title"]] = f"{done}; {procedure['note']}"
    if shown["journal_fault"]:
        rows["event log"] = shown["journal_fault"]
    for name, told in rows.items():
        table.add_row(Text(name), Text(told))
    for gauge in shown["gauges"]:
        value = "-" if gauge["value"] is None else f"{gauge['value']:.4g}"
        bounds = " ".join(
            f"{sign} {gauge[key]:.4g}" for sign, key in ((">=", "low"), ("<=", "high")) if gauge[key] is not None
        )
        text = Text(f"{value} {gauge['unit']}".removesuffix(" 1"), style=_COLOURS[gauge["verdict"]])
        table.add_row(Text(gauge["title"]), text + Text(f"  {bounds}", style="dim"))
    return table
