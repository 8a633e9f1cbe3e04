"""The robot guided from one piece of work to the next: a person asked, the block changed, the tool brought there."""

import time
from collections.abc import Callable

import numpy as np

from stagectl.link.tell import Tell
from stagectl.robot.config import CellConfig
from stagectl.robot.live.person import Person, refuse_without_terminal
from stagectl.robot.live.way import Room, go
from stagectl.robot.live.wires import change_block


class Guide:
    """Brings the tool to where a piece of work begins, and away when it came to its end.

    Parameters
    ----------
    cell : CellConfig
        Its limits hold on the way.
    person : Person
    clock : callable() -> float, s, monotonic

    Raises
    ------
    ValueError : guided motion could not be begun anew each time.
    """

    def __init__(self, cell: CellConfig, person: Person, clock: Callable[[], float] = time.monotonic) -> None:
        refuse_unguided(cell)
        self._cell, self._person, self.clock = cell, person, clock
        self._room: Room | None = None

    def bring(
        self, what: str, is_there: bool, room: Room, goal: np.ndarray, tell: Tell, stopped: Callable[[], bool]
    ) -> None:
        """Have a person confirm, the block changed where the robot can, and go up, across at `robot.height`, and down.

        Parameters
        ----------
        what : str
            That comes, and what is to be in place.
        is_there : bool
            Whether there is to be a block.
        room : Room
        goal : array, shape (6,), rad
        tell : callable(event, fields)
            Told of faults.
        stopped : callable() -> bool

        Raises
        ------
        ValueError : a way that is refused.
        LinkError : a wire that cannot be had, or a fault on the way; the robot is held.
        Stopped : it was asked to stop; the robot is held.
        """
        self.leave(tell, stopped)
        self._person.confirm(what, stopped)
        if self._cell.robot.changer:
            change_block(self._cell, is_there, self.clock)
        go(self._cell, lambda here: room.way(here, goal), tell, stopped, self.clock)

    def finished(self, room: Room) -> None:
        """Remember that work came to its end here: the tool may go up."""
        self._room = room

    def leave(self, tell: Tell, stopped: Callable[[], bool]) -> None:
        """Go up from where the last work came to its end; one that a fault has ended stays where that has left it."""
        room, self._room = self._room, None
        if room is not None:
            go(self._cell, room.rise, tell, stopped, self.clock)


def refuse_needless_yes(is_sure: bool, is_live: bool) -> None:
    """Refuse `--yes` where nothing is asked, by ValueError."""
    if is_sure and not is_live:
        raise ValueError("--yes goes with --live, which is not given: what is simulated asks nothing")


def refuse_unattended(cell: CellConfig, is_sure: bool) -> None:
    """Refuse a cell whose robot nobody can begin to guide, or, unless `is_sure`, nobody to ask; by ValueError."""
    refuse_unguided(cell)
    if not is_sure:
        refuse_without_terminal()


def refuse_another_arm(cell: CellConfig, key: str, arm: str) -> None:
    """Refuse, by ValueError, a task whose arm, that of `key` in the cell's file, is not the live robot's."""
    if arm not in ("", cell.robot.arm):
        raise ValueError(
            f"{key} is {arm!r} and robot.arm {cell.robot.arm!r}, must be the same in a live run: the robot moves by "
            "the geometry and limits of its arm"
        )


def refuse_unguided(cell: CellConfig) -> None:
    """Refuse a cell whose robot nobody can begin to guide, by ValueError."""
    if not cell.robot.has_program:
        raise ValueError(
            "robot.commands is 0, must be the port of the robot's program: guided motion begins anew each time"
        )
