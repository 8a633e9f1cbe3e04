"""What `stagectl force` is asked to do, as a file of the run's folder: task, pocket, planner, and how many."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path

from rigkit.json_file import read_json
from stagectl.planning.milling import Milled, Planner
from stagectl.planning.pocket import planner, untrained
from stagectl.planning.pocket_file import read_pocket
from stagectl.planning.problem import Pocket
from stagectl.planning.strips import Cut, Standing
from stagectl.planning.zigzag import ZigzagPlanner
from stagectl.robot.segment_config import SegmentTask

PROCESS = "fig-7.5"
"""The task without robot and wood."""
POCKETS = {"slot": (3, 30), "pocket": (30, 30)}
"""Rows and columns of the tasks that need no file: cells of a third of the tool."""
RATES = {
    "E3": 0.0750, "E2u": 0.0484, "E1u": 0.0442, "E2d": 0.0540, "E1d": 0.0358,
    "W3": 0.0846, "W2u": 0.0652, "W1u": 0.0370, "W2d": 0.0592, "W1d": 0.0368,
}  # fmt: skip
"""s a cell of 2 mm, by the training of Experiment 1 [Sörnmo 2015, sec. 7.3]."""


@dataclass(frozen=True)
class Job:
    """What is to be milled.

    Parameters
    ----------
    task : str
        `PROCESS`, one of `POCKETS`, or the name of a pocket's file.
    pocket : Pocket or None
        None for `PROCESS`.
    planner : str
    is_untrained : bool
        Whether the planner has to find out the rates.
    pockets : int
    seed : int
        Seed of the planner's random numbers.
    compares : bool
        Whether the last pocket is milled once more by position control.
    prior : str
        The file of the prior that the planner keeps, or nothing.
    """

    task: str
    pocket: Pocket | None = None
    planner: str = "sequential"
    is_untrained: bool = False
    pockets: int = 1
    seed: int = 0
    compares: bool = False
    prior: str = ""

    def make(self) -> Planner:
        """Make the planner, for all pockets."""
        assert self.pocket is not None
        if self.is_untrained:
            if self.prior:
                raise ValueError(f"an untrained planner has no prior of the rates, must have no prior {self.prior}")
            return untrained(self.planner, self.pocket)
        return planner(self.planner, self.pocket, self.seed, Path(self.prior) if self.prior else None)

    def text(self) -> str:
        """Return it as a file's text."""
        return json.dumps(asdict(self), indent=2)


def read_job(path: Path) -> Job:
    """Read what `text` has made; ValueError where it is something else."""
    given, names = read_json(path, dict), [each.name for each in fields(Job)]
    if {"prior", *given} != set(names):  # version 0.1.0 had none
        raise ValueError(f"{path}: has {', '.join(given) or 'nothing'}, must have {', '.join(names)}")
    pocket = given.pop("pocket")
    return Job(**given, pocket=None if pocket is None else Pocket.from_dict(pocket))


def pocket_of(task: str, segments: SegmentTask) -> Pocket | None:
    """Return the pocket of a task, or None for `PROCESS`; what moves and lifts cost is what they take here.

    Parameters
    ----------
    task : str
    segments : SegmentTask

    Raises
    ------
    ValueError : there is no such task, or the file holds no pocket.
    """
    if task == PROCESS:
        return None
    if task.endswith(".json"):
        return read_pocket(Path(task))
    if task not in POCKETS:
        raise ValueError(f"task is {task!r}, must be {PROCESS}, {', '.join(POCKETS)}, or a file POCKET.json")
    ramp, high = segments.travel / segments.acceleration, segments.lift + segments.depth
    down = high / segments.plunge + segments.plunge / segments.acceleration
    return Pocket(
        *POCKETS[task],
        G=3,
        feeds="EW",
        rate=RATES,
        step=segments.cell / segments.step,
        t_lift=high / segments.travel + down + 2 * ramp,
        v_lift=segments.travel / segments.cell,
    )


class Repeated:
    """A planner that mills a pocket as it was milled before, and on in the default order where that ends.

    Parameters
    ----------
    cuts : sequence of Cut
    pocket : Pocket
    """

    def __init__(self, cuts: Sequence[Cut], pocket: Pocket) -> None:
        self._cuts, self._beyond = iter(cuts), ZigzagPlanner(pocket)

    def choose(self, standing: Standing) -> Cut:
        """Return the next strip."""
        return next(self._cuts, None) or self._beyond.choose(standing)

    def learn(self, milled: Milled) -> None:
        """Learn nothing."""
