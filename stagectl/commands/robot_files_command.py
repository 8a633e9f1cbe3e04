"""The command `stagectl robot-files`: what a lab puts on its robot's controller, filled in from the cell's file."""

from collections.abc import Iterator
from importlib.resources import files
from ipaddress import AddressValueError, IPv4Address
from math import degrees
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from rigkit import atomic
from rigkit import config as rig_file
from rigkit.command import ConfigOption, JsonOption, SetOption, words, write_json
from rigkit.common_options import one_of
from rigkit.written import made_folder
from stagectl.robot.config import CellConfig
from stagectl.robot.port import arm_of
from stagectl.wire.rsi import REACH, SENDER, SHIFT, TURN

MAKERS = {"abb": "egm", "kuka": "rsi"}
"""Folders of `stagectl/robot_files`, and the wire that their programs speak."""
_MARK = "@"
_OVERALL = 1.1
"""The limits of all corrections over those of one kind: RSI stops beyond them."""
_COMM_TIMEOUT, _FILTER = 1.0, 20.0
"""s, Hz: of guided motion, as the simulated controller has them."""

Maker = Annotated[
    str, typer.Argument(metavar="MAKER", help=f"One of {', '.join(MAKERS)}.", autocompletion=one_of(MAKERS))
]
Out = Annotated[Path, made_folder("DIR", "Folder to write.", "--out")]


def robot_files(
    maker: Maker, out: Out, config: ConfigOption = None, settings: SetOption = None, json: JsonOption = None
) -> None:
    """Write the files for a robot's controller: programs, signals, and interfaces.

    Addresses, ports and limits are those of the cell's file.  docs/robot-files.md says where each belongs.

    Example: `stagectl robot-files kuka --out FOLDER --set robot.wire=rsi --set robot.listen=172.31.2.1`
    """
    if maker not in MAKERS:
        raise ValueError(f"the maker is {maker!r}, must be one of {', '.join(MAKERS)}")
    cell = rig_file.load(config, CellConfig, settings or [])
    if cell.robot.wire != MAKERS[maker]:
        raise ValueError(f"robot.wire is {cell.robot.wire!r}, must be {MAKERS[maker]!r} for a robot of {maker}")
    made = dict(filled(maker, cell))
    out.mkdir(parents=True, exist_ok=True)
    for name, text in made.items():
        atomic.write(out / name, text)
    stream = words(json)
    stream.write("".join(f"{out / name}\n" for name in made) + "docs/robot-files.md says where each belongs\n")
    if cell.robot.listen.startswith("127."):
        stream.write(
            f"robot.listen is {cell.robot.listen}, where only a simulator finds this computer: for a controller set "
            "its address on the robot's network, and write the files anew\n"
        )
    write_json(json, {"files": [str(out / name) for name in made]})


def filled(maker: str, cell: CellConfig) -> Iterator[tuple[str, str]]:
    """Yield the name and text of each file of a maker, addresses, ports and limits of a cell's file filled in.

    Parameters
    ----------
    maker : one of `MAKERS`
    cell : CellConfig

    Raises
    ------
    ValueError : the ports of the program's lines are 0, where the maker needs them; an address that no controller
    can send to.
    """
    robot, limits = cell.robot, cell.limits
    _refuse_unreachable(robot.listen)
    if maker == "abb" and not (robot.port and robot.commands and robot.signals):
        raise ValueError(
            f"robot.port is {robot.port}, robot.commands {robot.commands}, robot.signals {robot.signals}, must be > 0: "
            "the controller has to know them"
        )
    if maker == "kuka" and not robot.port:
        raise ValueError("robot.port is 0, must be > 0: the controller has to know it")
    marks = {
        "listen": robot.listen, "port": robot.port, "commands": robot.commands, "signals": robot.signals,
        "tool": f"{1e3 * robot.tool:g}", "stop": f"{limits.stop:g}", "sender": SENDER, "late": robot.late,
        "comm_timeout": f"{_COMM_TIMEOUT:g}", "filter": f"{_FILTER:g}", "deviation": f"{degrees(REACH):g}",
        "speed": f"{degrees(limits.speed * float(np.max(arm_of(cell).speed))):.4g}", "reach": f"{degrees(REACH):g}",
        "shift": f"{1e3 * SHIFT:g}", "turn": f"{degrees(TURN):g}", "overall_reach": f"{_OVERALL * degrees(REACH):g}",
        "overall_shift": f"{_OVERALL * 1e3 * SHIFT:g}", "overall_turn": f"{_OVERALL * degrees(TURN):g}",
    }  # fmt: skip
    folder = files("stagectl").joinpath("robot_files", maker)
    for each in sorted(folder.iterdir(), key=lambda found: found.name):
        text = each.read_text(encoding="utf-8")
        for name, value in marks.items():
            text = text.replace(f"{_MARK}{name}{_MARK}", str(value))
        yield each.name, text


def _refuse_unreachable(address: str) -> None:
    """Refuse, by ValueError, what is no IPv4 address of one computer: a controller's configuration takes no names."""
    try:
        is_one = not IPv4Address(address).is_unspecified
    except AddressValueError:
        is_one = False
    if not is_one:
        raise ValueError(
            f"robot.listen is {address!r}, must be this computer's IPv4 address on the robot's network, such as "
            "192.168.125.99"
        )
