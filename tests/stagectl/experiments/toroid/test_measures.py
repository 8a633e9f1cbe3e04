"""A contour whose form is known is measured as such."""

import numpy as np
import pytest

from stagectl.experiments.toroid.measures import STEP, accuracy, contour, profiles

RADIUS = 0.035


def cut(radial: np.ndarray, axial: np.ndarray, centre: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    angle = 0.5 * np.pi + np.linspace(0.0, 2 * np.pi, len(radial))
    size = RADIUS + radial
    return np.column_stack([axial, size * np.cos(angle) + centre[0], size * np.sin(angle) + centre[1]])


def test_a_circle_in_another_place_is_fitted_in_place() -> None:
    none = np.zeros(40_000)
    found = accuracy(contour(cut(none, none, (80e-6, -50e-6)), RADIUS))
    assert found.circle_max < 0.2e-6  # second order: 80 um over 35 mm


def test_a_circle_that_is_too_large_is_not() -> None:
    found = accuracy(contour(cut(np.full(40_000, 20e-6), np.zeros(40_000)), RADIUS))
    assert found.circle_mae == pytest.approx(20e-6, rel=1e-3)
    assert found.circle_std < 1e-8


def test_an_oval_has_the_measures_of_a_sine() -> None:
    angle = np.linspace(0.0, 2 * np.pi, 40_000)
    found = accuracy(contour(cut(30e-6 * np.cos(2 * angle), np.zeros(40_000)), RADIUS))
    assert found.circle_mae == pytest.approx(30e-6 * 2 / np.pi, rel=1e-2)
    assert found.circle_std == pytest.approx(30e-6 / np.sqrt(2), rel=1e-2)
    assert found.circle_max == pytest.approx(30e-6, rel=1e-2)


def test_a_tilted_surface_is_not_rough_and_short_waves_are() -> None:
    way = np.linspace(0.0, 2 * np.pi * RADIUS, 80_000)
    none = np.zeros(80_000)
    tilted = accuracy(contour(cut(none, 1e-3 * way), RADIUS))
    assert tilted.surface_std < 1e-9
    assert tilted.roughness < 0.2e-6  # what the filter does at both ends
    rough = accuracy(contour(cut(none, 5e-6 * np.sin(2 * np.pi * way / 0.5e-3)), RADIUS))
    assert rough.roughness == pytest.approx(5e-6 / np.sqrt(2), rel=0.02)
    assert rough.surface_std == pytest.approx(5e-6 / np.sqrt(2), rel=0.02)


def test_the_surface_is_measured_in_traverses_of_25_mm() -> None:
    none = np.zeros(40_000)
    found = profiles(contour(cut(none, none), RADIUS))
    assert len(found) == 8
    assert {len(each) for each in found} == {round(25e-3 / STEP)}


def test_what_has_not_moved_is_refused() -> None:
    with pytest.raises(ValueError, match="must be >= 0.0001 m"):
        contour(np.tile([0.0, 0.0, RADIUS], (100, 1)), RADIUS)
