"""Clamping poses from the command line and from a file, and a cell's file for each of them."""

import math
from collections.abc import Sequence
from pathlib import Path

from rigkit.text_file import read_text
from stagectl.robot.config import CellConfig


def in_poses(cell: CellConfig, given: Sequence[str], file: Path | None) -> list[CellConfig]:
    """Return the cell with each clamping pose in turn: those given, those of the file, or else its own.

    Parameters
    ----------
    cell : CellConfig
    given : sequence of str
        Each a pose in deg, "20,30,-30,40,50,20".
    file : Path or None
        A pose a line, as above; lines that begin with # are skipped.

    Raises
    ------
    ValueError : a pose that is none, by its text; the same pose twice.
    """
    texts, where = [*given], "--pose"
    if file is not None:
        lines = (line.strip() for line in read_text(file).splitlines())
        texts += [line for line in lines if line and not line.startswith("#")]
        where = f"{'--pose or ' if given else ''}{file}"
        if not texts:
            raise ValueError(f"--poses {file}: has no line with a pose")
    poses = [_pose(text, len(cell.clamping.pose), where) for text in texts] or [cell.clamping.pose]
    twice = [pose for place, pose in enumerate(poses) if pose in poses[:place]]
    if twice:
        raise ValueError(f"the pose {twice[0]} deg is given twice, must be another each time")
    return [cell.model_copy(update={"clamping": cell.clamping.model_copy(update={"pose": pose})}) for pose in poses]


def _pose(text: str, joints: int, where: str) -> tuple[float, ...]:
    try:
        pose = tuple(float(part) for part in text.split(","))
    except ValueError:
        pose = ()
    if len(pose) != joints or not all(map(math.isfinite, pose)):
        raise ValueError(f"{where}: a pose is {text!r}, must be {joints} finite numbers with commas between them, deg")
    return pose
