"""`stagectl acknowledge`."""

from typing import Annotated

import typer

from rigkit import config as rig_file
from rigkit.command import ConfigOption, JsonOption, SetOption, words, write_json
from stagectl.config import StageConfig
from stagectl.link.stage_link import StageLink


def acknowledge_command(
    by: Annotated[str, typer.Option(metavar="NAME", help="The person who investigated it.")],
    config: ConfigOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Clear a latched fault of the stage behind its CAN adapter, and record who investigated it.

    Example: `stagectl acknowledge --config stage.toml --by "A. Person"`
    """
    made = rig_file.load(config, StageConfig, settings or [])
    with StageLink(made.link) as link:
        reason = link.acknowledge(by)
    print(f"{by} has acknowledged: {reason}", file=words(json))
    write_json(json, {"by": by, "fault": reason})
