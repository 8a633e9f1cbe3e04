"""Drives that a reference needs, against the learner's and the guard's own view of them."""

from dataclasses import replace

import numpy as np
import pytest

from tests.vibractl.linear_rig import linear_config, linear_matrix
from vibractl.predict.drive import DriveNeeds, drive_needs
from vibractl.setup import Setup, setup


def made_with(*overrides: str, deviation: float = 1e-3) -> Setup:
    matrix = linear_matrix()
    matrix = replace(matrix, variance=deviation**2 * np.abs(matrix.response) ** 2)
    return setup(linear_config(*overrides), matrix)


def needs(made: Setup) -> DriveNeeds:
    return drive_needs(made, made.law.start[None])


def test_what_is_needed_is_what_the_learner_plays() -> None:
    made = made_with()
    drive, found = made.learner().drive, needs(made)
    np.testing.assert_allclose(found.needed[:, 0], np.abs(drive).max(axis=0))
    np.testing.assert_allclose(found.needed[:, 2], np.abs(np.diff(drive, axis=0)).max(axis=0) * 44_100, rtol=1e-6)
    np.testing.assert_allclose(found.learned, found.needed)


def test_the_first_drive_of_the_thesis_is_another_one() -> None:
    found = needs(made_with("learning.start=reference"))
    assert not np.allclose(found.first, found.needed, rtol=0.05)


def test_the_rms_is_the_guards_own() -> None:
    found = needs(made_with())
    largest = found.needed[:, 1].max()
    assert "" == needs(made_with(f"limits.rms={1.01 * largest}")).violation
    assert "limits.rms" in needs(made_with(f"limits.rms={0.99 * largest}")).violation


def test_the_range_is_as_wide_as_the_model_is_uncertain() -> None:
    sure, unsure = needs(made_with()), needs(made_with(deviation=0.2))
    assert np.all(unsure.high - unsure.low > 1.5 * (sure.high - sure.low))
    assert np.all(sure.low < sure.high)


def test_head_room_is_under_the_largest_drive_expected() -> None:
    made = made_with("limits.peak=5")
    found = needs(made)
    largest = max(found.needed[0, 0], found.high[0, 0])
    assert found.headroom(made.config.limits)[0, 0] == pytest.approx(20 * np.log10(5 / largest))


def test_one_sides_coil_leaves_the_other_silent() -> None:
    made = made_with("learning.side=1")
    found = needs(made)
    assert np.all(found.needed[0] > 0)
    assert np.all(found.needed[1] == 0)
    assert np.all(np.isinf(found.headroom(made.config.limits)) == [[False], [True]])
