"""The clock that the stage keeps: a tick a block, and what ends it."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from ctlblocks import Graph
from firmware_sim.can_node import CanNode
from firmware_sim.stage_processor import Settings
from stagectl.link.blocks import Receive
from stagectl.link.bus import LinkError
from stagectl.link.clock import run_linked
from stagectl.link.stage_link import StageLink
from tests.stagectl.link.stand_in import PATIENT, link_to, running
from tests.until import EVER

Rig = tuple[StageLink, Graph, Receive, CanNode]
SOON = 1.0
"""s in which a block must come."""
pytestmark = pytest.mark.stall(SOON / 2)


@pytest.fixture(params=["fd", "classic"])
def rig(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Rig]:
    path = tmp_path / "adapter"
    with running(path, Settings(form=request.param, silence=PATIENT)) as (node, _):
        with StageLink(link_to(path, form=request.param, patience=SOON)) as link:
            graph, receive = Graph(link.rate, link.frames), Receive(link)
            graph.add("receive", receive)
            graph.prepare()
            yield link, graph, receive, node


def test_there_is_a_tick_for_each_block_and_none_waits_or_is_left_over(rig: Rig) -> None:
    link, graph, receive, _ = rig
    assert link.wait(link.skip() + 50 * link.frames, EVER)
    before = link.skip()
    assert run_linked(graph, link, 100) == 100
    assert (graph.ticks, receive.missed) == (100, 0)
    ring, _ = link.signal("position")
    assert ring.taken >= before + 100 * link.frames


def test_it_stops_when_asked(rig: Rig) -> None:
    link, graph, _, _ = rig
    assert run_linked(graph, link, 1000, lambda: graph.ticks == 7) == 7


def test_a_stage_that_sends_no_blocks_ends_it(rig: Rig) -> None:
    link, graph, _, node = rig
    node.suffer("unplug")
    with pytest.raises(LinkError, match="no block from the stage within 1 s"):
        run_linked(graph, link, 10_000)


def test_a_graph_of_other_frames_is_refused(rig: Rig) -> None:
    link, _, _, _ = rig
    with pytest.raises(ValueError, match=f"ticks by 7 frames .*, must be {link.frames} at .* as on the wire"):
        run_linked(Graph(link.rate, 7), link, 1)
