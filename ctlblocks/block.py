"""Ports and blocks: what every step of a signal path declares and does."""

import inspect
import keyword
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Port:
    """One named signal: what flows here, in which unit, how many channels wide.

    Parameters
    ----------
    name : str
        A Python identifier; it is also the argument of `Block.process`.
    unit : str
        SI unit, "1" for a pure number.
    width : int, channels, >= 1
    last : bool
        True for an output that only a clock may read: no block is ever wired behind it.
    """

    name: str
    unit: str = "1"
    width: int = 1
    last: bool = False

    def __post_init__(self) -> None:
        """Refuse a name that cannot be an argument, an empty unit, and a width below one."""
        if not self.name.isidentifier() or keyword.iskeyword(self.name):
            raise ValueError(f"port name {self.name!r} is not a Python identifier, so it cannot be an argument")
        if not self.unit or self.unit != self.unit.strip():
            raise ValueError(f'port {self.name}: unit is {self.unit!r}, must be a unit, or "1" for a pure number')
        if isinstance(self.width, bool) or not isinstance(self.width, int) or self.width < 1:
            raise ValueError(f"port {self.name}: width is {self.width!r}, must be a whole number >= 1")


class Block:
    """One step of a signal path: declares its ports, allocates in `prepare`, computes in `process`.

    A signal is a float64 array of shape (frames, width).  `process` takes the input arrays and then the output arrays,
    in the order of the ports and under their names, leaves the inputs alone and fills every sample of every output in
    place.  Where a block's user chooses the names of its ports, `process` takes them by position: `*signals`.
    """

    inputs: tuple[Port, ...] = ()
    outputs: tuple[Port, ...] = ()

    def prepare(self, rate: float, frames: int) -> None:
        """Allocate and reset for calls of `frames` samples at `rate` samples/s.  May be slow, may raise."""

    process: Callable[..., None]


def refuse_other_arguments(block: Block) -> None:
    """Raise TypeError unless the arguments of `process` are the ports, in order, each of its own name."""
    kind, ports = type(block).__name__, [port.name for port in (*block.inputs, *block.outputs)]
    if not callable(getattr(block, "process", None)):
        raise TypeError(f"{kind} has no process({', '.join(ports)})")
    arguments = inspect.signature(block.process).parameters
    by_position = [argument.kind for argument in arguments.values()] == [inspect.Parameter.VAR_POSITIONAL]
    if len(set(ports)) < len(ports) or not (by_position or list(arguments) == ports):
        raise TypeError(f"{kind}.process takes ({', '.join(arguments)}), must take its ports ({', '.join(ports)})")
