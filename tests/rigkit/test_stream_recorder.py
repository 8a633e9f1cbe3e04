"""A recorder beside a graph: a slow or failing disk costs samples that are counted and told, and nothing else."""

from collections.abc import Callable, Mapping
from pathlib import Path
from threading import Event
from typing import Any

import numpy as np
import pytest

from ctlblocks import Graph, Port, recording
from ctlblocks.recording import Recording
from ctlblocks.replay import Replay
from rigkit import disk_space, stream_recorder, stream_writer
from rigkit.growing_wav import GrowingWav
from rigkit.stream_recorder import StreamRecorder
from rigkit.stream_writer import Stream
from tests.rigkit.failing_calls import every_fault
from tests.rigkit.killed_stream import FRAMES, RATE, check, ramp

PORTS = (Port("a", "V"), Port("b", "m"))


class Told:
    """Keeps events."""

    def __init__(self) -> None:
        self.events: list[tuple[str, Mapping[str, Any]]] = []

    def __call__(self, event: str, fields: Mapping[str, Any]) -> None:
        self.events.append((event, fields))

    @property
    def names(self) -> list[str]:
        return [event for event, _ in self.events]


def prepared(path: Path, tell: Callable[..., object], **options: Any) -> StreamRecorder:
    recorder = StreamRecorder(Stream(path, PORTS, ("a", "b"), {"rig": "x"}, **options), tell)
    recorder.prepare(RATE, FRAMES)
    return recorder


def offer(recorder: StreamRecorder, first: int, blocks: int) -> None:
    for block in range(blocks):
        data = ramp(first + block * FRAMES, FRAMES)
        recorder.process(data[:, :1], data[:, 1:])


def wait_until(met: Callable[[], bool]) -> None:
    for _ in range(100_000):
        if met():
            return
        Event().wait(1e-3)
    raise AssertionError("it never comes")


@pytest.fixture(autouse=True)
def _quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stream_recorder, "PERIOD", 1e-3)
    monkeypatch.setattr(stream_writer, "RETRY", 0.0)


def test_a_graph_is_recorded_bit_for_bit(tmp_path: Path) -> None:
    noise = Recording(("left", "right"), ("V", "V"), 8_000, np.random.default_rng(2).normal(size=(4_096, 2)))
    recorder = StreamRecorder(Stream(tmp_path / "x.wav", (Port("in_", "V", 2),), ("left", "right")), Told())
    graph = Graph(8_000, 64)
    graph.add("play", Replay(noise, {"out": noise.names}))
    graph.add("record", recorder)
    graph.connect("play.out", "record.in_")
    graph.prepare()
    with recorder:
        for _ in range(64):
            graph.tick()
    read = recording.read(tmp_path / "x.wav", rate=8_000, names=noise.names)
    assert read.data.tobytes() == noise.data.tobytes()
    assert (recorder.recorded, recorder.lost, recorder.files) == (4_096, 0, [tmp_path / "x.wav"])
    assert read.provenance["first_sample"] == "0"


def test_what_flows_by_while_it_is_off_is_not_recorded_and_the_file_says_with_which_sample_it_begins(
    tmp_path: Path,
) -> None:
    recorder = prepared(tmp_path / "x.wav", told := Told())
    offer(recorder, 0, 3)
    with recorder:
        offer(recorder, 3 * FRAMES, 2)
    offer(recorder, 5 * FRAMES, 4)
    with recorder:
        offer(recorder, 9 * FRAMES, 1)
    assert check(tmp_path) == 3 * FRAMES
    assert [path.name for path in recorder.files] == ["x.wav", "x-0001.wav"]
    assert recording.read(tmp_path / "x-0001.wav").provenance["first_sample"] == str(9 * FRAMES)
    assert (recorder.lost, told.events) == (0, [])


def test_a_long_stream_goes_on_in_a_further_file(tmp_path: Path) -> None:
    recorder = prepared(tmp_path / "x.wav", told := Told(), longest=2_000)
    with recorder:
        for block in range(20):
            offer(recorder, block * FRAMES, 1)
            wait_until(lambda block=block: recorder.recorded == (block + 1) * FRAMES)  # type: ignore[misc]
    assert check(tmp_path) == 20 * FRAMES
    assert len(recorder.files) > 5
    assert all(path.stat().st_size <= 2_000 for path in recorder.files)
    assert told.events == []


