"""Chirps: what they sweep, and that they begin and end at rest."""

import numpy as np

from calibration.stage_axes.chirp import Chirp


def test_it_rests_then_sweeps_from_start_to_stop() -> None:
    chirp = Chirp(1000.0, 1.0, 10.0, 2.0, 100.0, 3.0)
    drive = chirp.drive()
    assert drive.shape == (chirp.samples, 1) == (11_000, 1)
    assert not drive[: chirp.rest].any()
    assert abs(drive[-1, 0]) < 1e-2
    crossings = np.flatnonzero(np.diff(np.signbit(drive[chirp.rest :, 0])))
    early, late = (np.sum((crossings >= first) & (crossings < first + 1000)) / 2 for first in (1000, 8000))
    assert abs(early - (2 + 98 * 0.15)) < 1
    assert abs(late - (2 + 98 * 0.85)) < 1


def test_the_falling_one_ends_at_its_stop() -> None:
    drive = Chirp(1000.0, 0.0, 10.0, 100.0, 2.0, 1.0).drive()[:, 0]
    crossings = np.flatnonzero(np.diff(np.signbit(drive)))
    assert np.sum(crossings < 2000) > 8 * np.sum(crossings >= 8000) / 2


def test_it_is_as_loud_as_it_is_told() -> None:
    assert 0.999 * 15.0 < np.abs(Chirp(1000.0, 0.5, 10.0, 1.0, 50.0, 15.0).drive()).max() <= 15.0
