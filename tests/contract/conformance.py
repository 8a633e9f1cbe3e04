"""What every Block promises, as checks that name the block and what it did."""

import importlib
import pkgutil
import tracemalloc
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any

import numpy as np

from ctlblocks import Block
from ctlblocks.block import refuse_other_arguments

PACKAGES = ("ctlblocks", "rigkit", "vibractl", "stagectl", "calibration", "firmware_sim", "vibrostage")
FRAMES, PARTS = 512, 8
FAINT = 1e-300
"""An input that is nearly nothing, in any unit: what is left of it is subnormal after a few time constants."""
SILENT = 64
"""Frames of zeros in which what an input left behind dies away, unless an example needs fewer."""
LARGE = 16_384
"""Samples of a frame in which an array made by mistake cannot be overlooked."""


def _nothing(block: Block) -> None:
    """Start nothing."""


@dataclass(frozen=True)
class Example:
    """How to build one block to be checked.

    Parameters
    ----------
    make : callable() -> Block
        With settings that let it do something to inputs of -0.1 to 0.1.
    start : callable(Block)
        What must happen between `prepare` and the first tick, such as opening a guard.
    rate : float, samples/s
    silent : int
        Frames of zeros after which all is at rest.
    """

    make: Callable[[], Block]
    start: Callable[[Any], None] = _nothing
    rate: float = 44_100.0
    silent: int = SILENT


def every_block() -> list[type[Block]]:
    """Import all modules of the project and return every Block in them."""
    for package in filter(find_spec, PACKAGES):
        for module in pkgutil.walk_packages(importlib.import_module(package).__path__, f"{package}."):
            if not module.name.endswith("__main__"):
                importlib.import_module(module.name)
    found = [kind for kind in _below(Block) if kind.__module__.partition(".")[0] in PACKAGES]
    return sorted(set(found), key=lambda kind: (kind.__module__, kind.__name__))


def _below(kind: type[Block]) -> Iterator[type[Block]]:
    for child in kind.__subclasses__():
        yield child
        yield from _below(child)


def check_arguments_are_ports(example: Example) -> None:
    """Compare the ports with the signature: they are it."""
    refuse_other_arguments(example.make())


def check_inputs_are_untouched(example: Example) -> None:
    """Leave the inputs to their other readers as they are."""
    block = _prepared(example, FRAMES)
    inputs = _noise(block)
    before = [signal.tobytes() for signal in inputs]
    block.process(*inputs, *_blank(block, FRAMES))
    for port, signal, bits in zip(block.inputs, inputs, before, strict=True):
        assert signal.tobytes() == bits, f"{_name(block)} writes into its input {port.name}"


def check_every_sample_is_written(example: Example) -> None:
    """Fill the outputs with NaN, of which none may be left."""
    block = _prepared(example, FRAMES)
    for port, signal in zip(block.outputs, _run(block, _noise(block), FRAMES), strict=True):
        blank = np.argwhere(np.isnan(signal))
        assert not len(blank), f"{_name(block)} leaves {port.name}[{', '.join(map(str, blank[0]))}] unwritten"


