"""Modes that move from shot to shot, on responses that are stretched by known parts."""

import numpy as np
import pytest

from tests.vibractl.learning.line_plant import LinePlant, law_of, matrix_of, modal
from vibractl.config import Adaptation, Watch
from vibractl.learning.algorithm import Algorithm
from vibractl.learning.shot import Shot
from vibractl.learning.stretch import Stretch

FREQUENCY = np.arange(15.0, 650.0, 0.2)
OWN = np.array([45.0, 62.0, 80.0, 130.0, 240.0, 420.0])


def response(moved: float | np.ndarray = 0.0) -> np.ndarray:
    """Return a response (lines, 2, 2), m/s^2 per V, whose modes have moved by a part of their frequency."""
    rng = np.random.default_rng(5)
    at = FREQUENCY / (1 + moved)
    shape = 1j * at[:, None] / (OWN**2 - at[:, None] ** 2 + 0.06j * OWN * at[:, None])
    return np.einsum("lm,moi->loi", shape, rng.standard_normal((len(OWN), 2, 2)))


def followed(rate: float | np.ndarray, shots: int, noise: float = 1e-6) -> tuple[Stretch, np.ndarray, np.ndarray]:
    """Follow a vibrator driven alike in every shot; return what is believed of G, and G, after the last one."""
    rng = np.random.default_rng(1)
    drive = rng.standard_normal((len(FREQUENCY), 2)) + 1j * rng.standard_normal((len(FREQUENCY), 2))
    stretch, believed = Stretch(FREQUENCY, response()), response()
    level = noise * float(np.abs(response()).max())
    for shot in range(1, shots + 1):
        change = response(rate * shot) - response(rate * (shot - 1))
        surprise = (change @ drive[..., None])[..., 0] + level * rng.standard_normal((len(FREQUENCY), 2))
        believed = believed + stretch.observe(drive, surprise, np.full(surprise.shape, level**2))
    return stretch, believed, response(rate * shots)


@pytest.mark.parametrize("rate", [7e-4, -7e-4])
def test_the_rate_is_read_off_and_g_follows(rate: float) -> None:
    stretch, believed, true = followed(rate, 20)
    assert np.median(np.abs(stretch.rate - rate)) < 0.05 * abs(rate)
    left = np.linalg.norm(believed - true) / np.linalg.norm(response() - true)
    assert left < 0.3


def test_bands_may_move_at_their_own_rates() -> None:
    rate = np.where(FREQUENCY < 200, 5e-4, -5e-4)
    stretch, _, _ = followed(rate, 15)
    for band, wanted in ((FREQUENCY < 180, 5e-4), (FREQUENCY > 220, -5e-4)):
        assert np.median(np.abs(stretch.rate[band] - wanted)) < 0.1 * abs(wanted)


def test_what_comes_is_foreseen() -> None:
    stretch, _, true = followed(7e-4, 15)
    coming = response(7e-4 * 16) - true
    assert np.linalg.norm(stretch.coming() - coming) < 0.3 * np.linalg.norm(coming)


def test_a_vibrator_that_stays_is_left_alone() -> None:
    stretch, _, _ = followed(0.0, 15)
    assert np.abs(stretch.rate).max() < 5e-5


class MovingPlant(LinePlant):
    """Its modes move by 3e-3 of their frequency with every shot."""

    made = 0
    start: np.ndarray

    def shot(self, drive: np.ndarray) -> Shot:
        lines = np.arange(len(self.start), dtype=float) + 15.0
        at = lines / (1 + 3e-3 * self.made)
        self.response = np.stack(
            [np.stack([np.interp(at, lines, self.start[:, o, i]) for i in (0, 1)], axis=-1) for o in (0, 1)], axis=1
        )
        self.made += 1
        return super().shot(drive)


def test_a_learning_that_follows_moving_modes_leaves_less_error() -> None:
    true = modal(2, 2)
    left = []
    for follows in (False, True):
        law = law_of(matrix_of(true))
        algorithm = Algorithm(law, Adaptation(stretch=follows), Watch(), -40.0)
        plant = MovingPlant(true, law)
        plant.start = plant.response
        for _ in range(15):
            shot = plant.shot(algorithm.lines)
            algorithm.step(shot)
        left.append(float(np.linalg.norm(law.reference - shot.response)))
    assert left[1] < 0.5 * left[0]
