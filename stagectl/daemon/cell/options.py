"""What the procedures of the cell may be begun with."""

from typing import Literal, Self

from pydantic import model_validator

from rigkit.config import Section, setting
from stagectl.daemon.options import Renewed
from stagectl.experiments.midranging.scenario import SCENARIOS
from stagectl.experiments.step.response import Wanted
from stagectl.planning.pocket import UNTRAINED

NAME = r"^[A-Za-z0-9][A-Za-z0-9._-]{0,79}$"
MODEL = r"^[A-Za-z0-9][A-Za-z0-9._-]{0,76}\.h5$"
NAME_OR_NONE = r"^([A-Za-z0-9][A-Za-z0-9._-]{0,79})?$"


class Paced(Section):
    """Simulated, in real time or not."""

    paced: bool = setting(False, "", "in real time; else the simulation goes as fast as it can")

    def refuse_live(self, key: str, is_live: bool) -> None:
        """Refuse to be paced where `key` has the procedure live, by ValueError: the robot's reports are the clock."""
        if self.paced and is_live:
            raise ValueError(f"paced is true, must be false where {key} is true: the robot is the clock")


class Run(Paced):
    """A run of any kind."""

    run: str = setting("", "", "name of its folder; empty for date and time", pattern=NAME_OR_NONE)


class IlcOptions(Run):
    """Trials in the air, then in material."""

    resume: bool = setting(False, "", "go on with the run of that name: its settings, task and models")
    method: str = setting("1", "", "1, 2, 3, several as 1,2, or all", pattern=r"^(all|[123](,[123]){0,2})$")
    iterations: int = setting(4, "trials", "in material after the first one, of each method", ge=1, le=50)
    task: Literal["pocket28", "pocket28-deep", "pocket"] = setting("pocket28", "", "pocket is that of [pocket]")
    model: str = setting("milling.h5", "", "model file in the data folder", pattern=NAME)
    accept: tuple[str, ...] = setting((), "", "keys that may differ from what the models or the run were made with")

    @model_validator(mode="after")
    def _names_what_it_goes_on_with(self) -> Self:
        if self.resume and not self.run:
            raise ValueError('run is "", must be the name of the run to go on with, since resume is true')
        return self


class ForceOptions(Run):
    """Pockets milled with the force controlled by the feed."""

    task: str = setting("slot", "", "slot, pocket, or a pocket's JSON file in the data folder", min_length=1)
    force: float = setting(0.0, "N", "wanted; 0 for force.force", ge=0, le=1e3)
    planner: Literal["exact", "sequential", "qlearning", "features", "uncertain"] = setting(
        "sequential", "", "who chooses the segments"
    )
    untrained: bool = setting(False, "", "the planner does not know the rates: it finds them out")
    pockets: int = setting(1, "pockets", "how many, each in a piece of wood of its own", ge=1, le=20)
    compare: bool = setting(False, "", "mill the last pocket once more by position control at the safe feed")
    seed: int = setting(0, "", "of what the planner draws", ge=0)
    model: str = setting("", "", "the robot's velocity model in the data folder; empty for the nominal one")
    accept: tuple[str, ...] = setting((), "", "keys that may differ from what that was measured with")

    @model_validator(mode="after")
    def _can_do_without_rates(self) -> Self:
        if self.untrained and self.planner not in UNTRAINED:
            raise ValueError(f'planner is "{self.planner}", must be {" or ".join(UNTRAINED)}, since untrained is true')
        return self


class CellOptions(Run):
    """The toroid in steel."""

    setup: Literal["A", "B", "C", "C-fixed", "all"] = setting("C", "", "robot, tracker, stage: which of them correct")
    stage: str = setting("", "", "the stage's own rig file in the data folder; empty for the usual stage")
    live: bool = setting(False, "", "on robot, tracker and stage: the workpiece near the path, nobody in the cell")
    accept: tuple[str, ...] = setting((), "", "keys that may differ from what the stage's models were measured with")


class MidrangeOptions(Run):
    """The macro and the micro manipulator share one position."""

    scenario: str = setting("thesis-2", "", f"{', '.join(SCENARIOS)}, or a CSV or WAV file in the data folder")
    controller: Literal["aimc", "mvpc", "mvpc-aw", "vpc"] = setting("aimc", "", "who controls")


class StepOptions(Run, Wanted):
    """A step or a multisine on robot, stage, or one after the other."""


class MillingOptions(Paced, Renewed):
    """Models of the robot, and of what milling does to it."""

    model: str = setting("milling.h5", "", "model file to write in the data folder", pattern=MODEL)
    task: Literal["pocket28", "pocket28-deep", "pocket"] = setting("pocket28", "", "pocket is that of [pocket]")


class JointsOptions(Paced, Renewed):
    """Backlash, stiffness and friction of joints whose tool is clamped."""

    model: str = setting("joints.h5", "", "model file to write in the data folder", pattern=MODEL)
    joints: str = setting(
        "1-6", "", "which: numbers and ranges, such as 1-3,6", pattern=r"^[1-9](-[1-9])?(,[1-9](-[1-9])?){0,5}$"
    )
    compensate: Literal["best", "none", "clamp", "tool", "link"] = setting(
        "best", "", "by what the arm's side is known that counts"
    )
