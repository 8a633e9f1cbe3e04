"""What happens to the link while the stage follows: it ends at mid-travel, says why, and a person brings it back.

The failures a rig has: the adapter's plug is pulled, the cable picks up noise, a sensor sticks, the stage's processor
stops to beat, the host's program hangs.
"""

import threading
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ctlblocks import Block, Graph, Port
from firmware_sim.can_node import CanNode, Mishap
from firmware_sim.stage_processor import Settings
from stagectl.link.blocks import Receive, Send
from stagectl.link.bus import LinkError
from stagectl.link.clock import run_linked
from stagectl.link.stage_link import LinkFault, StageLink
from stagectl.wire.messages import Fault, State
from tests.stagectl.link.stand_in import SILENT, FirstOrderStage, link_to, node, running
from tests.until import EVER

pytestmark = pytest.mark.deadline(SILENT / 2)


class Sweep(Block):
    """A sine of 50 um and 5 Hz on every axis; `at` says what happens after which tick."""

    outputs = (Port("reference", "m", 3),)

    def __init__(self, at: dict[int, Callable[[], object]]) -> None:
        self.at = at

    def prepare(self, rate: float, frames: int) -> None:
        self.ticks = 0

    def process(self, reference: np.ndarray) -> None:
        time = (self.ticks * len(reference) + np.arange(len(reference))) / 10_000.0
        reference[:] = 50e-6 * np.sin(2 * np.pi * 5.0 * time)[:, np.newaxis]
        self.ticks += 1
        self.at.get(self.ticks, lambda: None)()


class Rig:
    """A link to a stand-in, its log, and a graph that sweeps."""

    def __init__(self, link: StageLink, node: CanNode, stage: FirstOrderStage) -> None:
        self.link, self.node, self.stage = link, node, stage
        self.at: dict[int, Callable[[], object]] = {}

    def sweep(self, ticks: int) -> np.ndarray:
        """Run and return the last block of positions, shape (10, 3), m."""
        graph = Graph(10_000.0, 10)
        graph.add("sweep", Sweep(self.at))
        graph.add("send", Send(self.link))
        graph.add("receive", Receive(self.link))
        graph.connect("sweep.reference", "send.reference")
        graph.prepare()
        self.link.start()
        run_linked(graph, self.link, ticks)
        return graph.signal("receive.position").copy()

    def becomes(self, state: State) -> None:
        """Wait until the stage says so."""
        with self.link._carrier.arrived:  # noqa: SLF001 (no sleep in tests)
            assert self.link._carrier.arrived.wait_for(lambda: self.link.state is state, EVER)  # noqa: SLF001


@pytest.fixture
def log() -> list[tuple[str, Mapping[str, Any]]]:
    return []


@pytest.fixture
def rig(tmp_path: Path, log: list[tuple[str, Mapping[str, Any]]]) -> Iterator[Rig]:
    path = tmp_path / "adapter"
    with running(path, Settings(silence=SILENT, ramp=0.05)) as (made, stage):
        with StageLink(link_to(path, silence=SILENT, patience=3.0), lambda *event: log.append(event)) as link:
            yield Rig(link, made, stage)


def test_without_a_mishap_the_stage_follows(rig: Rig) -> None:
    position = rig.sweep(1000)
    assert np.abs(position).max() > 0.0
    assert (rig.link.reason, rig.link.state) == ("", State.FOLLOWING)
    assert (rig.link.counts.lost, rig.link.counts.garbled) == (0, 0)
    assert 900 < rig.link.sent <= 1000  # the last may still be on their way
    rig.link.stop()
    rig.becomes(State.HOLDING)
    assert rig.link.stage_fault is Fault.NONE


