"""The relay in the stage's supply: closed while the link is open and well."""

from pathlib import Path

import pytest

from firmware_sim.stage_processor import Settings
from rigkit.relay.bus import RelayError
from stagectl.link.stage_link import StageLink
from stagectl.wire.messages import State
from tests.rigkit.relay.listening import on_the_virtual_bus, virtual
from tests.stagectl.link.stand_in import PATIENT, SILENT, link_to, running
from tests.until import until


@pytest.mark.deadline(SILENT / 2)
def test_it_is_closed_while_the_stage_is_heard_and_opens_for_a_fault_until_it_is_acknowledged(tmp_path: Path) -> None:
    path = tmp_path / "can"
    with (
        on_the_virtual_bus("stage") as heard,
        running(path, Settings(silence=SILENT, ramp=0.02)) as (node, _),
        StageLink(link_to(path, relay=virtual("stage"))) as link,
    ):
        heard.until(closed=True)
        assert link.beats > 0
        link.start()
        until(lambda: bool(link.reason))  # no reference comes for it
        heard.until(closed=False)
        until(lambda: link.state in (State.HOLDING, State.FAULT))
        link.acknowledge("Ada")
        heard.until(closed=True)
        node.suffer("unplug")
        heard.until(closed=False)
        node.suffer("replug")
        heard.until(closed=True)


def test_it_opens_when_the_link_is_closed(tmp_path: Path) -> None:
    path = tmp_path / "can"
    with on_the_virtual_bus("end") as heard, running(path, Settings(silence=PATIENT, ramp=0.02)):
        with StageLink(link_to(path, relay=virtual("end"))):
            heard.until(closed=True)
        heard.until(closed=False)


def test_without_the_relays_bus_the_link_stays_closed(tmp_path: Path) -> None:
    path, away = tmp_path / "can", {"bus": "can:Bus", "channel": "/nowhere", "options": {"interface": "slcan"}}
    with running(path, Settings(silence=PATIENT)):
        with pytest.raises(RelayError, match="can:Bus cannot open relay.channel '/nowhere'"):
            StageLink(link_to(path, relay=away)).__enter__()
        with StageLink(link_to(path)):  # the port was given back
            pass
