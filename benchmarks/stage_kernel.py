"""What the stage's controllers cost, beside C, in a graph and on a timer: python -m benchmarks.stage_kernel."""

import os
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from statistics import median

import numpy as np

from benchmarks.stage_kernel_c import SOURCE
from ctlblocks import Block, Graph, Port
from ctlblocks.clock import Timer
from stagectl.config import StageConfig
from stagectl.stage import controller_kernel
from stagectl.stage.axis_record import AXIS
from stagectl.stage.controller import StageController
from stagectl.stage.design import design
from stagectl.stage.loop import Stage, inner_loops
from tests.stagectl.experiments.piezo.linear_stage import RATE
from tests.stagectl.experiments.piezo.simulated_models import simulated_model

FRAMES = (1, 10, 1_000)
SAMPLES = 200_000
ROUNDS, INPUTS = 15, 16


class Standing(Block):
    """A value that stays where it is, but for its last bits: a sensor that repeats itself is stuck.

    Ports: `value` (m), three wide, out.
    """

    outputs = (Port("value", "m", 3),)

    def __init__(self, value: float) -> None:
        self._values, self._at = (np.full(3, value), np.full(3, value + 1e-12)), 0

    def process(self, value: np.ndarray) -> None:
        """Fill one sample."""
        self._at = 1 - self._at
        value[:] = self._values[self._at]


def controller() -> StageController:
    """Return three axes that run: PID, filters of order 7, integral states."""
    config = StageConfig()
    loop = design(simulated_model("x"), config.outer, 0).loop
    made = StageController(inner_loops(config), [loop] * 3, config.limits)
    made.prepare(RATE, 1)
    made.start(np.full(3, 500.0))
    return made


def signals(frames: int, seed: int) -> list[np.ndarray]:
    """Return reference, position and extension, with noise, and room for what is made of them."""
    noise = 1e-8 * np.random.default_rng(seed).standard_normal((3, frames, 3))
    return [225e-6 + noise[0], 225e-6 + noise[1], 45e-6 + noise[2], np.empty((frames, 3)), np.empty((frames, 3))]


def compiled(folder: Path) -> Callable[[list[np.ndarray], np.ndarray], Callable[[], object]]:
    """Build the C kernel and return what binds arrays to a call of it; RuntimeError if there is no compiler."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        raise RuntimeError("there is no C compiler")
    try:
        from cffi import FFI  # noqa: PLC0415 (the benchmark alone needs it)
    except ImportError:
        raise RuntimeError("cffi is not installed") from None
    source, library = folder / "axes.c", folder / "axes.so"
    source.write_text(SOURCE)
    subprocess.run([compiler, "-O3", "-shared", "-fPIC", "-o", str(library), str(source), "-lm"], check=True)
    ffi = FFI()
    ffi.cdef("void run(long, void *, void *, void *, void *, void *, void *, long); long size(void);")
    loaded = ffi.dlopen(str(library))
    if loaded.size() != AXIS.itemsize:
        raise RuntimeError(f"the C record has {loaded.size()} bytes, must be {AXIS.itemsize}")

    def bind(frames: list[np.ndarray], axes: np.ndarray) -> Callable[[], object]:
        pointers = [ffi.cast("void *", each.ctypes.data) for each in (*frames, axes)]
        return partial(loaded.run, len(frames[0]), *pointers, len(axes))

    return bind


def nanoseconds(calls: list[Callable[[], object]], frames: int) -> float:
    """Return what a sample costs, ns of this thread: the least of a few rounds over calls that differ in inputs."""
    repeats, least = max(1, SAMPLES // frames // len(calls) // ROUNDS), float("inf")
    for _ in range(ROUNDS):
        start = time.thread_time()
        for _ in range(repeats):
            for call in calls:
                call()
        least = min(least, time.thread_time() - start)
    return 1e9 * least / repeats / len(calls) / frames


def kernel_report() -> Iterator[str]:
    """Compare the kernels, a line for each frame length; both must give the same."""
    axes = controller()._axes  # noqa: SLF001 (what the block hands its kernel)
    with tempfile.TemporaryDirectory() as folder:
        try:
            bind = compiled(Path(folder))
        except RuntimeError as reason:
            yield f"beside C: skipped, {reason}"
            return
        for frames in FRAMES:
            here, there = ([signals(frames, seed) for seed in range(INPUTS)] for _ in range(2))
            ours, theirs = axes.copy(), axes.copy()
            numba = [partial(controller_kernel.run, *each, ours) for each in here]
            in_c = [bind(each, theirs) for each in there]
            for call in (*numba, *in_c):
                call()
            pairs = [(one[n], other[n]) for one, other in zip(here, there, strict=True) for n in (3, 4)]
            same = max(float(np.abs(one - other).max()) for one, other in pairs)
            costs = nanoseconds(numba, frames), nanoseconds(in_c, frames)
            yield (
                f"{frames} samples a call: {costs[0]:.0f} ns a sample here, {costs[1]:.0f} in C -O3 through cffi, "
                f"ratio {costs[0] / costs[1]:.2f}; outputs differ by {same:.1g} V"
            )


def stage_graph() -> tuple[Graph, Stage]:
    """Return sensor check, controller and guard, with sensors that stand still but for their last bits."""
    graph = Graph(RATE)
    stage = Stage(graph, StageConfig(), controller())
    for name, value in (("reference", 225e-6), ("position", 225e-6), ("extension", 45e-6)):
        graph.add(name, Standing(value))
    graph.connect("reference.value", "controller.reference")
    graph.connect("position.value", "sensors.position")
    graph.connect("extension.value", "sensors.extension")
    graph.prepare()
    for _ in range(2_500):
        graph.tick()
    stage.start()
    return graph, stage


def tick_report(seconds: float) -> Iterator[str]:
    """Time the graph's ticks, as fast as they go and then on a timer."""
    graph, _ = stage_graph()
    took = []
    for _ in range(50_000):
        start = time.perf_counter_ns()
        graph.tick()
        took.append(time.perf_counter_ns() - start)
    spread = np.percentile(took, [50, 99, 99.9]) / 1e3
    yield f"a tick of one sample: median {median(took) / 1e3:.1f} us, 99 % {spread[1]:.1f}, 99.9 % {spread[2]:.1f}"
    timer = Timer(graph, ["guard.voltage"])
    timer.run(round(seconds * RATE))
    share = 100 * timer.late / (seconds * RATE)
    yield (
        f"{seconds:g} s at {RATE:g} samples/s on a timer: {timer.late} ticks late ({share:.2f} %), the worst by "
        f"{1e3 * timer.worst:.1f} ms; load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores"
    )


if __name__ == "__main__":
    for line in kernel_report():
        print(line)
    for line in tick_report(60.0):
        print(line)
