"""What milling by force may be begun with under the daemon."""

from typing import Literal, Self

from pydantic import model_validator

from rigkit.config import setting
from stagectl.daemon.cell_options import Run
from stagectl.planning.planner_names import UNTRAINED

PRIOR = r"^([A-Za-z0-9][A-Za-z0-9._-]{0,74}\.json)?$"


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
    prior: str = setting(
        "",
        "",
        "file in the data folder where uncertain keeps how far rates were off, made if it is not there; empty for none",
        pattern=PRIOR,
    )
    model: str = setting("", "", "the robot's velocity model in the data folder; empty for the nominal one")
    accept: tuple[str, ...] = setting((), "", "keys that may differ from what that was measured with")

    @model_validator(mode="after")
    def _can_do_without_rates(self) -> Self:
        if self.untrained and self.planner not in UNTRAINED:
            raise ValueError(f'planner is "{self.planner}", must be {" or ".join(UNTRAINED)}, since untrained is true')
        return self
