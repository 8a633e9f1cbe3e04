"""`vibractl example-config`."""

import tomllib
from typing import Annotated

import typer

from rigkit import config as rig_file
from rigkit.command import JsonOption, words, write_json
from rigkit.common_options import one_of
from vibractl.config import RigConfig
from vibractl.presets import PRESETS


def example_config(
    preset: Annotated[
        str | None,
        typer.Option(metavar="underwater", help="A short file for a special case.", autocompletion=one_of(PRESETS)),
    ] = None,
    json: JsonOption = None,
) -> None:
    """Print a complete rig file for the simulator: every key with its unit, range and default.

    Example: `vibractl example-config > rig.toml`; in water, before a hydrophone: `--preset underwater`
    """
    if preset is not None and preset not in PRESETS:
        raise ValueError(f"--preset is {preset!r}, must be {' or '.join(PRESETS)}")
    text = rig_file.example(RigConfig) if preset is None else PRESETS[preset]
    words(json).write(text)
    write_json(json, tomllib.loads(text))
