"""The link's Blocks, without a bus."""

import numpy as np
import pytest

from ctlblocks import Graph
from stagectl.link.blocks import Newest, Receive, Send
from stagectl.link.config import Link
from stagectl.link.stage_link import LinkFault, StageLink
from stagectl.wire import messages, samples


def a_link(**others: object) -> StageLink:
    return StageLink(Link(**{"origin": 225e-6} | others))  # type: ignore[arg-type]


def test_positions_come_in_order_from_where_mid_travel_is() -> None:
    link = a_link()
    receive = Receive(link)
    receive.prepare(10_000.0, 4)
    link.signal("position")[0].put(np.arange(30.0).reshape(10, 3) * 1e-6)
    position = np.full((4, 3), np.nan)
    receive.process(position)
    np.testing.assert_allclose(position, 225e-6 + np.arange(12.0).reshape(4, 3) * 1e-6)
    receive.process(position)
    np.testing.assert_allclose(position[0], 225e-6 + np.array([12.0, 13.0, 14.0]) * 1e-6)


def test_what_has_not_come_is_held_and_counted() -> None:
    link = a_link()
    receive = Receive(link)
    receive.prepare(10_000.0, 10)
    position = np.full((10, 3), np.nan)
    receive.process(position)
    assert (position == 225e-6).all()
    link.signal("position")[0].put(np.full((3, 3), 1e-6))
    receive.process(position)
    np.testing.assert_allclose(position, 226e-6)
    receive.process(position)
    np.testing.assert_allclose(position, 226e-6)
    assert receive.missed == 27


def test_prepared_again_it_begins_with_what_comes_next() -> None:
    link = a_link()
    receive = Receive(link)
    link.signal("position")[0].put(np.ones((10, 3)))
    receive.prepare(10_000.0, 1)
    position = np.zeros((1, 3))
    receive.process(position)
    assert (position == 225e-6).all()


def test_references_are_sent_from_mid_travel() -> None:
    link = a_link()
    send = Send(link)
    send.prepare(10_000.0, 2)
    send.process(np.full((2, 3), 235e-6))
    block = np.zeros((2, 3))
    assert link.references.take(block) == 2
    np.testing.assert_allclose(block, 10e-6)


def test_the_newest_voltage_is_held() -> None:
    link = a_link()
    newest = Newest(link, "voltage")
    voltage = np.zeros((5, 3))
    newest.process(voltage)
    assert np.isnan(voltage).all()
    data = samples.encode(messages.VOLTAGE, 0, np.full((10, 3), 42.0))
    link._conversation.take(messages.VOLTAGE.identifier, data, 0.0)  # noqa: SLF001 (what comes from the bus)
    newest.process(voltage)
    assert (voltage == 42.0).all()
    assert newest.outputs[0].unit == "V"


def test_a_graph_at_another_rate_is_refused() -> None:
    for block in (Receive(a_link()), Send(a_link())):
        with pytest.raises(ValueError, match="runs at 1000 samples/s, must be 10000 for link.form fd"):
            block.prepare(1000.0, 1)
    Receive(a_link(form="classic")).prepare(1000.0, 1)


def test_a_signal_that_does_not_come_is_refused_by_name() -> None:
    with pytest.raises(KeyError, match="no signal 'force' comes from the stage"):
        Newest(a_link(), "force")


def test_a_latched_link_stops_the_graph() -> None:
    link = a_link()
    graph = Graph(10_000.0, 10)
    graph.add("receive", Receive(link))
    graph.add("send", Send(link))
    graph.connect("receive.position", "send.reference")
    graph.prepare()
    graph.tick()
    link._conversation.latch("the adapter has gone")  # noqa: SLF001 (what its threads do)
    with pytest.raises(LinkFault, match="the adapter has gone; a person must acknowledge"):
        graph.tick()