def check_frames_do_not_matter(example: Example) -> None:
    """Compare one long frame with several short ones, bit for bit, from one block prepared twice."""
    block = _prepared(example, FRAMES)
    inputs = _noise(block)
    whole = _run(block, inputs, FRAMES)
    _prepare(block, example, FRAMES // PARTS)
    _same(block, whole, _run(block, inputs, FRAMES // PARTS), f"{FRAMES} frames and {PARTS} x {FRAMES // PARTS} differ")


def check_prepare_resets(example: Example) -> None:
    """Compare a run with the run after another `prepare`, bit for bit."""
    block = _prepared(example, FRAMES // PARTS)
    inputs = _noise(block)
    first = _run(block, inputs, FRAMES // PARTS)
    _prepare(block, example, FRAMES // PARTS)
    _same(block, first, _run(block, inputs, FRAMES // PARTS), "prepare does not reset it")


def check_nothing_is_allocated(example: Example) -> None:
    """Trace what numpy and numba allocate in a call: less than the smallest array, of bool, of a frame's length."""
    block = _prepared(example, LARGE)
    signals = (*_noise(block, LARGE), *_blank(block, LARGE))
    block.process(*signals)  # compiles
    peak = LARGE
    for _ in range(3):  # what another thread of the tests allocates meanwhile does not come again
        if peak >= LARGE // 2:
            _prepare(block, example, LARGE)
            peak = _traced(block, signals)
    assert peak < LARGE // 2, f"{_name(block)} allocates {peak} bytes in a frame of {LARGE} samples"


def _traced(block: Block, signals: tuple[np.ndarray, ...]) -> int:
    """Return the most that is allocated at once while a frame is processed, bytes."""
    tracemalloc.start()
    try:
        block.process(*signals)
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def check_silence_leaves_nothing_subnormal(example: Example) -> None:
    """Look at all that a block holds, for numbers that die away are slow on some processors: they must become 0."""
    for size in (0.1, FAINT):
        block = _prepared(example, FRAMES)
        held = {_place(numbers): numbers.copy() for numbers in _held(block, set())}
        outputs = _blank(block, FRAMES)
        silence = [np.zeros((FRAMES, port.width)) for port in block.inputs]
        with np.errstate(all="ignore"):  # an orientation of zeros is none
            block.process(*(size / 0.1 * signal for signal in _noise(block)), *outputs)
            for _ in range(example.silent):
                block.process(*silence, *outputs)
        for numbers in _held(block, set()):
            slow = (numbers != 0.0) & (np.abs(numbers) < np.finfo(float).tiny)
            slow &= numbers != held.get(_place(numbers), 0.0)  # room that is not written yet may hold anything
            assert not slow.any(), (
                f"{_name(block)} holds {numbers[slow][0]:g} after {example.silent * FRAMES} silent samples"
            )


CHECKS = (
    check_arguments_are_ports,
    check_inputs_are_untouched,
    check_every_sample_is_written,
    check_frames_do_not_matter,
    check_prepare_resets,
    check_nothing_is_allocated,
    check_silence_leaves_nothing_subnormal,
)


def _held(thing: Any, seen: set[int]) -> Iterator[np.ndarray]:
    """Find every array of double precision in a block, and in all of the project's that it holds."""
    if id(thing) in seen:
        return
    seen.add(id(thing))
    parts: Iterable[Any] = ()
    if isinstance(thing, np.ndarray):
        if thing.dtype == float:
            yield thing
        parts = [thing[name] for name in thing.dtype.names or ()]
    elif isinstance(thing, float):
        yield np.array(thing)
    elif isinstance(thing, dict):
        parts = thing.values()
    elif isinstance(thing, tuple | list | deque):
        parts = thing
    elif isinstance(thing, Block) or type(thing).__module__.partition(".")[0] in PACKAGES:
        parts = [*getattr(thing, "__dict__", {}).values()]
    for part in parts:
        yield from _held(part, seen)


def _place(numbers: np.ndarray) -> tuple[object, ...]:
    return numbers.__array_interface__["data"], numbers.shape, numbers.strides


def _prepared(example: Example, frames: int) -> Block:
    block = example.make()
    _prepare(block, example, frames)
    return block


def _prepare(block: Block, example: Example, frames: int) -> None:
    block.prepare(example.rate, frames)
    example.start(block)


def _noise(block: Block, frames: int = FRAMES) -> list[np.ndarray]:
    random = np.random.default_rng(6)
    return [random.uniform(-0.1, 0.1, (frames, port.width)) for port in block.inputs]


def _blank(block: Block, frames: int) -> list[np.ndarray]:
    return [np.full((frames, port.width), np.nan) for port in block.outputs]


def _run(block: Block, inputs: list[np.ndarray], frames: int) -> list[np.ndarray]:
    outputs = _blank(block, FRAMES)
    for start in range(0, FRAMES, frames):
        block.process(*(signal[start : start + frames] for signal in (*inputs, *outputs)))
    return outputs


def _same(block: Block, one: list[np.ndarray], other: list[np.ndarray], otherwise: str) -> None:
    for port, first, second in zip(block.outputs, one, other, strict=True):
        different = np.flatnonzero(np.any(first.view("u8") != second.view("u8"), axis=1))
        assert not len(different), f"{_name(block)}: {otherwise} in {port.name} from sample {different[0]}"


def _name(block: Block) -> str:
    return f"{type(block).__module__}.{type(block).__name__}"
