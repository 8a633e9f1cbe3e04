"""Which methods are learned by, and the models that they need."""

from collections.abc import Callable, Collection
from pathlib import Path

from stagectl.experiments.trials.joint_speeds import refuse_unknown_speeds
from stagectl.experiments.trials.laws import Learner
from stagectl.experiments.trials.tool_path import RATE
from stagectl.experiments.trials.trial import Trial
from stagectl.models.joint_backlash import lost_motion
from stagectl.models.model_origin import refuse_other_wiring
from stagectl.robot.config import CellConfig
from stagectl.robot.milling.milling_models import MillingModels, read_milling
from stagectl.robot.milling.torque_file import read_force_model, read_gravity
from stagectl.robot.milling.trial_error import METHODS

ALL = "all"


def wanted_methods(text: str) -> tuple[int, ...]:
    """Read "1", "1,3" or "all"; ValueError for anything else."""
    known = {str(each): each for each in METHODS}
    found = list(known.values()) if text == ALL else [known.get(part.strip(), 0) for part in text.split(",")]
    if not all(found):
        raise ValueError(f"method is {text!r}, must be {', '.join(known)}, several of them, or {ALL}")
    return tuple(dict.fromkeys(found))


def learner_of(
    cell: CellConfig,
    file: Path,
    first: Trial,
    methods: tuple[int, ...],
    accept: Collection[str] = (),
    say: Callable[[str], object] = lambda _: None,
    joints: Path | None = None,
) -> Learner:
    """Read the models that methods need, and the lost motion that a path carries.

    Parameters
    ----------
    cell : CellConfig
    file : Path
        Its gravity tells to which side joints are held.
    first : Trial
    methods : tuple of int
    accept : collection of str
        Keys in which the cell that they were measured on may differ.
    say : callable(str)
        Told what differs without harm, what lost motion is left out, and why; and what the learner notes.
    joints : Path, optional
        File of joint models; without one the path carries nothing.

    Raises
    ------
    ValueError : no such file, or one without what they need: for method 3, friction at the speeds of the path.
    DisagreementError : measured on a cell that was wired otherwise.
    """
    models: MillingModels = read_milling(file)
    for text in refuse_other_wiring(cell, file, models.provenance, accept, "cell"):
        say(text)
    learner = Learner(cell, models, note=say)
    if 3 in methods:
        known = read_force_model(file, first.arm, cell.force_estimate)
        refuse_unknown_speeds(first, known.friction.speed[-1], known.friction.smoothing, str(file))
        learner.forces = lambda angle, torque: known.estimate(angle, torque, RATE).force
    if joints is not None:
        held = read_gravity(file, first.arm).torque(first.arm, first.joints)
        learner.lost = lost_motion(joints, first.cell, held, accept, say)
    return learner
