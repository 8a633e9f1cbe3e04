"""The simulated robot cell as its file describes it: the robot's controller, what it mills, the force sensor."""

import contextlib
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import count
from typing import Any

import numpy as np

from firmware_sim.force_box import BOXES, ForceBox
from firmware_sim.plants.force_sensor import ForceSensorPlant
from firmware_sim.plants.milling import PocketMilling
from firmware_sim.plants.oak import OakMilling
from firmware_sim.plants.robot import RobotPlant
from firmware_sim.robot_controller import Cut, RobotController
from firmware_sim.wire_ends import ENDS
from firmware_sim.wired_oak import WiredOak
from stagectl.robot.config import CellConfig
from stagectl.wire.robot import RATE

_TOOL = 7
_CUT_RATE = 2_000.0
"""samples/s at which robot and block exchange place and force."""
Blocks = Callable[[CellConfig, int], Cut]
"""Makes blocks by their number."""
BLOCKS = 1_000
"""Blocks of a simulated machine."""


def cell_controller(cell: CellConfig, block: Blocks | None = None) -> RobotController:
    """Return the controller of the robot that a cell's file describes; ValueError where it has no such option.

    Parameters
    ----------
    cell : CellConfig
    block : callable(CellConfig, int), optional
        Makes the blocks under its tool by their number, `cell_cut` or `cell_wood`; its program changes them.
    """
    simulator = cell.simulator
    rate = RATE if block is None else _CUT_RATE
    given: dict[str, Any] = {"arm": cell.robot.arm, "tool": cell.robot.tool, "rate": rate, **simulator.options}
    with _named("simulator.options"):
        plant = RobotPlant(**given)
    clamp = np.diag([simulator.clamp] * 3 + [simulator.clamp_turn] * 3)
    end = ENDS[cell.robot.wire](cell.robot.late)
    if block is None:
        return RobotController(plant, clamp=clamp, slip_force=simulator.slip, end=end)
    blocks = map(partial(block, cell), count())
    return RobotController(plant, None, clamp, simulator.slip, next(blocks), lambda: next(blocks), end=end)


def cell_cut(cell: CellConfig, number: int = 0) -> PocketMilling:
    """Return a block of a cell's file, its top where the arm has its tool at `pocket.home`, as it sags.

    Parameters
    ----------
    cell : CellConfig
    number : int
        Each is another block.

    Raises
    ------
    ValueError : an option that is wrong.
    """
    pocket = cell.pocket
    length, width, thickness = pocket.workpiece
    given: dict[str, Any] = {"tool": pocket.tool, "length": length, "width": width, "thickness": thickness}
    given |= {"origin": _tip(cell, pocket.home)} | cell.plants.pocket_options
    with _named("plants.pocket_options"):
        return PocketMilling(_CUT_RATE, **given | {"seed": BLOCKS * given.get("seed", 1) + number})


def cell_wood(cell: CellConfig, number: int = 0) -> WiredOak:
    """Return a piece of oak of a cell's file, its top `segments.lift` under the tool at `segments.home`, as it sags.

    Parameters
    ----------
    cell : CellConfig
    number : int
        Each is another piece.

    Raises
    ------
    ValueError : an option that is wrong.
    """
    task, given = cell.segments, dict(cell.feed_plants.cut_options)
    x, y, z = _tip(cell, task.home)
    given = {"origin": (x, y, z - task.lift), "depth": task.depth, **given}
    with _named("feed_plants.cut_options"):
        return WiredOak(OakMilling(_CUT_RATE, **given | {"seed": given.get("seed", 1) + number}))


def _tip(cell: CellConfig, home: Sequence[float]) -> tuple[float, float, float]:
    """Return where the tool's tip is with the motors at home, m, in the base."""
    plant = cell_controller(cell).plant
    plant.place(np.array(home))
    x, y, z = plant.frames[_TOOL][:, 3].tolist()
    return x, y, z


@contextlib.contextmanager
def _named(table: str) -> Iterator[None]:
    """Tell of a wrong option under the table that it stands in, by ValueError."""
    try:
        yield
    except TypeError as fault:
        raise ValueError(f"{table}: {fault}") from None
    except ValueError as fault:
        raise ValueError(str(fault).replace("simulator.options", table)) from None


def cell_force_box(cell: CellConfig) -> ForceBox:
    """Return the force sensor's box that a cell's file describes; ValueError where it has no such option."""
    sensor = cell.force_sensor
    if sensor.wire not in BOXES:
        raise ValueError(f"force_sensor.wire is {sensor.wire!r}, must be {' or '.join(BOXES)} in the simulator")
    with _named("plants.force_sensor_options"):
        plant = ForceSensorPlant(sensor.rate, **{"sample_rate": sensor.rate, **cell.plants.force_sensor_options})
    return BOXES[sensor.wire](plant, sensor.host, sensor.port, sensor.counts)
