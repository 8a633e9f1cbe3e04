"""Blocks wired port to port, in an order found once, stepped by whoever owns the clock."""

import math
from collections import deque
from collections.abc import Callable
from graphlib import CycleError, TopologicalSorter

import numpy as np

from ctlblocks.block import Block, Port

Call = tuple[Callable[..., None], tuple[np.ndarray, ...]]


class Graph:
    """Blocks and wires.  It has no thread and no time: a clock calls `tick`.

    Parameters
    ----------
    rate : float, samples/s, > 0
    frames : int, samples a tick, >= 1
    """

    LONGEST_CYCLE = 10_000
    """Ticks after which the pattern of slower blocks must repeat (their `every` numbers' common multiple)."""

    def __init__(self, rate: float, frames: int = 1) -> None:
        if not (math.isfinite(rate) and rate > 0):
            raise ValueError(f"rate is {rate!r} samples/s, must be finite and > 0")
        if frames < 1:
            raise ValueError(f"frames is {frames!r}, must be >= 1")
        self.rate, self.frames, self.ticks = rate, frames, 0
        self.changes: deque[Callable[[], None]] = deque()
        self._blocks: dict[str, tuple[Block, int]] = {}
        self._signals: dict[str, np.ndarray] = {}
        self._wires: dict[str, tuple[str, bool]] = {}
        self._plans: tuple[tuple[Call, ...], ...] = ()

    def add(self, name: str, block: Block, every: int = 1) -> None:
        """Own `block` as `name`; run it on each `every`-th tick and hold its outputs in between."""
        if not name.isidentifier():
            raise ValueError(f"block name {name!r} is not a Python identifier")
        if name in self._blocks:
            raise ValueError(f"block {name!r} is in the graph already")
        if every < 1:
            raise ValueError(f"{name}: every is {every}, must be >= 1")
        if every > 1 and self.frames > 1:
            raise ValueError(f"{name}: every is {every}, but a slower block needs a graph of one frame a tick")
        self._blocks[name] = block, every
        self._plans = ()
        for port in block.outputs:
            self._signals[f"{name}.{port.name}"] = np.zeros((self.frames, port.width))

    def connect(self, source: str, target: str, *, delayed: bool = False) -> None:
        """Wire output "block.port" to input "block.port"; a `delayed` wire reads the tick before.

        Raises
        ------
        KeyError : no such block or port.
        ValueError : the input is wired already, or the output is for the clock alone.
        TypeError : unit or width differ.
        """
        out, inp = self._port(source, "outputs"), self._port(target, "inputs")
        if out.last:
            raise ValueError(f"{source} is the last output before the device: nothing is wired behind it")
        if target in self._wires:
            raise ValueError(f"{target} is wired already, to {self._wires[target][0]}")
        if (out.unit, out.width) != (inp.unit, inp.width):
            raise TypeError(f"{source} is {out.width} x {out.unit}, {target} is {inp.width} x {inp.unit}")
        self._wires[target] = source, delayed
        self._plans = ()

    def prepare(self) -> None:
        """Order the blocks, reset them, freeze the plan.  All allocation ends here.

        Raises
        ------
        ValueError : an input is not wired, or a loop has no delayed wire (it is named).
        """
        calls = [(every, self._call(name)) for name, every in self._in_order()]
        for name, (block, every) in self._blocks.items():
            for port in block.outputs:
                self._signals[f"{name}.{port.name}"].fill(0.0)
            block.prepare(self.rate / every, self.frames)
        cycle = math.lcm(*(every for every, _ in calls))
        if cycle > self.LONGEST_CYCLE:
            raise ValueError(f"the blocks' rates repeat after {cycle} ticks, must be <= {self.LONGEST_CYCLE}")
        self._plans = tuple(tuple(call for every, call in calls if n % every == 0) for n in range(cycle))
        self.ticks = 0

    def tick(self) -> None:
        """Run one tick.  No array is made, no lock, I/O or log call happens below this line."""
        while self.changes:
            self.changes.popleft()()
        for process, signals in self._plans[self.ticks % len(self._plans)]:
            process(*signals)
        self.ticks += 1

    def signal(self, output: str) -> np.ndarray:
        """Return the live frame of output "block.port", shape (frames, width)."""
        self._port(output, "outputs")
        return self._signals[output]

    def _port(self, path: str, side: str) -> Port:
        name, _, port_name = path.partition(".")
        if name not in self._blocks:
            raise KeyError(f"no block {name!r} for {path!r}; there are {sorted(self._blocks)}")
        ports: tuple[Port, ...] = getattr(self._blocks[name][0], side)
        for port in ports:
            if port.name == port_name:
                return port
        raise KeyError(f"{name} has no port {port_name!r} among its {side}; there are {[p.name for p in ports]}")

    def _in_order(self) -> list[tuple[str, int]]:
        order = TopologicalSorter[str]({name: () for name in self._blocks})
        for target, (source, delayed) in self._wires.items():
            before, after = source.split(".")[0], target.split(".")[0]
            if delayed and before == after:
                continue  # a block may read its own last output
            order.add(*((before, after) if delayed else (after, before)))  # a delayed reader runs first
        try:
            return [(name, self._blocks[name][1]) for name in order.static_order()]
        except CycleError as fault:
            raise ValueError(
                f"these blocks wait for each other: {', '.join(fault.args[1])}; make one wire between them delayed"
            ) from None

    def _call(self, name: str) -> Call:
        block, _ = self._blocks[name]
        unwired = [p.name for p in block.inputs if f"{name}.{p.name}" not in self._wires]
        if unwired:
            raise ValueError(f"{name}: input {', '.join(unwired)} is not wired")
        ins = [self._signals[self._wires[f"{name}.{p.name}"][0]] for p in block.inputs]
        outs = [self._signals[f"{name}.{p.name}"] for p in block.outputs]
        return block.process, (*ins, *outs)