def test_a_disk_that_stalls_holds_up_nobody_and_what_is_lost_is_counted_and_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stalled, append = Event(), GrowingWav.append

    def wait(file: GrowingWav, samples: np.ndarray) -> None:
        stalled.wait()
        append(file, samples)

    monkeypatch.setattr(GrowingWav, "append", wait)
    recorder = prepared(tmp_path / "x.wav", told := Told(), room=0.1)
    with recorder:
        offer(recorder, 0, 1)
        wait_until(lambda: not recorder._ring)  # noqa: SLF001 (the writer has it and stalls)
        offer(recorder, FRAMES, 100)
        assert recorder.lost == 101 * FRAMES - 1_000 - FRAMES
        stalled.set()
        wait_until(lambda: recorder.recorded == 1_000 + FRAMES)
        offer(recorder, 101 * FRAMES, 2)
    assert recorder.recorded == check(tmp_path) == 103 * FRAMES - recorder.lost
    assert [path.name for path in recorder.files] == ["x.wav", "x-0001.wav"]
    assert recording.read(recorder.files[1]).provenance["first_sample"] == str(101 * FRAMES)
    assert told.events == [("recording_gap", {"recording": "x.wav", "lost": recorder.lost})]


def test_a_disk_that_is_nearly_full_is_left_alone_until_there_is_room(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(stream_writer, "SYNCHRONISED", 0.0)
    recorder, reserve = prepared(tmp_path / "x.wav", told := Told()), disk_space.RESERVE
    with recorder:
        offer(recorder, 0, 1)
        wait_until(lambda: recorder.recorded == FRAMES)
        monkeypatch.setattr(disk_space, "RESERVE", 2**80)
        offer(recorder, FRAMES, 1)
        wait_until(lambda: recorder.fault.startswith("No space left on device: "))
        monkeypatch.setattr(disk_space, "RESERVE", reserve)
        offer(recorder, 2 * FRAMES, 1)
    assert told.names == ["recording_failed", "recording_resumed"]
    assert (recorder.recorded, recorder.lost, recorder.fault) == (2 * FRAMES, FRAMES, "")
    assert check(tmp_path) == 2 * FRAMES


def test_a_place_that_cannot_be_written_is_refused_before_anything_is_recorded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(FileNotFoundError, match=r"missing"):
        prepared(tmp_path / "missing" / "x.wav", Told()).__enter__()
    monkeypatch.setattr(disk_space, "RESERVE", 2**80)
    with pytest.raises(OSError, match="No space left on device"):
        prepared(tmp_path / "x.wav", Told()).__enter__()
    assert list(tmp_path.iterdir()) == []


def test_channels_that_do_not_fit_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"x\.wav: 1 names, must be 2"):
        Stream(tmp_path / "x.wav", PORTS, ("a",))
    with pytest.raises(ValueError, match=r"x\.wav: longest is 5000000000 bytes, must be <= 42948"):
        prepared(tmp_path / "x.wav", Told(), longest=5_000_000_000)
    recorder = StreamRecorder(Stream(tmp_path / "x.wav", PORTS, ("a", "b")), Told())
    with pytest.raises(ValueError, match="at 440.5 samples/s, must be"):
        recorder.prepare(440.5, FRAMES)
    with (recorder := prepared(tmp_path / "x.wav", Told())), pytest.raises(ValueError, match="is being recorded"):
        recorder.prepare(RATE, FRAMES)


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_a_slip_of_the_program_in_the_writer_is_told_as_well(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(GrowingWav, "append", lambda *_: 1 / 0)
    recorder = prepared(tmp_path / "x.wav", told := Told())
    with recorder:
        offer(recorder, 0, 1)
        wait_until(lambda: recorder.fault == "ZeroDivisionError: division by zero")
    assert told.names == ["recording_failed"]


def test_whichever_call_fails_every_sample_is_on_the_disk_or_counted_as_lost(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[tuple[StreamRecorder, Told]] = []

    def work(folder: Path) -> None:
        told = Told()
        made.append((prepared(folder / "x.wav", told, longest=2_000), told))
        with made[-1][0] as recorder:
            for block in range(4):
                offer(recorder, block * FRAMES, 1)
                wait_until(lambda: recorder.recorded + recorder.lost == recorder._seen)  # noqa: SLF001

    unsound, resumed = 0, 0
    for folder, fault in every_fault(work, tmp_path, monkeypatch):
        recorder, told = made[-1]
        kept = check(folder)
        if fault is not None:
            unsound += 1
            assert kept == 0  # it has not begun
            continue
        assert kept == recorder.recorded == 4 * FRAMES - recorder.lost
        assert recorder.lost == 0 or "recording_failed" in told.names
        resumed += "recording_resumed" in told.names
    assert unsound >= 3
    assert resumed >= 20
