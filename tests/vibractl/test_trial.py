"""A trial plays its drive once and records what comes back, whatever the frames; the graph puts the guard last."""

import numpy as np
import pytest

from ctlblocks.block import Block, Port
from vibractl.config import Limits
from vibractl.guard import Guard
from vibractl.trial import Trial, shot_graph

RATE = 44_100.0


class Counter(Block):
    """A source that counts samples."""

    outputs = (Port("response", "m/s^2", 2),)

    def prepare(self, rate: float, frames: int) -> None:
        self._next = 0

    def process(self, response: np.ndarray) -> None:
        response[:, 0] = np.arange(self._next, self._next + len(response))
        response[:, 1] = -response[:, 0]
        self._next += len(response)


def play(trial: Trial, frames: int, ticks: int) -> np.ndarray:
    """Return what the trial plays while it hears the number of each sample."""
    heard = np.arange(frames * ticks, dtype=float)[:, None] * np.array([1.0, -1.0])
    played = np.full((frames * ticks, 2), np.nan)
    for tick in range(ticks):
        now = slice(tick * frames, (tick + 1) * frames)
        trial.process(heard[now], played[now])
    return played


def drive(samples: int = 100) -> np.ndarray:
    return np.random.default_rng(1).standard_normal((samples, 2))


@pytest.mark.parametrize("frames", [1, 7, 64, 200])
def test_it_plays_the_drive_then_silence_and_records_with_the_margin(frames: int) -> None:
    wanted = drive()
    trial = Trial(wanted, 2, margin=30)
    trial.prepare(RATE, frames)
    played = play(trial, frames, 300 // frames + 1)
    np.testing.assert_array_equal(played[:100], wanted)
    assert not played[100:].any()
    np.testing.assert_array_equal(trial.response[:, 0], np.arange(130))
    np.testing.assert_array_equal(trial.response[:, 1], -np.arange(130))


def test_it_is_done_when_the_margin_is_recorded_and_not_before() -> None:
    trial = Trial(drive(), 2, margin=60)
    trial.prepare(RATE, 64)
    play(trial, 64, 2)
    assert not trial.done
    play(trial, 64, 1)
    assert trial.done


def test_rewound_it_plays_what_a_learner_has_written_meanwhile() -> None:
    trial = Trial(drive(), 2)
    trial.prepare(RATE, 50)
    play(trial, 50, 2)
    trial.drive[:] = 2.0
    assert not play(trial, 50, 2).any()
    trial.rewind()
    assert (play(trial, 50, 2) == 2.0).all()


def test_other_memory_is_silent_until_rewound_and_recorded_into_in_its_own_type() -> None:
    trial = Trial(drive(), 2)
    trial.prepare(RATE, 64)
    response = np.full((80, 2), np.nan, np.float32)
    trial.load(np.ones((70, 2)), response)
    assert trial.done
    assert not play(trial, 64, 1).any()
    assert np.isnan(response).all()
    trial.rewind()
    assert play(trial, 64, 2)[:, 0].sum() == 70
    np.testing.assert_array_equal(response[:, 0], np.arange(80))


def test_parked_in_the_middle_it_plays_and_records_no_more() -> None:
    trial = Trial(np.ones((100, 2)), 2)
    trial.prepare(RATE, 10)
    play(trial, 10, 2)
    trial.park()
    assert not play(trial, 10, 20).any()
    assert not trial.response[20:].any()


@pytest.mark.parametrize(
    ("played", "recorded"), [((10, 3), (10, 2)), ((10, 2), (10, 1)), ((10, 2), (9, 2)), ((10,), (10, 2))]
)
def test_memory_of_another_shape_is_refused(played: tuple[int, ...], recorded: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match=r"must be \(samples, 2\) and \(at least as many, 2\)"):
        Trial(drive(), 2).load(np.zeros(played), np.zeros(recorded))


@pytest.mark.parametrize(("shape", "responses", "margin"), [((10,), 2, 0), ((10, 2), 0, 0), ((10, 2), 2, -1)])
def test_a_trial_without_shape_is_refused(shape: tuple[int, ...], responses: int, margin: int) -> None:
    with pytest.raises(ValueError, match="drive has shape"):
        Trial(np.zeros(shape), responses, margin)


def test_the_shot_graph_goes_from_source_to_guard_and_ends_there() -> None:
    guard = Guard(Limits(), 2)
    trial = Trial(np.full((2000, 2), 0.3), 2)
    graph = shot_graph(Counter(), trial, guard, RATE, 100)
    graph.prepare()
    guard.open()
    outputs = []
    for _ in range(20):
        graph.tick()
        outputs.append(graph.signal("guard.output").copy())
    np.testing.assert_array_equal(trial.response[:, 0], np.arange(2000))
    assert (np.concatenate(outputs)[900:] == 0.3).all()
    graph.add("behind", Guard(Limits(), 2))
    with pytest.raises(ValueError, match=r"guard\.output"):
        graph.connect("guard.output", "behind.request")
