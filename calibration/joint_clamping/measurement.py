"""The clamping procedure run on a robot block: what each joint showed while it was moved to and fro, saved raw."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from calibration.joint_clamping.config import JointsConfig, procedure
from ctlblocks import Block, Graph, recording
from ctlblocks.recording import Recording
from rigkit import atomic
from rigkit.config import resolve
from rigkit.stop import Stopped
from stagectl.robot.clamp_search import ClampSearch

CHUNK = 50
"""Samples between two looks at whether the run is to stop."""
SEEN = {"angle": "rad", "torque": "N m", "link": "rad", "pose": "1"}
"""What is kept of the robot's outputs, and their units; `link` and `pose` only where it has them."""

Tell = Callable[[str], None]


class ClampAborted(ValueError):
    """The procedure was aborted; the text says why, and where the arm stands."""


@dataclass
class Samples:
    """What one joint showed.

    Parameters
    ----------
    signals : dict of lists of arrays, shape (width,), SI
        By the name of the robot's output, a sample an entry.
    """

    signals: dict[str, list[np.ndarray]] = field(default_factory=dict)


def measure(
    config: JointsConfig, joints: Sequence[int], folder: Path, tell: Tell, stopped: Callable[[], bool]
) -> dict[int, Recording]:
    """Run the procedure for the joints that have no recording yet, and return the recordings of all.

    Parameters
    ----------
    config : JointsConfig
    joints : sequence of int
        From 0.
    folder : Path
        Of raw recordings, `joint-1.wav` ...; made if it is not there.
    tell : callable(str)
        Told each step in words as it begins.
    stopped : callable() -> bool
        Whether the run is to stop: the arm then holds.

    Raises
    ------
    ValueError : a folder that belongs to another configuration.
    ClampAborted : something went wrong; what was recorded is kept.
    Stopped : it was asked to.
    """
    _belongs(folder, config)
    files = {joint: folder / f"joint-{joint + 1}.wav" for joint in joints}
    missing = tuple(joint for joint in joints if not files[joint].exists())
    if missing:
        _run(config, missing, files, tell, stopped)
    return {joint: recording.read(file) for joint, file in files.items()}


def _belongs(folder: Path, config: JointsConfig) -> None:
    """Note in the folder what it was recorded with, or compare."""
    folder.mkdir(parents=True, exist_ok=True)
    note, text = folder / "config.json", config.model_dump_json(indent=1)
    if note.exists() and note.read_text(encoding="utf-8") != text:
        raise ValueError(f"{folder} was recorded with another configuration; choose another name for the model")
    atomic.write(note, text)


def _run(
    config: JointsConfig, joints: tuple[int, ...], files: dict[int, Path], tell: Tell, stopped: Callable[[], bool]
) -> None:
    robot, search = _robot(config), ClampSearch(procedure(config, joints))
    graph = _graph(config, robot, search)
    seen = {name: graph.signal(f"robot.{name}") for name in SEEN if name in {port.name for port in robot.outputs}}
    moved = graph.signal("search.joint")
    kept, before, step = Samples(), -1, -1
    while not search.done:
        for _ in range(CHUNK):
            graph.tick()
            now = int(moved[0, 0]) - 1
            if now >= 0:
                for name, signal in seen.items():
                    kept.signals.setdefault(name, []).append(signal[0].copy())
            elif before >= 0 and search.cause is None:
                recording.write(files[before], _recorded(kept, config.robot.rate))
                kept = Samples()
            before = now
        if search.cause is not None:
            raise ClampAborted(f"{search.cause}; the arm holds in step {search.step + 1}, soft servo and clamp stay")
        if search.step != step and not search.done:
            for each in search.steps[step + 1 : search.step + 1]:
                tell(f"{graph.ticks / config.robot.rate:7.1f} s  {each.words}")
            step = search.step
        if stopped():
            search.abort("stopped by a person")
            raise Stopped(f"stopped in step {search.step + 1}: the arm holds; joints that were done are kept")


def _robot(config: JointsConfig) -> Block:
    robot: Block = resolve(config.robot.block)(**config.robot.options)
    return robot


def _graph(config: JointsConfig, robot: Block, search: ClampSearch) -> Graph:
    graph = Graph(config.robot.rate)
    graph.add("robot", robot)
    graph.add("search", search)
    for port in search.inputs:
        graph.connect(f"robot.{port.name}", f"search.{port.name}")
    for name in ("reference", "soft", "clamp"):
        graph.connect(f"search.{name}", f"robot.{name}", delayed=True)
    graph.prepare()
    return graph


def _recorded(kept: Samples, rate: float) -> Recording:
    names: list[str] = []
    units: list[str] = []
    for name, rows in kept.signals.items():
        width = len(rows[0])
        names += [f"{name}_{place + 1}" for place in range(width)]
        units += [SEEN[name]] * width
    data = np.concatenate([np.array(rows) for rows in kept.signals.values()], axis=1)
    return Recording(tuple(names), tuple(units), rate, data.astype(np.float32))
