"""A reference that is held: it comes to a stop and goes on, smoothly, and loses no sample."""

import numpy as np
import pytest

from ctlblocks import Graph
from ctlblocks.recording import Recording
from stagectl.experiments.piezo.held_reference import HeldReference

RATE, RAMP, SAMPLES = 1_000.0, 0.1, 2_000


def wanted() -> Recording:
    time = np.arange(SAMPLES) / RATE
    wave = np.column_stack([np.sin(2 * np.pi * time), time])
    return Recording(("x", "y"), ("m", "m"), RATE, wave)


def played(frames: int, ticks: int, holds: list[tuple[int, bool]]) -> tuple[HeldReference, np.ndarray]:
    """Play in frames, asked to hold or to go on before those ticks."""
    made, graph = HeldReference(wanted(), RAMP, slice(100, 1_900)), Graph(RATE, frames)
    graph.add("wanted", made)
    graph.prepare()
    rows = []
    for tick in range(ticks):
        for at, on in holds:
            if at == tick:
                made.hold(on)
        graph.tick()
        rows.append(graph.signal("wanted.position").copy())
    return made, np.concatenate(rows)


@pytest.mark.parametrize("frames", [1, 10])
def test_without_a_hold_every_sample_is_played_as_it_is_and_the_last_one_stays(frames: int) -> None:
    made, out = played(frames, 2_100 // frames, [])
    assert np.array_equal(out[:SAMPLES], wanted().data)
    assert np.array_equal(out[SAMPLES:], np.tile(wanted().data[-1], (100, 1)))
    assert made.held == 0


@pytest.mark.parametrize("frames", [1, 10])
def test_a_hold_stops_and_goes_on_without_a_jump_of_pace_and_nothing_is_left_out(frames: int) -> None:
    made, out = played(frames, 2_600 // frames, [(500 // frames, True), (900 // frames, False)])
    pace = np.diff(out[:, 1]) * RATE  # the second channel is time
    assert np.all(pace[:499] == pytest.approx(1.0))
    assert np.all(np.abs(pace[600:899]) < 1e-9)
    assert np.abs(np.diff(pace[:2_390])).max() < np.pi / 2 / (RAMP * RATE) * 1.01  # a raised cosine, nothing steeper
    assert (pace >= -1e-9).all()
    assert made.held == 400
    assert made.is_playing
    assert np.array_equal(out[1_000:2_400], wanted().data[600:])


def test_it_is_not_held_where_it_may_not_be() -> None:
    for first, last in ((0, 90), (1_850, 1_990)):
        made, out = played(1, SAMPLES, [(first, True), (last, False)])
        assert made.held == 0
        assert np.array_equal(out, wanted().data)


def test_a_hold_that_is_taken_back_at_once_comes_to_a_stop_first() -> None:
    made, out = played(1, 1_500, [(500, True), (510, False)])
    assert made.held == 100  # half of either ramp
    assert np.array_equal(out[700:], wanted().data[600:1_400])
    with pytest.raises(ValueError, match="the recording has 1000 samples/s, must be 500"):
        made.prepare(500.0, 1)
