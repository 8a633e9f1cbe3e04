"""A run over the stage's link: 1000 CAN FD frames/s each way through a pseudo-terminal, the simulated stage behind it.

`python -m benchmarks.stage_link [SECONDS] [--silence S] [--workers-first]`: what was lost or late, and for how long
each end was silent.  As root, or with `ulimit -r`, for real-time priority.
"""

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext, suppress
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from ctlblocks import Block, Graph, Port
from rigkit.priority import undisturbed
from stagectl.link.account import Counts, Status
from stagectl.link.blocks import Receive, Send
from stagectl.link.clock import run_linked
from stagectl.link.config import Link
from stagectl.link.stage_link import StageLink
from stagectl.wire.messages import BLOCK, HOLD, PERIOD, RATE, SILENCE, STATUS, State


class Sweep(Block):
    """20 um and 1 Hz about mid-travel on every axis: `reference` (m, 3) out."""

    outputs = (Port("reference", "m", 3),)

    def prepare(self, rate: float, frames: int) -> None:
        self.ticks = 0

    def process(self, reference: np.ndarray) -> None:
        time = (self.ticks * len(reference) + np.arange(len(reference))) / RATE
        reference[:] = 225e-6 + 20e-6 * np.sin(2 * np.pi * time)[:, np.newaxis]
        self.ticks += 1


@dataclass(frozen=True)
class Outcome:
    """What became of a run.

    Parameters
    ----------
    ticks, missed : int
        Of the graph; samples it had to hold as none had come.
    reason : str
        What ended it, or nothing.
    state : State
    counts : Counts
        Of the frames from the stage.
    status : Status
        The stage's account of those from the host.
    cpu : float, 1
        Of a core, for the host.
    """

    ticks: int
    missed: int
    reason: str
    state: State
    counts: Counts
    status: Status
    cpu: float


@contextmanager
def stage_in_a_process(folder: Path, silence: float) -> Iterator[None]:
    """Run `firmware-sim stage`."""
    command = [sys.executable, "-m", "firmware_sim", "stage", "--pty", "--folder", str(folder)]
    command += ["--set", f"link.silence={silence}"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        try:
            if not process.stdout.readline().startswith("CAN adapter"):
                raise OSError("the simulated stage does not start")
            yield
        finally:
            process.terminate()


@contextmanager
def kernel_workers_first() -> Iterator[None]:
    """Give the kernel's unbound workers, which carry a tty's bytes, the highest ordinary priority; as root."""
    before = {}
    for name in Path("/proc").glob("[0-9]*/comm"):
        with suppress(OSError):
            number = int(name.parent.name)
            if name.read_text().startswith("kworker/u"):
                before[number] = os.getpriority(os.PRIO_PROCESS, number)
                os.setpriority(os.PRIO_PROCESS, number, -20)
    try:
        yield
    finally:
        for number, priority in before.items():
            with suppress(OSError):  # workers come and go
                os.setpriority(os.PRIO_PROCESS, number, priority)


def run(folder: Path, seconds: float, silence: float) -> Outcome:
    """Stream for so long, and return what became of it."""
    link = Link(channel=f"{folder}/can", silence=silence, patience=20.0)
    with stage_in_a_process(folder, silence), StageLink(link) as opened:
        graph, receive = Graph(RATE, BLOCK), Receive(opened)
        graph.add("sweep", Sweep())
        graph.add("send", Send(opened))
        graph.add("receive", receive)
        graph.connect("sweep.reference", "send.reference")
        graph.prepare()
        assert opened.wait(opened.skip() + RATE, 20.0)
        with undisturbed():
            before, begin = resource.getrusage(resource.RUSAGE_SELF), time.monotonic()
            opened.start()
            try:
                run_linked(graph, opened, round(seconds / PERIOD))
            except OSError:
                pass  # `reason` has it
            after, taken = resource.getrusage(resource.RUSAGE_SELF), time.monotonic() - begin
            reason, state, ticks = opened.reason, opened.state, graph.ticks
            if not reason:
                hear_the_last_account(graph, opened)
        counts, status = opened.counts, opened.status
    assert status is not None
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Outcome(ticks, receive.missed, reason, state, counts, status, used / taken)


def hear_the_last_account(graph: Graph, link: StageLink) -> None:
    """Go on until the stage has given its account once more, so that it is of all the run."""
    run_linked(graph, link, round(2 * STATUS.period / PERIOD))


def main() -> None:
    """Print the figures of one run."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("seconds", type=float, nargs="?", default=60.0)
    parser.add_argument("--silence", type=float, default=SILENCE)
    parser.add_argument("--workers-first", action="store_true", help="as root: the kernel's workers before others")
    given = parser.parse_args()
    print(
        f"load before: {os.getloadavg()[0]:.2f}; {given.seconds:g} s, limits {1e3 * given.silence:g} ms for "
        f"heartbeats, {1e3 * (given.silence + HOLD):g} ms for the rest"
    )
    first = kernel_workers_first() if given.workers_first else nullcontext()
    with tempfile.TemporaryDirectory() as folder, first:
        outcome = run(Path(folder), given.seconds, given.silence)
    print(f"{outcome.ticks} ticks, {outcome.missed} samples missed, {outcome.cpu:.2f} of a core for the host")
    print(f"from the stage: {asdict(outcome.counts)}")
    print(f"to the stage: {asdict(outcome.status)}")
    print(f"ended by: {outcome.reason or 'its length'}; load after: {os.getloadavg()[0]:.2f}")


if __name__ == "__main__":
    main()
