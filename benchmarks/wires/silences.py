"""Silences on the robot's wire, and whose they were."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

LIMIT = 0.012
"""s: three cycles."""
_CYCLE = 0.004
MACHINE, ROBOT, OURS = "the machine stood still", "the robot's end was late", "our own work"


@dataclass(frozen=True)
class Silence:
    """No answer for longer than the limit.

    Parameters
    ----------
    begin, length : float, s
        From one answer to the next.
    robot : float, s
        Of it, until a report was there to be answered.
    stood : float, s
        The latest that a core woke meanwhile.
    whose : str
    """

    begin: float
    length: float
    robot: float
    stood: float
    whose: str


@dataclass(frozen=True)
class Heard:
    """What a command has sent.

    Parameters
    ----------
    cycles : int
        Answers.
    largest : float, s
        From one answer to the next, while the port was open.
    slow : float, s
        From a report to its answer, which 99.9 % stayed below.
    unanswered : int
        Reports while the port was open that the next report came before the answer to.
    silences : tuple of Silence
    """

    cycles: int
    largest: float
    slow: float
    unanswered: int
    silences: tuple[Silence, ...]


def heard(reports: np.ndarray, answers: np.ndarray, refused: np.ndarray, late: Sequence[np.ndarray]) -> Heard:
    """Find the silences of a command.

    Parameters
    ----------
    reports, answers, refused : arrays, s, ascending
        When reports came, answers went out, and reports found nobody who listened: the port was closed there.
    late : sequence of array, shape (N, 2), s
        Of each core, moments and how late it woke.
    """
    gaps = np.diff(answers)
    is_open = np.searchsorted(refused, answers[:-1]) == np.searchsorted(refused, answers[1:])
    found = [
        _silence(answers[n], answers[n + 1], reports, late) for n in np.flatnonzero(is_open & (gaps > LIMIT))
    ]  # fmt: skip
    before = np.searchsorted(reports, answers) - 1
    slow = (answers - reports[before])[before >= 0]
    passed = np.diff(np.searchsorted(reports, answers))[is_open] - 1
    return Heard(
        len(answers),
        float(gaps[is_open].max(initial=0.0)),
        float(np.quantile(slow, 0.999)) if len(slow) else 0.0,
        int(passed.clip(0).sum()),
        tuple(found),
    )


def _silence(begin: float, end: float, reports: np.ndarray, late: Sequence[np.ndarray]) -> Silence:
    come = reports[np.searchsorted(reports, begin) :]
    robot = min(float(come[0]) if len(come) else end, end) - begin
    within = [each[(begin - LIMIT < each[:, 0]) & (each[:, 0] < end), 1] for each in late]  # what it left waits, too
    stood = max((float(each.max(initial=0.0)) for each in within), default=0.0)
    length = end - begin
    if stood >= 0.5 * (length - _CYCLE):
        whose = MACHINE
    else:
        whose = OURS if length - robot > robot - _CYCLE else ROBOT
    return Silence(float(begin), float(length), robot, stood, whose)
