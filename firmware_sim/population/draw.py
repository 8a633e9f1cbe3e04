"""What a draw of a machine says of itself, and a kind of machine as families drawn by seed."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from firmware_sim.population.streams import Streams
from rigkit import atomic
from rigkit.config import dump


@dataclass(frozen=True)
class Quantity:
    """One thing that was drawn, or follows from what was.

    Parameters
    ----------
    name : str
    value : number, str, or tuple of these
    unit : str
        "1" for a pure number, empty for a count or a word.
    """

    name: str
    value: Any
    unit: str = ""


@dataclass(frozen=True)
class Draw:
    """A machine as its seed has it.

    Parameters
    ----------
    kind, family : str
    seed : int
    quantities : tuple of Quantity
    keys : mapping of str to value
        The keys "table.key" of a rig file that fit this machine, laid over the program's defaults; the plant among
        them.
    """

    kind: str
    family: str
    seed: int
    quantities: tuple[Quantity, ...]
    keys: Mapping[str, Any]

    @property
    def command(self) -> str:
        """The command that draws it again."""
        return f"firmware-sim draw {self.kind} --seed {self.seed} --family {self.family}"


def write_rig_file(draw: Draw, config: BaseModel, out: Path) -> list[Path]:
    """Write a complete rig file of the machine and return what was written."""
    atomic.write(out, f"# {draw.command}\n\n{dump(config)}")
    return [out]


@dataclass(frozen=True)
class Population:
    """A kind of machine.

    Parameters
    ----------
    kind : str
    families : tuple of str
        The seed chooses one of these where none is named.
    make : callable(family, seed) -> Draw
    named : tuple of str
        Families that are drawn only by name: those that want files.
    write : callable(Draw, settings, Path) -> list of Path
        Writes what `--out` asks for; a rig file where nothing else is said.
    """

    kind: str
    families: tuple[str, ...]
    make: Callable[[str, int], Draw]
    named: tuple[str, ...] = ()
    write: Callable[[Draw, Any, Path], list[Path]] = field(default=write_rig_file)

    def family(self, seed: int, family: str = "") -> str:
        """Return a machine's family: the one that is named, or the seed's own.

        Raises
        ------
        ValueError : there is no such family, or the seed is none.
        """
        known = (*self.families, *self.named)
        if family:
            if family not in known:
                raise ValueError(f"family of {self.kind} is {family!r}, must be {', '.join(known)}")
            return family
        return str(self.families[Streams(seed, self.kind)("family").integers(len(self.families))])

    def draw(self, seed: int, family: str = "") -> Draw:
        """Draw a machine.

        Raises
        ------
        ValueError : there is no such family, or the seed is none.
        """
        return self.make(self.family(seed, family), seed)
