"""Recordings into a graph and out of it."""

import numpy as np
import pytest

from ctlblocks import Graph, Port
from ctlblocks.clock import run_offline
from ctlblocks.recording import Recording, RecordingError
from ctlblocks.replay import Record, Replay

DATA = np.random.default_rng(5).standard_normal((100, 3))
RECORDING = Recording(("drive", "left", "right"), ("V", "m/s^2", "m/s^2"), 1000.0, DATA, {"shot": "7"})
PORTS = {"response": ("right", "left"), "drive": ("drive",)}


def copied(recording: Recording, ticks: int, frames: int, capacity: int) -> tuple[Replay, Record]:
    """Replay a recording into another one."""
    replay, record = Replay(recording, PORTS), Record([Port("response", "m/s^2", 2), Port("drive", "V")], capacity)
    graph = Graph(1000.0, frames)
    graph.add("replay", replay)
    graph.add("record", record)
    graph.connect("replay.response", "record.response")
    graph.connect("replay.drive", "record.drive")
    graph.prepare()
    run_offline(graph, ticks)
    return replay, record


def test_a_replay_has_the_ports_units_and_widths_of_its_channels() -> None:
    assert Replay(RECORDING, PORTS).outputs == (Port("response", "m/s^2", 2), Port("drive", "V", 1))


@pytest.mark.parametrize(("frames", "ticks"), [(1, 100), (10, 10), (100, 1)])
@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_what_is_replayed_is_recorded_bit_for_bit(dtype: str, frames: int, ticks: int) -> None:
    recording = Recording(RECORDING.names, RECORDING.units, 1000.0, DATA.astype(dtype))
    replay, record = copied(recording, ticks, frames, 100)
    again = record.recording({"from": "test"})
    assert again.names == ("response_1", "response_2", "drive")
    assert again.units == ("m/s^2", "m/s^2", "V")
    assert (again.rate, again.provenance) == (1000.0, {"from": "test"})
    assert np.array_equal(again.data, DATA.astype(dtype)[:, [2, 1, 0]])
    assert replay.exhausted
    assert record.overrun == 0


def test_past_its_end_a_replay_is_silent_and_says_so() -> None:
    replay, record = copied(RECORDING, 9, 11, 200)
    assert not replay.exhausted
    assert replay.position == 99
    replay, record = copied(RECORDING, 12, 11, 200)
    assert replay.exhausted
    data = record.recording().data
    assert np.array_equal(data[:100], DATA[:, [2, 1, 0]])
    assert len(data) == 132
    assert not data[100:].any()


def test_past_its_capacity_a_record_counts_and_keeps_what_it_has() -> None:
    _, record = copied(RECORDING, 10, 10, 42)
    assert record.overrun == 58
    assert np.array_equal(record.recording().data, DATA[:42, [2, 1, 0]])


def test_a_recording_taken_is_not_changed_by_what_comes_later() -> None:
    _, record = copied(RECORDING, 5, 10, 100)
    taken = record.recording()
    record.process(np.ones((10, 2)), np.ones((10, 1)))
    record.prepare(1000.0, 10)
    record.process(np.ones((10, 2)), np.ones((10, 1)))
    assert np.array_equal(taken.data, DATA[:50, [2, 1, 0]])
    assert record.recording().data.tolist() == np.ones((10, 3)).tolist()


def test_a_replay_at_another_rate_is_refused_with_both() -> None:
    graph = Graph(44_100.0)
    graph.add("replay", Replay(RECORDING, PORTS))
    with pytest.raises(ValueError, match="the recording has 1000 samples/s, must be 44100 to be replayed here"):
        graph.prepare()


def test_channels_that_are_not_there_or_differ_in_unit_are_refused() -> None:
    with pytest.raises(RecordingError, match="no channel 'force'; there are drive, left, right"):
        Replay(RECORDING, {"response": ["force"]})
    with pytest.raises(ValueError, match=r"port mixed: channels \('drive', 'left'\) have units \('V', 'm/s\^2'\)"):
        Replay(RECORDING, {"mixed": ["drive", "left"]})


def test_a_record_of_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="0 ports and room for 5 samples, must be >= 1 each"):
        Record([], 5)
    with pytest.raises(ValueError, match="1 ports and room for 0 samples"):
        Record([Port("a")], 0)
    with pytest.raises(RecordingError, match=r"data is float64 \(0, 1\)"):
        Record([Port("a")], 5).recording()
