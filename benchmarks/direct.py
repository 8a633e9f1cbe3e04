"""A run without audio, files or waiting: the plant answers each drive at once, and every shot is judged."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from firmware_sim.laboratory import plant_block
from vibractl.config import RigConfig
from vibractl.decibels import decibels
from vibractl.guard import violation
from vibractl.learner import Learner
from vibractl.quality import Judge, Marks, holds_from
from vibractl.setup import Setup

LONGEST = 10.0
"""s of drive that a plant is prepared for."""


class Machine:
    """The plant of a rig file, which answers at once and goes on from there; its hydrophones nobody reads."""

    def __init__(self, config: RigConfig) -> None:
        self._block = plant_block(config.simulator.plant, dict(config.simulator.options))
        frames = round(LONGEST * config.audio.rate)
        self._block.prepare(config.audio.rate, frames)
        self._unread = [np.zeros((frames, port.width)) for port in self._block.outputs[1:]]

    def emit(self, drive: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return what was emitted and what the accelerometers heard, float32, as a sound card does."""
        emitted, response = drive.astype(np.float32), np.zeros((len(drive), self._block.outputs[0].width))
        self._block.process(emitted.astype(float), response, *(unread[: len(drive)] for unread in self._unread))
        return emitted, response.astype(np.float32)


@dataclass(frozen=True)
class Heard:
    """One shot: what was emitted and heard, and the learner, which has moved on to the next drive."""

    learner: Learner
    judge: Judge
    drive: np.ndarray
    response: np.ndarray

    @cached_property
    def error(self) -> np.ndarray:
        """Reference minus response, (frames, outputs), m/s^2."""
        return self.judge.error(self.response)

    @cached_property
    def over(self) -> float:
        """Worst judged line, dB over the limit."""
        return float(decibels(self.judge.lines(self.error) / self.judge.limit)[self.judge.judged].max())

    @cached_property
    def marks(self) -> Marks:
        """All figures of the shot; most of the time of judging it."""
        return self.judge.marks(self.response, self.drive)


def shots(made: Setup, count: int, machine: Machine | None = None) -> Iterator[Heard]:
    """Learn on a machine, the rig file's own when None; end before a drive that the guard would not let out."""
    machine = machine or Machine(made.config)
    learner, judge = made.learner(), Judge(made)
    for _ in range(count):
        if violation(np.asarray(learner.drive, dtype=float), made.config.limits, made.shot.rate) is not None:
            return
        drive, response = machine.emit(learner.drive)
        learner.response[: len(response)] = response
        learner.advance()
        yield Heard(learner, judge, drive, response)


def met(over: list[float]) -> float:
    """Return the shot from which the objective holds to the end, infinite if it does not, of `Heard.over`, dB."""
    first = holds_from([level <= 0 for level in over])
    return np.inf if first is None else float(first)
