"""A thousand CAN FD frames a second each way, through a pseudo-terminal, to a stage in another process."""

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from ctlblocks import Block, Graph, Port
from stagectl.link.blocks import Receive, Send
from stagectl.link.clock import run_linked
from stagectl.link.stage_link import StageLink
from stagectl.wire.messages import State
from tests.contract.source_tree import ROOT
from tests.stagectl.link.stand_in import link_to
from tests.until import EVER


class Sawtooth(Block):
    """Count samples, in steps of 10 nm, modulo 10 000."""

    outputs = (Port("reference", "m", 3),)

    def prepare(self, rate: float, frames: int) -> None:
        self.done = 0

    def process(self, reference: np.ndarray) -> None:
        reference[:] = (1e-8 * ((self.done + np.arange(len(reference))) % 10_000))[:, np.newaxis]
        self.done += len(reference)


@contextmanager
def stage_in_a_process(path: Path) -> Iterator[None]:
    command = [sys.executable, "-m", "tests.stagectl.link.stand_in", str(path)]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        try:
            assert process.stdout.readline() == "ready\n"
            yield
        finally:
            process.terminate()
        assert process.stdout.read() == "0 0\n"  # frames dropped and lines refused by the adapter


def stream(path: Path, blocks: int) -> None:
    """Stream, and demand that nothing was lost either way, by the counts of both ends."""
    graph = Graph(10_000.0, 10)
    with stage_in_a_process(path):
        with StageLink(link_to(path)) as link:
            receive = Receive(link)
            graph.add("sawtooth", Sawtooth())
            graph.add("send", Send(link))
            graph.add("receive", receive)
            graph.connect("sawtooth.reference", "send.reference")
            graph.prepare()
            link.start()
            before = link.counts.received
            assert run_linked(graph, link, blocks) == blocks
            counts = link.counts
            assert (counts.lost, counts.late, counts.garbled, receive.missed) == (0, 0, 0, 0)
            assert counts.received - before >= blocks
            first = link.status
            with link._carrier.arrived:  # noqa: SLF001 (no sleep in tests)
                assert link._carrier.arrived.wait_for(lambda: link.status is not first, EVER)  # noqa: SLF001
            status = link.status
            assert status is not None
            assert (status.lost, status.late, status.garbled, link.reason) == (0, 0, 0, "")
            assert status.reference in range(blocks - 500, blocks)
            assert link.state is State.FOLLOWING


@pytest.mark.deadline(0.05)
def test_nothing_is_lost_in_3_seconds(tmp_path: Path) -> None:
    stream(tmp_path / "adapter", 3000)


@pytest.mark.slow
def test_nothing_is_lost_in_60_seconds(tmp_path: Path) -> None:
    stream(tmp_path / "adapter", 60_000)
