"""What came of one task."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Self

from rigkit.json_text import json_text
from rigkit.study.task import Words

DONE, FAULT, REFUSED = 0, 1, 2
"""Exit statuses: all commands ended well; a fault of a program, or its verdict; what was asked for cannot be done."""
TOO_LONG, KILLED = 124, 137
"""Exit statuses that a shell gives: the task was killed after its seconds; it was killed as often as it was tried."""


@dataclass(frozen=True)
class Outcome:
    """What came of one task.

    Parameters
    ----------
    key : str
        Of the task.
    status : int
        Exit status of the last command that was run.
    failed : int
        Which command that was, from 1, where its status is not 0; else 0.
    message : str
        What it told last, where its status is not 0: an error, or the verdict that it printed.
    figures : mapping of str to number, bool, text or None
        None where there is none.
    wall, cpu : float, s
        The time that the task took, and the processor time of it and its child processes.
    finished : str
        UTC, ISO 8601.
    notes : tuple of str
        Why a figure is missing although the commands ended well.
    given : tuple of tuple of str
        The commands that were run, with values that earlier ones have written.
    host, processor, software : str
        Where and with what it was run.
    tries : int
        How often it was begun: more than once where its process was killed.
    """

    key: str
    status: int
    failed: int
    message: str
    figures: Mapping[str, Any]
    wall: float
    cpu: float
    finished: str
    notes: tuple[str, ...] = ()
    given: tuple[Words, ...] = ()
    host: str = ""
    processor: str = ""
    software: str = ""
    tries: int = field(default=1)

    @property
    def text(self) -> str:
        """It as one line of JSON."""
        return json_text(asdict(self))

    @classmethod
    def of(cls, told: Mapping[str, Any]) -> Self:
        """Return the outcome of what `text` holds."""
        given = tuple(tuple(words) for words in told["given"])
        return cls(**{**told, "notes": tuple(told["notes"]), "given": given})
