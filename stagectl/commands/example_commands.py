"""`stagectl example-config`, `example-cell` and `example-pocket`."""

from rigkit import config as rig_file
from rigkit.command import JsonOption, words, write_json
from rigkit.json_file import json_value
from stagectl.config import StageConfig
from stagectl.planning.example_pocket import EXAMPLE_POCKET
from stagectl.robot.config import CellConfig


def example_config(json: JsonOption = None) -> None:
    """Print a complete rig file for the simulator: every key with its unit, range and default.

    Example: `stagectl example-config > stage.toml`
    """
    words(json).write(rig_file.example(StageConfig))
    write_json(json, StageConfig().model_dump(mode="json"))


def example_cell(json: JsonOption = None) -> None:
    """Print a complete file of the robot cell: every key with its unit, range and default.

    Example: `stagectl example-cell > cell.toml`
    """
    words(json).write(rig_file.example(CellConfig))
    write_json(json, CellConfig().model_dump(mode="json"))


def example_pocket(json: JsonOption = None) -> None:
    """Print a pocket for the planners: the wood of chapter 7.

    Example: `stagectl example-pocket > POCKET.json`
    """
    words(json).write(EXAMPLE_POCKET)
    write_json(json, json_value(EXAMPLE_POCKET, "the example", dict))
