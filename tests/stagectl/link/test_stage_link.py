"""The link over a pseudo-terminal to a stage in another thread: through python-can, as to a real adapter."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from firmware_sim.can_node import CanNode
from firmware_sim.stage_processor import Settings
from stagectl.link.bus import LinkError
from stagectl.link.stage_link import StageLink
from stagectl.link.upload import upload
from stagectl.wire.messages import Fault, State
from stagectl.wire.parameters import checksum, pack_parameters
from tests.stagectl.link.stand_in import PATIENT, SILENT, FirstOrderStage, link_to, running
from tests.until import EVER

Rig = tuple[StageLink, CanNode, FirstOrderStage]
SET = {"gains": np.random.default_rng(3).standard_normal((20, 7)), "corner": np.array(80.0, np.float32)}


@pytest.fixture(params=["fd", "classic"])
def rig(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Rig]:
    path = tmp_path / "adapter"
    with running(path, Settings(form=request.param, silence=PATIENT)) as (node, stage):
        with StageLink(link_to(path, form=request.param)) as link:
            yield link, node, stage


def test_the_stage_is_heard(rig: Rig) -> None:
    link, _, _ = rig
    assert (link.state, link.stage_fault, link.reason) == (State.HOLDING, Fault.NONE, "")
    assert link.wait(link.skip() + 20 * link.frames, EVER)


def test_parameters_are_used_once_they_have_come_back_bit_for_bit(rig: Rig) -> None:
    link, node, stage = rig
    assert upload(link, SET) == checksum(pack_parameters(SET)) == node.processor._store.in_use  # noqa: SLF001
    assert {name: value.tobytes() for name, value in stage.parameters.items()} == {
        name: value.tobytes() for name, value in SET.items()
    }


def test_parameters_that_the_loops_refuse_change_nothing(rig: Rig) -> None:
    link, _, stage = rig
    upload(link, SET)
    with pytest.raises(LinkError, match="the stage refuses the parameters at COMMIT: REFUSED"):
        upload(link, {"refused": np.zeros(1)})
    assert set(stage.parameters) == set(SET)


def test_python_cans_own_bus_reaches_the_stage_as_well(tmp_path: Path) -> None:
    path = tmp_path / "adapter"
    with running(path, Settings(others_every=0, silence=PATIENT)):
        with StageLink(link_to(path, bus="can:Bus", options={"interface": "slcan"})) as link:
            assert link.wait(link.skip() + 200, EVER)
            assert link.counts.garbled == 0


@pytest.mark.deadline(SILENT / 2)
def test_a_stage_without_references_stops_by_itself_and_the_link_latches(tmp_path: Path) -> None:
    events: list[str] = []
    with running(tmp_path / "adapter", Settings(silence=SILENT)) as (_, stage):
        link = link_to(tmp_path / "adapter")
        with StageLink(link, lambda event, fields: events.append(f"{event} {dict(fields)}")) as opened:
            opened.start()
            assert not opened.wait(10**9, EVER)
            reason = opened.reason
            assert reason.startswith("the stage reports ")
            with pytest.raises(ValueError, match="must be a person's name"):
                opened.acknowledge(" ")
            assert opened.acknowledge("A. Person") == reason
            assert (opened.reason, opened.stage_fault, stage.cleared) == ("", Fault.NONE, 1)
            with pytest.raises(ValueError, match="is not latched"):
                opened.acknowledge("A. Person")
    assert events == [
        f"link_fault {{'reason': '{reason}'}}",
        f"link_acknowledged {{'by': 'A. Person', 'reason': '{reason}'}}",
    ]


def test_a_port_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(LinkError, match=r"SlcanBus cannot open link.channel '.*adapter' as fd, 1000000 bit/s and"):
        StageLink(link_to(tmp_path / "adapter")).__enter__()


def test_a_bus_without_a_stage_is_said_to_be_silent(tmp_path: Path) -> None:
    link = link_to(tmp_path, bus="can:Bus", channel="alone", options={"interface": "virtual"}, patience=0.1)
    with pytest.raises(LinkError, match="the stage on alone has sent nothing within 0.1 s"):
        StageLink(link).__enter__()


def test_a_class_that_is_none_is_named(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="link.bus, can:Omnibus: module can has no Omnibus"):
        StageLink(link_to(tmp_path, bus="can:Omnibus")).__enter__()


def test_a_bit_rate_that_the_adapter_has_not_is_named(tmp_path: Path) -> None:
    with running(tmp_path / "adapter", Settings()), pytest.raises(LinkError, match="Invalid data bitrate"):
        StageLink(link_to(tmp_path / "adapter", data_bitrate=4_000_000)).__enter__()
