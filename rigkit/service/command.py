"""The commands `status` and `stop` of a rig's command line: they wait for nothing that a daemon imports."""

from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.live import Live
from rich.table import Table
from rich.text import Text

from rigkit import os_fault
from rigkit.command import ConfigOption, JsonOption, SetOption, words, write_json
from rigkit.service.client import Client
from rigkit.service.config import Daemon
from rigkit.service.own_table import daemon_table
from rigkit.service.show import Output
from rigkit.service.stopping import client_of, is_answered, stopped

TokenOption = Annotated[
    Path | None,
    typer.Option(
        "--token",
        metavar="FILE",
        help="File with one token, to view or to operate; default: the daemon's own file.",
    ),
]

_OUTPUT: dict[Output, str] = {"on": "on", "zero": "zero", "unknown": "not measured"}
_COLOURS = {"good": "green", "near": "yellow", "over": "red", "unknown": "dim", "free": ""}


def status_command(
    config: ConfigOption = None,
    settings: SetOption = None,
    watch: Annotated[bool, typer.Option("--watch", help="Update until Ctrl-C.")] = False,
    token: TokenOption = None,
    json: JsonOption = None,
) -> None:
    """Show the state of the daemon of this rig file; status 1 in FAULT.

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


def stop_command(
    config: ConfigOption = None,
    settings: SetOption = None,
    why: Annotated[str, typer.Option(metavar="TEXT", help="For the event log.")] = "from the command line",
    token: TokenOption = None,
    json: JsonOption = None,
) -> None:
    """Bring the output to zero and disarm, whoever has control.  Not an emergency stop: that removes the power.

    Any of the daemon's tokens suffices, also the one to view.  The rig file may have been edited since.

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
        raise ValueError(f"{os_fault.told(fault)}; {there} at {table.address}") from None


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
