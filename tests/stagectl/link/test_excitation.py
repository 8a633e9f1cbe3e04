"""An axis excited through a pseudo-terminal: what is played comes back sample for sample, or is not used."""

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from firmware_sim.can_node import CanNode
from firmware_sim.stage_processor import Settings
from rigkit.stop import Stopped
from stagectl.link.excitation import SamplesLost, excited
from stagectl.link.stage_link import LinkFault, StageLink
from stagectl.wire import messages
from stagectl.wire.messages import Drive, State
from stagectl.wire.samples import rounded
from tests.stagectl.link.stand_in import PATIENT, FirstOrderStage, link_to, running

Rig = tuple[StageLink, CanNode, FirstOrderStage]
TOLD = r"stood still: (\d+) samples found no room on their way to the stage"
WAVE = rounded(messages.VOLTAGE_DRIVE, 20.0 * np.sin(2 * np.pi * 40.0 * np.arange(1995) / 10_000))


@pytest.fixture
def rig(tmp_path: Path) -> Iterator[Rig]:
    with running(tmp_path / "adapter", Settings(silence=PATIENT, ramp=0.02, pace="host")) as (node, stage):
        with StageLink(link_to(tmp_path / "adapter")) as link:
            yield link, node, stage


def play(link: StageLink, lead: float = 0.1) -> np.ndarray:
    """Play the wave on y and return the voltage heard, shape (samples, 3), V; once more where samples were lost."""
    for _ in range(3):
        try:
            return excited(link, Drive.VOLTAGE, 1, WAVE, lead, lambda: False).voltage
        except SamplesLost:
            continue
    raise AssertionError("samples were lost three times")


def test_what_is_played_is_heard_in_the_same_samples(rig: Rig) -> None:
    link, _, stage = rig
    voltage = play(link)
    np.testing.assert_allclose(voltage[:, 1], WAVE, atol=1e-9)
    assert not voltage[:, [0, 2]].any()
    assert stage.excited in (1, None)
    play(link)  # it waits until the stage holds again


def test_a_fault_ends_it_and_it_is_not_used(rig: Rig) -> None:
    link, node, _ = rig
    with pytest.raises(LinkFault, match="the adapter"):
        excited(link, Drive.VOLTAGE, 1, np.zeros(20_000), 0.1, lambda: bool(node.suffer("unplug")))
    assert link.reason


def test_it_ends_when_it_is_asked_to_and_the_stage_goes_to_rest(rig: Rig) -> None:
    link, _, _ = rig
    with pytest.raises(Stopped):
        excited(link, Drive.VOLTAGE, 1, WAVE, 0.1, lambda: True)
    assert link.reason == ""
    assert link.state in (State.EXCITED, State.RAMPING, State.HOLDING)


def test_lost_samples_are_told(rig: Rig) -> None:
    link, node, _ = rig
    send, count = node.adapter.send, 0

    def lossy(frame: object) -> None:
        nonlocal count
        if getattr(frame, "identifier", 0) == messages.EXTENSION.identifier:
            count += 1
            if count == 800:
                return
        send(frame)  # type: ignore[arg-type]

    node.adapter.send = lossy  # type: ignore[method-assign]
    told = ""
    while "blocks of extension" not in told:  # but that a machine stood still, which is other ways to lose them
        count = 0
        with pytest.raises(SamplesLost) as lost:
            excited(link, Drive.VOLTAGE, 1, np.zeros(10_000), 0.1, lambda: False)
        told = str(lost.value)
    assert "of the stage's blocks of extension, 1 were lost" in told


def test_samples_that_found_no_room_on_their_way_are_told(rig: Rig) -> None:
    """As where the thread that sends stood still: all that follow are played too early.

    At least the 5 000 less the room there is; where the machine stands still too, so many more.
    """
    link, _, _ = rig
    ticks = iter(range(10_000))

    def too_many() -> bool:
        if next(ticks) == 300:
            link.references.put(np.zeros((5_000, 3)))
        return False

    with pytest.raises(SamplesLost, match=TOLD) as lost:
        excited(link, Drive.VOLTAGE, 1, np.zeros(10_000), 0.1, too_many)
    (count,) = re.findall(TOLD, str(lost.value))
    assert int(count) >= 3_000


def test_a_bus_that_is_too_slow_is_refused(rig: Rig) -> None:
    link, _, _ = rig
    link.link = link.link.model_copy(update={"bitrate": 500_000, "data_bitrate": 2_000_000})
    with pytest.raises(ValueError, match=r"would be busy for \d+ % of the time while an axis is excited"):
        excited(link, Drive.VOLTAGE, 1, WAVE, 0.1, lambda: False)
