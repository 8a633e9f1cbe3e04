"""What a graph costs by itself, and ten gains in a chain beside GNU Radio's: python -m benchmarks.graph."""

import os
import subprocess
import time
import timeit
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import numpy as np

from ctlblocks import Block, Graph, Port
from ctlblocks.basic import Gain
from ctlblocks.clock import run_offline

FRAMES = 64
SAMPLES = 64 * 30_000
"""A chain is given at a time: some 0.1 s."""
BUFFERS = (16_384, 1_024)
"""Samples between two of GNU Radio's blocks: its own choice, and the fewest it grants (a page)."""
PEER = Path(__file__).with_name("gnuradio_gains.py")
PEER_PYTHON = "/usr/bin/python3"
"""Debian's own, which sees the package gnuradio."""


class Source(Block):
    """A frame that stays as it is."""

    outputs = (Port("signal"),)

    def process(self, signal: np.ndarray) -> None:
        """Do nothing."""


class Nothing(Block):
    """A block of which the call is all."""

    inputs = (Port("signal"),)
    outputs = (Port("same"),)

    def process(self, signal: np.ndarray, same: np.ndarray) -> None:
        """Do nothing."""


def chain(blocks: Sequence[Block], frames: int) -> Graph:
    """Return a prepared graph of the blocks, one after the other; the first has no input, and noise for an output."""
    graph = Graph(44_100.0, frames)
    names = [f"b{n}" for n in range(len(blocks))]
    for name, block in zip(names, blocks, strict=True):
        graph.add(name, block)
    for n in range(1, len(blocks)):
        source, target = blocks[n - 1].outputs[0].name, blocks[n].inputs[0].name
        graph.connect(f"{names[n - 1]}.{source}", f"{names[n]}.{target}")
    graph.prepare()
    graph.signal("b0.signal")[:] = np.random.default_rng(8).standard_normal((frames, 1))
    return graph


def ten_gains() -> Graph:
    """Return ten gains behind a source, 64 samples a tick."""
    return chain([Source(), *(Gain(1.0 + n / 8) for n in range(10))], FRAMES)


def own_cost(blocks: int = 10, rounds: int = 201, ticks: int = 500) -> tuple[float, float]:
    """Return the graph's cost and a bare call's, us a block: a tick beside the same calls in a row, in turns."""
    kinds = [Source(), *(Nothing() for _ in range(blocks - 1))]
    graph = chain(kinds, 1)
    names = {f"p{n}": block.process for n, block in enumerate(kinds)}
    row = "; ".join(f"{name}(a, b)" if n else f"{name}(a)" for n, name in enumerate(names))
    bare = timeit.Timer(row, globals=names | {"a": graph.signal("b0.signal"), "b": graph.signal("b1.same")})
    tick = timeit.Timer("tick()", globals={"tick": graph.tick})
    pairs = [(tick.timeit(ticks), bare.timeit(ticks)) for _ in range(rounds)]
    scale = 1e6 / ticks / blocks
    return median(tick - bare for tick, bare in pairs) * scale, median(bare for _, bare in pairs) * scale


@dataclass(frozen=True)
class Taken:
    """What a run took: by the clock and on all cores together, s."""

    clock: float
    cores: float


@contextmanager
def gnu_radio(buffer: int) -> Iterator[Callable[[], Taken]]:
    """Start GNU Radio beside this process and hand out what runs its chain once; RuntimeError if it is not there."""
    if not Path(PEER_PYTHON).exists():
        raise RuntimeError(f"there is no {PEER_PYTHON}")
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen([PEER_PYTHON, PEER], text=True, **pipes) as peer:
        assert peer.stdin
        assert peer.stdout
        assert peer.stderr
        if not peer.stdout.readline():
            reason = peer.stderr.read().strip().splitlines()[-1]
            raise RuntimeError(f"{PEER_PYTHON}: {reason} (apt-get install gnuradio)")

        def run() -> Taken:
            print(SAMPLES, buffer, file=peer.stdin, flush=True)
            return Taken(*map(float, peer.stdout.readline().split()))

        yield run
        peer.stdin.close()


def beside_gnu_radio(buffer: int, rounds: int = 15) -> tuple[list[Taken], list[Taken]]:
    """Return what both chains took, in turns; RuntimeError if GNU Radio is not there."""
    graph = ten_gains()
    with gnu_radio(buffer) as run_peer:
        pairs = [(_taken(graph), run_peer()) for _ in range(rounds + 1)][1:]
    return [own for own, _ in pairs], [peer for _, peer in pairs]


def comparison(buffer: int, here: list[Taken], there: list[Taken]) -> str:
    """Say in a line what both chains did in a second, and how they compare."""
    speeds = [SAMPLES / 1e6 / median(run.clock for run in runs) for runs in (here, there)]
    cores = [SAMPLES / 1e6 / median(run.cores for run in runs) for runs in (here, there)]
    pairs = list(zip(here, there, strict=True))
    ratio = median(peer.clock / own.clock for own, peer in pairs)
    core_ratio = median(peer.cores / own.cores for own, peer in pairs)
    return (
        f"ten gains, {FRAMES} samples a call: {speeds[0]:.1f} MS/s here (float64, one thread), {speeds[1]:.1f} MS/s in "
        f"GNU Radio's C++ (float32, 13 threads, buffers of {buffer}): ratio {ratio:.2f}; per second of a core "
        f"{cores[0]:.1f} and {cores[1]:.1f} MS/s: ratio {core_ratio:.2f}; load {os.getloadavg()[0]:.1f} on "
        f"{os.cpu_count()} cores"
    )


def _taken(graph: Graph) -> Taken:
    clock, cores = time.perf_counter(), time.process_time()
    run_offline(graph, SAMPLES // FRAMES)
    return Taken(time.perf_counter() - clock, time.process_time() - cores)


def report() -> Iterator[str]:
    """Measure everything, a line each."""
    cost, call = own_cost()
    yield f"a graph's own cost: {cost:.3f} us a block call, beside {call:.3f} us of a call that does nothing"
    try:
        for buffer in BUFFERS:
            yield comparison(buffer, *beside_gnu_radio(buffer))
    except RuntimeError as reason:
        yield f"ten gains beside GNU Radio: skipped, {reason}"


if __name__ == "__main__":
    for line in report():
        print(line)
