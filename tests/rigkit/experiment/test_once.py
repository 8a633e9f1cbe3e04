"""Parts that are run once: read when they are whole, made anew when they are not, with what was there kept."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from ctlblocks import Graph, recording
from ctlblocks.recording import Recording
from ctlblocks.replay import Replay
from ctlblocks.taps import Tap
from rigkit.experiment.kept import records_of
from rigkit.experiment.once import Once, PartEnded
from rigkit.experiment.part import Part, Phase, Retreat, Track
from rigkit.experiment.runner import Conduct
from rigkit.run_folder import RunFolder
from rigkit.stop import Stopped

RATE = 100.0


@contextmanager
def ramp(fault: str = "", ticks: int = 50) -> Iterator[Part]:
    graph = Graph(RATE)
    played = Recording(("x",), ("m",), RATE, np.arange(float(ticks))[:, None])
    graph.add("source", Replay(played, {"x": ("x",)}))
    track = Track("ramp", (Tap("x", "source.x"),), frozenset())
    retreat = Retreat(lambda: fault if graph.ticks >= 20 else "", lambda _: None, 5)
    yield Part("ramp", graph, (track,), (Phase("all", ticks),), retreat=retreat)


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[RunFolder]:
    with RunFolder.create(tmp_path / "run", "") as made:
        yield made


def test_a_part_that_came_to_its_end_is_there(folder: RunFolder) -> None:
    once = Once(folder, Conduct())
    assert not once.has("ramp")
    once.run("ramp", ramp())
    assert once.has("ramp")
    assert len(records_of(folder.path)["ramp"].data) == 50


def test_one_that_a_fault_has_ended_is_made_anew_and_kept_aside(folder: RunFolder) -> None:
    once = Once(folder, Conduct())
    with pytest.raises(PartEnded, match=r"ramp: overheated; what is recorded is in .*run/"):
        once.run("ramp", ramp("overheated"))
    assert not once.has("ramp")
    once.run("ramp", ramp())
    assert once.has("ramp")
    assert 20 <= len(records_of(folder.path / "before-1")["ramp"].data) < 50


def test_a_stop_is_told_from_a_fault(folder: RunFolder) -> None:
    over = iter([False] * 3 + [True] * 100)
    once = Once(folder, Conduct(lambda: next(over)))
    with pytest.raises(Stopped, match="ramp: stopped by its user"):
        once.run("ramp", ramp(ticks=500))
    assert not once.has("ramp")
    with pytest.raises(Stopped, match="ramp: stopped before it began"):
        Once(folder, Conduct(lambda: True)).run("ramp", ramp())


def test_a_recording_that_no_event_tells_of_was_written_when_it_was_whole(folder: RunFolder) -> None:
    recording.write(folder.path / "ramp.wav", Recording(("x",), ("m",), RATE, np.ones((3, 1))))
    assert Once(folder, Conduct()).has("ramp")
