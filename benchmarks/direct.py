"""A run without audio, files or waiting: the plant answers each drive at once, and every shot is judged."""

from collections.abc import Iterator

import numpy as np

from firmware_sim.laboratory import plant_block
from vibractl.learner import Learner
from vibractl.quality import Judge, Marks, holds_from
from vibractl.setup import Setup


def shots(made: Setup, count: int, plant: object | None = None) -> Iterator[tuple[Learner, Marks]]:
    """Learn on a plant (the rig file's own when None) and yield the learner and the marks of every shot."""
    config = made.config
    block = plant or plant_block(config.simulator.plant, dict(config.simulator.options))
    block.prepare(config.audio.rate, made.shot.total)  # type: ignore[attr-defined]
    learner, judge = made.learner(), Judge(made)
    response = np.zeros((made.shot.total, len(config.audio.response_channels)))
    for _ in range(count):
        drive = learner.drive.copy()
        block.process(drive, response)  # type: ignore[attr-defined]
        recorded = response.astype(np.float32)
        marks = judge.marks(recorded, drive.astype(np.float32))
        learner.response[: len(recorded)] = recorded
        learner.advance()
        yield learner, marks


def met(marks: list[Marks]) -> int | None:
    """Return the shot from which the objective holds to the end, or None."""
    return holds_from([mark.met for mark in marks])
