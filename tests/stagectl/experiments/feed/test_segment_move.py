"""The tool's way from segment to segment."""

from typing import Any

import numpy as np
import pytest

from stagectl.experiments.feed.segment_move import SegmentMove
from stagectl.planning.problem import Pocket, milling_types
from stagectl.robot.segment_config import SegmentTask

H = 0.004
POCKET = Pocket(6, 10, 3, "EW", dict.fromkeys(milling_types(3, "EW"), 1.0))
TASK = SegmentTask()


class Way:
    """The block with inputs that a test sets, one sample a call."""

    def __init__(self, **settings: Any) -> None:
        self.block = SegmentMove(SegmentTask(**settings), POCKET)
        self.block.prepare(250.0, 1)
        self.inputs = {port.name: np.zeros((1, port.width)) for port in self.block.inputs}
        self.outputs = {port.name: np.zeros((1, port.width)) for port in self.block.outputs}

    def set(self, **values: Any) -> None:
        for name, value in values.items():
            self.inputs[name][:] = value

    def run(self, seconds: float) -> np.ndarray:
        """Go on; return the places, shape (samples, 3), m."""
        return np.array([self.tick() for _ in range(round(seconds / H))])

    def tick(self) -> np.ndarray:
        self.block.process(*self.inputs.values(), *self.outputs.values())
        return self.outputs["place"][0].copy()

    def of(self, name: str) -> float:
        return float(self.outputs[name][0, 0])

    def until(self, name: str, most: float = 10.0) -> np.ndarray:
        """Go on until an output is 1; return the places on the way."""
        found = []
        for _ in range(round(most / H)):
            found.append(self.tick())
            if self.of(name) > 0.5:
                return np.array(found)
        raise AssertionError(f"{name} never came")


def first(way: Way) -> np.ndarray:
    """Begin with an eastward slot off the north."""
    way.set(number=1.0, start=(0, 0), stop=(0, 7), lift=0.0, feed=0.02)
    return way.until("is_running")


def test_the_first_segment_is_reached_from_above_and_begun_at_its_start() -> None:
    places = first(Way())
    np.testing.assert_allclose(places[0], [10e-3, -6e-3, 8e-3])
    np.testing.assert_allclose(places[-1], [3e-3, -3e-3, 0.0], atol=1e-12)
    across = np.abs(np.diff(places[:, 0])) > 0.0
    assert (places[1:, 2][across] == 8e-3).all()


def test_no_way_is_quicker_than_it_may_be_and_none_jumps() -> None:
    places = first(Way())
    speed = np.linalg.norm(np.diff(places, axis=0), axis=1) / H
    assert speed.max() <= TASK.travel * 1.001
    assert np.abs(np.diff(places[:, 2])).max() / H <= TASK.plunge * 1.001
    assert np.abs(np.diff(speed)).max() / H <= 2.0 * TASK.acceleration


def test_a_segment_goes_at_its_feed_brakes_and_ends_where_it_should() -> None:
    way = Way()
    first(way)
    places = way.until("is_finished")
    feed = np.diff(places[:, 0]) / H
    assert feed[10:100].max() == pytest.approx(0.02, rel=1e-6)
    np.testing.assert_allclose(places[-1], [17e-3, -3e-3, 0.0], atol=1e-9)
    assert way.of("duration") == pytest.approx(14e-3 / 0.02, abs=0.1)
    way.tick()
    assert way.of("is_finished") == 0.0
    assert way.of("is_running") == 0.0


def test_a_strip_beside_it_is_stepped_to_and_milled_the_other_way() -> None:
    way = Way()
    first(way)
    way.until("is_finished")
    way.set(number=2.0, start=(3, 7), stop=(3, 0))
    places = way.until("is_running")
    assert (places[:, 2] == 0.0).all()
    np.testing.assert_allclose(places[-1], [17e-3, -9e-3, 0.0], atol=1e-12)
    np.testing.assert_allclose(way.outputs["direction"][0], [-1.0, 0.0])
    assert np.linalg.norm(np.diff(places, axis=0), axis=1).max() / H <= TASK.step * 1.001


def test_a_lift_goes_over_the_wood() -> None:
    way = Way()
    first(way)
    way.until("is_finished")
    way.set(number=2.0, start=(3, 0), stop=(3, 7), lift=1.0)
    places = way.until("is_running")
    assert places[:, 2].max() == pytest.approx(8e-3)


def test_a_retreat_goes_back_along_the_segment_and_not_past_its_start() -> None:
    way = Way()
    first(way)
    way.run(0.2)
    way.set(feed=-0.02)
    places = way.run(1.0)
    assert (np.diff(places[:, 0]) <= 0.0).all()
    np.testing.assert_allclose(places[-1], [3e-3, -3e-3, 0.0], atol=1e-12)


def test_nothing_moves_while_it_is_held() -> None:
    way = Way()
    first(way)
    way.set(holding=1.0)
    places = way.run(0.2)
    assert (places == places[0]).all()


def test_the_force_is_noted_where_it_is_stationary() -> None:
    way = Way(stationary=0.1)
    first(way)
    rng, heard = np.random.default_rng(1), []
    for n in range(10_000):
        way.set(resultant=10.0 + rng.standard_normal(), phase=3.0 if n >= 20 else 2.0)
        way.tick()
        if n > 20 + 0.1 / H - 2:
            heard.append(way.inputs["resultant"][0, 0])
        if way.of("is_finished") > 0.5:
            break
    assert way.of("force_deviation") == pytest.approx(np.std(heard[1:], ddof=1), rel=0.05)


def test_after_the_last_segment_it_goes_home_and_rests() -> None:
    way = Way()
    first(way)
    way.until("is_finished")
    way.set(number=0.0, start=0.0, stop=0.0)
    assert way.of("is_resting") == 0.0
    places = way.until("is_resting")
    np.testing.assert_allclose(places[-1], [10e-3, -6e-3, 8e-3], atol=1e-12)
    assert way.block.is_at_rest
