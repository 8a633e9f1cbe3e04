"""One task of a study: command lines that are run in order, in a folder of their own."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Self

from rigkit.json_text import json_text

Words = tuple[str, ...]


@dataclass(frozen=True)
class Task:
    """One task: commands that are run in order, in a folder of their own.

    Parameters
    ----------
    key : str
        Hash of the commands and of all that they are given.
    machine : str
    seed : int
    case : mapping
        The settings by key.
    commands : tuple of tuple of str
    figures : mapping of str to mapping
        What is read afterwards: file, path and reduce of each figure.
    seconds : float, s
        It is killed after that.
    keep : str
        Whose folder stays: "nothing", "failed" or "all".
    """

    key: str
    machine: str
    seed: int
    case: Mapping[str, Any]
    commands: tuple[Words, ...]
    figures: Mapping[str, Mapping[str, str]]
    seconds: float
    keep: str

    @property
    def folder(self) -> str:
        """The name of its folder."""
        return f"{self.seed}-{self.machine}-{self.key}"

    @property
    def text(self) -> str:
        """It as one line of JSON."""
        return json_text(asdict(self))

    @classmethod
    def of(cls, told: Mapping[str, Any]) -> Self:
        """Return the task of what `text` holds."""
        return cls(**{**told, "commands": tuple(tuple(words) for words in told["commands"])})