@pytest.mark.parametrize(
    ("mishap", "reason"),
    [
        ("unplug", "the adapter .* has gone|the adapter .* does not send"),
        ("stuck-sensor", "the stage reports SENSOR_STUCK"),
        ("no-heartbeat", "the stage is silent for"),
    ],
)
def test_a_mishap_latches_and_nothing_starts_again_by_itself(
    rig: Rig, log: list[tuple[str, Mapping[str, Any]]], mishap: str, reason: str
) -> None:
    rig.at = {100: lambda: rig.node.suffer(mishap)}
    with pytest.raises(LinkFault, match=reason):
        rig.sweep(5000)
    why = rig.link.reason
    assert log == [("link_fault", {"reason": why})]
    with pytest.raises(LinkFault, match="a person must acknowledge"):
        rig.link.start()
    if mishap != "stuck-sensor":
        with pytest.raises(LinkError, match="sends nothing"):
            rig.link.acknowledge("A. Person")
    rig.node.suffer({"unplug": "replug", "no-heartbeat": "heartbeat", "stuck-sensor": "heartbeat"}[mishap])
    rig.becomes(State.FAULT)
    assert rig.link.reason == why
    np.testing.assert_allclose(rig.stage.position, 0.0, atol=4e-6)
    assert rig.link.acknowledge("A. Person") == why
    assert log[1:] == [("link_acknowledged", {"by": "A. Person", "reason": why})]
    rig.at = {}
    rig.sweep(300)
    assert (rig.link.reason, rig.link.state) == ("", State.FOLLOWING)


def test_garbage_on_the_line_is_counted_and_borne(rig: Rig) -> None:
    rig.at = dict.fromkeys(range(100, 500, 50), lambda: rig.node.suffer("garbage"))
    rig.sweep(600)
    assert (rig.link.reason, rig.link.state) == ("", State.FOLLOWING)
    assert rig.link.counts.garbled >= 8


def test_a_host_that_hangs_leaves_the_stage_at_mid_travel(rig: Rig) -> None:
    """Its threads go on to beat, but no reference comes any more."""
    rig.at = {300: lambda: rig.becomes(State.FAULT)}
    with pytest.raises(LinkFault, match="the stage reports REFERENCE_SILENT"):
        rig.sweep(5000)
    np.testing.assert_allclose(rig.stage.position, 0.0, atol=4e-6)


def test_a_host_that_is_killed_leaves_the_stage_at_mid_travel(rig: Rig) -> None:
    def kill() -> None:
        rig.link._carrier._over.set()  # noqa: SLF001 (both threads end without a word)
        rig.link._conversation.end()  # noqa: SLF001 (nor will the test's own end say one)
        raise KeyboardInterrupt

    rig.at = {300: kill}
    with pytest.raises(KeyboardInterrupt):
        rig.sweep(5000)
    processor, reached = rig.node.processor, threading.Event()
    tick = rig.stage.tick

    def watched(reference: np.ndarray) -> dict[str, Any]:
        if processor.state is State.FAULT:
            reached.set()
        return tick(reference)

    object.__setattr__(processor._loops, "tick", watched)  # noqa: SLF001
    assert reached.wait(EVER)
    assert processor.fault in (Fault.HOST_SILENT, Fault.REFERENCE_SILENT)
    np.testing.assert_allclose(rig.stage.position, 0.0, atol=4e-6)


def test_an_adapter_that_has_stopped_to_read_holds_nothing_up(rig: Rig) -> None:
    """Its firmware hangs: the port is there, but takes and gives nothing."""
    answering = threading.Event()
    serve = rig.node.serve
    rig.node.serve = lambda: serve() if answering.is_set() else None  # type: ignore[method-assign]
    answering.set()
    rig.at = {100: answering.clear}
    with pytest.raises(LinkFault, match="the stage is silent|does not send"):
        rig.sweep(5000)
    with pytest.raises(LinkError, match="sends nothing|does not answer"):
        rig.link.acknowledge("A. Person")


def test_mishaps_happen_when_they_are_due(tmp_path: Path) -> None:
    made, _ = node(tmp_path / "adapter", Settings(), (Mishap("unplug", 0.01), Mishap("replug", 0.02)))
    seen: list[bool] = []
    stop = threading.Event()
    serve = made.serve

    def watched() -> None:
        serve()
        seen.append(made.adapter.is_plugged)
        if seen[-1] and False in seen:
            stop.set()

    made.serve = watched  # type: ignore[method-assign]
    made.run(stop)
    assert not made.adapter.is_plugged


@pytest.mark.parametrize(("name", "seconds"), [("earthquake", 1.0), ("unplug", -1.0), ("unplug", float("nan"))])
def test_a_mishap_that_cannot_be_is_refused(name: str, seconds: float) -> None:
    with pytest.raises(ValueError, match=f"a mishap is {name}@"):
        Mishap(name, seconds)
