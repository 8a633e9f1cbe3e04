"""A robot cell of the population as Blocks: robot, cut, tracker and force sensor."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from ctlblocks.block import Block, Port
from firmware_sim.clamped_robot import ClampedRobot
from firmware_sim.force_sensor_block import ForceSensor as AnyForceSensor
from firmware_sim.guided_robot import GuidedRobot
from firmware_sim.plants.tooth_cut import ToothCutPlant
from firmware_sim.population.cell_population import CELLS
from firmware_sim.population.cells import DrawnCell, draw_cell
from firmware_sim.run_of import run_of
from firmware_sim.tracker_block import TrackerView


def _drawn(seed: int, family: str) -> DrawnCell:
    return draw_cell(seed, CELLS.family(seed, family))


def _arm(
    seed: int, family: str, compliance: float, payload: float | None, link_friction: float
) -> tuple[DrawnCell, dict[str, Any]]:
    """Return a cell, and the keywords of its arm: softer by `compliance`, with another payload where one is given."""
    cell = _drawn(seed, family)
    changed = {"compliance": compliance * cell.robot.arm["compliance"], "link_friction": link_friction}
    arm = cell.robot.arm | changed
    return cell, arm if payload is None else arm | {"payload": payload}


class Robot(GuidedRobot):
    """The robot of a cell, at rest at `start` after every `prepare`; ports and plant are those of `GuidedRobot`.

    Parameters
    ----------
    seed : int
    family : str
        Of the cell; the seed's own without.  It changes nothing of the robot.
    compliance : float, 1
        Of the joints about their axes, over what is drawn.
    link_friction : float, 1
        As of `RobotOptions`; none is drawn.
    arm : str
        The kind of arm.
    tool, payload : float, m and kg
        To the tool point, and what is there; what is drawn without.
    start : sequence of float, rad, 6 joints; none for the arm's home
    run : int
        As of `GuidedRobot`.
    """

    def __init__(
        self,
        *,
        seed: int = 1,
        family: str = "",
        compliance: float = 1.0,
        link_friction: float = 0.0,
        arm: str = "irb140",
        tool: float = 0.1,
        payload: float | None = None,
        start: Sequence[float] = (),
        run: int = 0,
    ) -> None:
        cell, drawn = _arm(seed, family, compliance, payload, link_friction)
        super().__init__(**drawn, **cell.robot.guided, arm=arm, tool=tool, start=start, run=run)


class ClampedArm(ClampedRobot):
    """The robot of a cell beside a clamp; ports and plant are those of `ClampedRobot`.

    Parameters
    ----------
    seed : int
    family : str
    compliance, link_friction : float, 1
    arm : str
    tool, payload : float, m and kg
        As of `Robot`.
    softness : tuple of float, 1
    clamp, clamp_turn, slip : float, m/N, rad/(N m) and N
        As of `ClampedRobot`.
    """

    def __init__(
        self,
        *,
        seed: int = 1,
        family: str = "",
        compliance: float = 1.0,
        link_friction: float = 0.0,
        arm: str = "irb140",
        tool: float = 0.1,
        payload: float | None = None,
        softness: tuple[float, ...] = ClampedRobot.softness,
        clamp: float = ClampedRobot.clamp,
        clamp_turn: float = ClampedRobot.clamp_turn,
        slip: float = ClampedRobot.slip,
    ) -> None:
        drawn = _arm(seed, family, compliance, payload, link_friction)[1]
        super().__init__(**drawn, arm=arm, tool=tool, softness=softness, clamp=clamp, clamp_turn=clamp_turn, slip=slip)


class Tracker(TrackerView):
    """The tracker of a cell; ports are those of `TrackerView`.

    Parameters
    ----------
    seed : int
    family : str
        Of the cell; the seed's own without.  It changes nothing of the tracker.
    run : int
        As of `TrackerView`.
    """

    def __init__(self, *, seed: int = 1, family: str = "", run: int = 0) -> None:
        super().__init__(**_drawn(seed, family).tracker, run=run)


class ForceSensor(AnyForceSensor):
    """The force sensor of a cell; ports are those of `firmware_sim.force_sensor_block:ForceSensor`.

    Parameters
    ----------
    seed : int
    family : str
        Of the cell; the seed's own without.  It changes nothing of the sensor.
    scale : float, 1
    run_number : int
        As there.
    """

    def __init__(self, *, seed: int = 1, family: str = "", scale: float = 1.0, run_number: int = 0) -> None:
        super().__init__(**_drawn(seed, family).sensor, scale=scale, run_number=run_number)


class Cut(Block):
    """The cut of a cell in a fresh piece after every `prepare`; `ToothCutPlant` says what it models.

    Ports: `tool` (m, 3), where the tip really is in the base, and `give` (m/N, 9), by what a force moves it at once,
    row by row, in; `force` (N, 3) and `moment` (N m, 3) on the robot about the tip, `teeth_force` (N, 3), `kappa`
    (m/(N s)) and `beta` (1), as they are, out.  The piece's top is level, its middle at `origin`.

    Wire `tool` and `give` from a robot, `force` and `moment` to it, `delayed`, and one of the forces to a sensor.

    Parameters
    ----------
    cell : int
        The cell's seed.
    family : str
        Of the cell; that seed's own without.
    seed : int
        Which piece.
    hardness : float, 1
        Of all pieces, over what is drawn.
    step : float, 1
        By what the half of a piece towards +x is harder than the other; the boards that are drawn are not there then.
        1 for what is drawn.
    tool : float, m, diameter
    length, width, thickness : float, m, of the piece
    origin : sequence of float, m, 3, the middle of its top in the base
    """

    inputs = (Port("tool", "m", 3), Port("give", "m/N", 9))
    outputs = (
        Port("force", "N", 3), Port("moment", "N m", 3), Port("teeth_force", "N", 3), Port("kappa", "m/(N s)"),
        Port("beta"),
    )  # fmt: skip

    def __init__(
        self,
        *,
        cell: int = 1,
        family: str = "",
        seed: int = 1,
        hardness: float = 1.0,
        step: float = 1.0,
        tool: float = 6e-3,
        length: float = 50e-3,
        width: float = 50e-3,
        thickness: float = 6e-3,
        origin: Sequence[float] = (0.0, 0.0, 0.0),
    ) -> None:
        x, y, z = origin
        piece = _drawn(cell, family).cut.piece(seed, hardness)
        if step != 1.0:
            piece = replace(piece, hardness=replace(piece.hardness, boards=(1.0, step), heading=0.0))
        self._cut = replace(piece, tool=tool, length=length, width=width, thickness=thickness, origin=(x, y, z))

    def prepare(self, rate: float, frames: int) -> None:
        """Clamp it."""
        self.plant = ToothCutPlant(rate, self._cut)

    process = run_of(ToothCutPlant)
