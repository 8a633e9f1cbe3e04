"""What the robot holds is turned back to how it was touched off, and not while held."""

import numpy as np
import pytest

from stagectl.robot.kept_orientation import KeptOrientation

RATE = 250.0
TOUCHED = 0.2, 0.8
NOISE = np.array([70e-6, 140e-6, 70e-6])
"""rad, of a tracker's sample."""


class Held:
    """A robot of first order with a delay that holds a workpiece, and what is seen of it."""

    def __init__(self, seconds: float = 1.0, lag: float = 0.1, delay: int = 10, noise: float = 0.0) -> None:
        self.block = KeptOrientation(seconds, *TOUCHED)
        self.block.prepare(RATE, 1)
        self._pole, self._noise = np.exp(-1.0 / (lag * RATE)), noise * NOISE
        self._asked, self._robot = [np.zeros(3)] * delay, np.zeros(3)
        self._rng = np.random.default_rng(3)
        self.nominal = np.array([0.6, -0.5, 0.4, np.sqrt(1 - 0.77)])
        self.sign = 1.0

    def go(self, pushed: np.ndarray, holding: np.ndarray | None = None) -> np.ndarray:
        """Return how far it is turned, (samples, 3), rad, where something pushes it round by `pushed`."""
        turned, rotation = np.empty_like(pushed), np.empty((1, 3))
        holding = np.zeros(len(pushed)) if holding is None else holding
        for n, push in enumerate(pushed):
            self._robot = self._pole * self._robot + (1 - self._pole) * self._asked[0]
            turned[n] = push + self._robot
            seen = turned[n] + self._noise * self._rng.standard_normal(3)
            orientation = self.sign * product(np.array([1.0, *(seen / 2)]), self.nominal)[None]
            self.block.process(orientation, holding[n : n + 1, None], rotation)
            self._asked = [*self._asked[1:], rotation[0].copy()]
        return turned


def product(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    vector = p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:])
    return np.array([p[0] * q[0] - p[1:] @ q[1:], *vector])


def step(size: float, axis: int, seconds: float = 12.0, at: float = 1.0) -> np.ndarray:
    pushed = np.zeros((round(seconds * RATE), 3))
    pushed[round(at * RATE) :, axis] = size
    return pushed


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_turn_is_taken_back_about_its_own_axis(axis: int, sign: float) -> None:
    """A quaternion and its negative are the same orientation."""
    held = Held()
    held.sign = sign
    turned = held.go(step(1e-3, axis))
    np.testing.assert_allclose(turned[round(1.1 * RATE), axis], 1e-3, rtol=0.1)
    assert np.abs(turned[-1]).max() < 2e-6
    others = np.delete(turned, axis, axis=1)
    assert np.abs(others).max() < 5e-6
    assert turned[:, axis].min() > -0.05e-3  # it does not ring


@pytest.mark.parametrize(("lag", "delay"), [(0.3, 10), (0.1, 50), (0.2, 40)])
def test_a_robot_three_times_as_slow_or_with_a_fifth_of_a_second_of_dead_time_is_stable(lag: float, delay: int) -> None:
    turned = Held(lag=lag, delay=delay).go(step(1e-3, 0, 20.0))
    assert np.abs(turned[-250:]).max() < 10e-6


def test_noise_of_the_tracker_hardly_moves_the_robot() -> None:
    turned = Held(noise=1.0).go(np.zeros((10_000, 3)))
    assert 0.0 < turned[2_000:].std(axis=0).max() < 0.15 * NOISE.max()


def test_it_stands_still_while_the_robot_is_held() -> None:
    held, pushed = Held(), step(1e-3, 1, 4.0)
    holding = np.ones(len(pushed))
    assert (held.go(pushed, holding) == pushed).all()


def test_what_was_never_seen_is_not_turned() -> None:
    block = KeptOrientation(1.0, *TOUCHED)
    block.prepare(RATE, 1)
    rotation = np.empty((1_000, 3))
    block.process(np.zeros((1_000, 4)), np.zeros((1_000, 1)), rotation)
    assert (rotation == 0.0).all()


def test_without_a_time_constant_it_never_turns() -> None:
    pushed = step(1e-3, 0, 3.0)
    assert (Held(seconds=0.0).go(pushed) == pushed).all()
