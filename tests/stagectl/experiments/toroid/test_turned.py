"""By how much a workpiece has turned, out of a tracker's noise."""

import numpy as np
import pytest

from stagectl.experiments.toroid.turned import turned

RATE = 440.0


def orientations(turn: np.ndarray, noise: float) -> np.ndarray:
    rng = np.random.default_rng(1)
    small = np.column_stack([np.ones(len(turn)), turn / 2, np.zeros((len(turn), 2))])
    small[:, 1:] += noise / 2 * rng.standard_normal((len(turn), 3))
    return small / np.linalg.norm(small, axis=1, keepdims=True) * rng.choice([-1.0, 1.0], (len(turn), 1))


def test_the_turn_is_that_of_means() -> None:
    turn = np.concatenate([np.zeros(880), np.full(440, 5e-4), np.full(440, -9e-4)])
    seen = orientations(turn, 1e-4)
    assert turned(seen, RATE, (0.5, 1.9), (2.0, 4.0)) == pytest.approx(np.sqrt(np.mean(turn[880:] ** 2)), rel=0.03)


def test_where_nothing_was_seen_there_is_no_turn() -> None:
    assert np.isnan(turned(np.zeros((2_000, 4)), RATE, (0.5, 1.9), (2.0, 4.0)))
