"""Blocks wired port to port, in an order found once, stepped by whoever owns the clock."""

import math
from collections import deque
from collections.abc import Callable
from graphlib import CycleError, TopologicalSorter

import numpy as np

from ctlblocks.block import Block, Port, refuse_other_arguments

Call = tuple[Callable[..., object], tuple[np.ndarray, ...]]


class Graph:
    """Blocks and wires.  It has no thread and no time: a clock calls `tick`.

    `changes` is a queue of callables that any thread may fill: those waiting when a tick begins run before its blocks.

    Parameters
    ----------
    rate : float, samples/s, > 0
    frames : int, samples a tick, >= 1
    """

    LONGEST_CYCLE = 10_000
    """Ticks after which the pattern of slower blocks must repeat (their `every` numbers' common multiple)."""

    def __init__(self, rate: float, frames: int = 1) -> None:
        if not (0 < rate < math.inf and frames >= 1):
            raise ValueError(f"rate is {rate} samples/s, must be finite and > 0; frames is {frames}, must be >= 1")
        self.rate, self.frames, self.ticks = float(rate), frames, 0
        self.changes: deque[Callable[[], object]] = deque()
        self._blocks: dict[str, tuple[Block, int]] = {}
        self._signals: dict[str, np.ndarray] = {}
        self._wires: dict[str, tuple[str, bool]] = {}
        self._plans = _UNPREPARED

    def add(self, name: str, block: Block, every: int = 1) -> None:
        """Own `block` as `name`; run it on each `every`-th tick, from the first, and hold its outputs in between.

        A name, a block or an `every` that cannot be is a ValueError, ports unlike the block's arguments a TypeError.
        """
        if not name.isidentifier():
            raise ValueError(f"block name {name!r} is not a Python identifier")
        if name in self._blocks:
            raise ValueError(f"block {name!r} is in the graph already")
        if others := [other for other, (known, _) in self._blocks.items() if known is block]:
            raise ValueError(f"{name} is the same block as {others[0]}: it has one state and can be added once")
        if not every >= 1 or (every > 1 and self.frames > 1):
            raise ValueError(f"{name}: every is {every}, must be >= 1, and 1 in a graph of more than one frame a tick")
        refuse_other_arguments(block)
        self._blocks[name] = block, every
        self._signals |= {f"{name}.{port.name}": np.zeros((self.frames, port.width)) for port in block.outputs}
        self._plans = _UNPREPARED

    def connect(self, source: str, target: str, *, delayed: bool = False) -> None:
        """Wire output "block.port" to input "block.port"; a `delayed` wire reads the tick before, zero at first.

        A KeyError says that there is no such block or port, a ValueError that the input is wired already or the output
        is for the clock alone, a TypeError that unit or width differ.
        """
        out, inp = self._port(source, "outputs"), self._port(target, "inputs")
        if out.last:
            raise ValueError(f"{source} is the last output before the device: {target} cannot be wired behind it")
        if target in self._wires:
            raise ValueError(f"{target} is wired already, to {self._wires[target][0]}, not to {source}")
        if (out.unit, out.width) != (inp.unit, inp.width):
            raise TypeError(f"{source} is {out.width} x {out.unit}, {target} must be too: is {inp.width} x {inp.unit}")
        self._wires[target] = source, delayed
        self._plans = _UNPREPARED

    def prepare(self) -> None:
        """Order the blocks, reset them, freeze the plan.  All allocation ends here.

        A ValueError names what is missing (a block, a wire to an input), or the loop that has no delayed wire.
        """
        self._plans = _UNPREPARED
        delayed = {source for source, late in self._wires.values() if late}
        before = {source: np.zeros_like(self._signals[source]) for source in delayed}
        calls = [(self._blocks[name][1], self._call(name, before)) for name in self._in_order()]
        cycle = math.lcm(*(every for every, _ in calls))
        if cycle > self.LONGEST_CYCLE:
            raise ValueError(f"the blocks' rates repeat after {cycle} ticks, must be <= {self.LONGEST_CYCLE}")
        for frame in self._signals.values():
            frame.fill(0.0)
        for block, every in self._blocks.values():
            block.prepare(self.rate / every, self.frames)
        copies: list[Call] = [(np.positive, (self._signals[source], frame)) for source, frame in before.items()]
        self._plans = tuple((*copies, *(call for every, call in calls if n % every == 0)) for n in range(cycle))
        self.ticks = 0

    def rehearse(self) -> None:
        """Have every block do what it does in a first tick and a second, and forget it; then it must be prepared.

        What is compiled at its first use is compiled now, while nothing outside waits.  For blocks with devices behind
        them that are not open, or do nothing yet.
        """
        self.prepare()
        for _ in range(2):
            for process, signals in self._plans[0]:
                process(*signals)
        self._plans = _UNPREPARED

    def tick(self) -> None:
        """Run one tick.  No array is made, no lock, I/O or log call happens below this line."""
        if self.changes:
            for _ in range(len(self.changes)):
                self.changes.popleft()()
        for process, signals in self._plans[self.ticks % len(self._plans)]:
            process(*signals)
        self.ticks += 1

    def signal(self, output: str) -> np.ndarray:
        """Return the live frame of output "block.port", shape (frames, width)."""
        self._port(output, "outputs")
        return self._signals[output]

    def port(self, output: str) -> Port:
        """Return the port of output "block.port"; KeyError where there is none."""
        return self._port(output, "outputs")

    def _port(self, path: str, side: str) -> Port:
        name, _, port_name = path.partition(".")
        if name not in self._blocks:
            raise KeyError(f"no block {name!r} for {path!r}; there are {sorted(self._blocks)}")
        ports: dict[str, Port] = {port.name: port for port in getattr(self._blocks[name][0], side)}
        if port_name not in ports:
            raise KeyError(f"{name} has no port {port_name!r} among its {side}; there are {list(ports)}")
        return ports[port_name]

    def _in_order(self) -> list[str]:
        if not self._blocks:
            raise ValueError("the graph has no block, must have at least one")
        order = TopologicalSorter[str](dict.fromkeys(self._blocks, ()))
        for target, (source, delayed) in self._wires.items():
            if not delayed:
                order.add(target.partition(".")[0], source.partition(".")[0])
        try:
            return list(order.static_order())
        except CycleError as fault:
            loop = " -> ".join(fault.args[1])
            raise ValueError(f"these blocks wait for each other: {loop}; make one wire between them delayed") from None

    def _call(self, name: str, before: dict[str, np.ndarray]) -> Call:
        block, _ = self._blocks[name]
        unwired = [port.name for port in block.inputs if f"{name}.{port.name}" not in self._wires]
        if unwired:
            raise ValueError(f"{name}: input {', '.join(unwired)} is not wired")
        wires = [self._wires[f"{name}.{port.name}"] for port in block.inputs]
        ins = [before[source] if delayed else self._signals[source] for source, delayed in wires]
        return block.process, (*ins, *(self._signals[f"{name}.{port.name}"] for port in block.outputs))


def _refuse_tick() -> None:
    raise RuntimeError("the graph is not prepared: call prepare() after the last add() or connect(), then tick()")


_UNPREPARED: tuple[tuple[Call, ...], ...] = (((_refuse_tick, ()),),)
