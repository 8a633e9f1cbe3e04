"""The command `vibrostage study example`."""

import tomllib
from importlib.resources import files

from rigkit.command import JsonOption, words, write_json


def example_command(json: JsonOption = None) -> None:
    """Print a small study: two learning laws on three simulated vibrators, a minute on two cores.

    Example: `vibrostage study example > STUDY.toml`
    """
    text = files("vibrostage").joinpath("quick.toml").read_text(encoding="utf-8")
    words(json).write(text)
    write_json(json, tomllib.loads(text))
