"""The command `daemon` of a rig's command line."""

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from rigkit.code_name import resolve
from rigkit.command import ConfigOption, JsonOption, SetOption, write_json
from rigkit.config import Section
from rigkit.service.access import TOKENS, new_tokens
from rigkit.service.config import Daemon
from rigkit.service.daemon import run
from rigkit.service.read_again import ReadAgain
from rigkit.service.rig import Rig


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


def daemon_of(choose: Choose) -> Callable[..., None]:
    """Return the command `daemon` of a rig's command line."""

    def daemon_command(
        config: ConfigOption = None,
        settings: SetOption = None,
        renew: Annotated[
            bool, typer.Option("--new-tokens", help="Make new tokens; the old ones become invalid.")
        ] = False,
        json: JsonOption = None,
    ) -> None:
        """Run as a service: states, page, API, metrics.  It begins DISARMED; Ctrl-C stops and ends.

        --json writes its address once it is ready.

        Example: `daemon --config rig.toml`, then open its address in a browser
        """
        kind = choose(config, settings or ())
        load = ReadAgain(config, kind.model, settings or ())
        table: Daemon = load().daemon  # type: ignore[attr-defined]  # as `Kind` says
        if renew:
            Path(table.data).mkdir(parents=True, exist_ok=True)
            new_tokens(Path(table.data) / TOKENS)
        made: Rig = resolve(kind.rig)(load)
        place = {"address": table.address, "tokens": str(Path(table.data) / TOKENS)}

        def say(text: str) -> None:
            write_json(json, {"program": made.program, "rig": made.name, "state": "DISARMED", **place})
            sys.stdout.flush()
            sys.stderr.write(f"{text}\n")

        run(made, table, say, config)

    return daemon_command
