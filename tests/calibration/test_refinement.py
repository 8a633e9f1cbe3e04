import numpy as np
import pytest

from calibration.refinement import interpolation_error, memory, refined
from vibractl.transfer_matrix import TransferMatrix

GRID = np.arange(100.0, 201.0)


def resonance(frequency: np.ndarray, centre: float, damping: float) -> np.ndarray:
    response = 1 / (1 - (frequency / centre) ** 2 + 2j * damping * frequency / centre)
    return np.asarray(response[:, None, None] * np.array([[1.0, 0.3], [0.2, 1.0]]))


def test_lines_are_added_around_a_sharp_peak_and_nowhere_else() -> None:
    grid = refined(GRID, resonance(GRID, 150.0, 0.005), 0.004, 0.25)
    spacing = np.diff(grid)
    middle = (grid[:-1] + grid[1:]) / 2
    assert spacing.min() == pytest.approx(0.25)
    assert np.all(spacing[np.abs(middle - 150) > 12] == 1.0)
    assert np.all(spacing[np.abs(middle - 150) < 1] == pytest.approx(0.25))
    assert np.isin(GRID, grid).all()


def test_lines_are_added_around_a_notch() -> None:
    absorber = 1 - 0.0095j * resonance(GRID, 150.0, 0.005)
    assert np.abs(absorber[50, 0, 0]) < 0.1
    grid = refined(GRID, absorber, 0.004, 0.25)
    assert np.diff(grid)[np.abs(grid[:-1] - 150) < 1].max() < 0.6
    assert np.all(np.diff(grid)[np.abs(grid[:-1] - 150) > 12] == 1.0)


def test_the_refined_grid_interpolates_to_the_tolerance_or_nearly_so() -> None:
    """Makima's order is lower at a few lines, hence the factor."""
    grid = refined(GRID, resonance(GRID, 150.3, 0.01), 0.004, 0.1)
    fine = np.arange(100, 200, 0.05)
    zero = np.zeros((len(grid), 2, 2))
    found = TransferMatrix(grid, resonance(grid, 150.3, 0.01), zero, zero).at(fine).response
    truth = resonance(fine, 150.3, 0.01)
    missed = np.linalg.norm(found - truth, 2, axis=(1, 2)) / np.linalg.norm(truth, 2, axis=(1, 2))
    assert missed.max() < 1.5 * 0.004


def test_the_predicted_error_is_that_of_the_grid_within_a_factor_of_three() -> None:
    predicted = interpolation_error(GRID, resonance(GRID, 150.3, 0.01)).max()
    middle = GRID[:-1] + 0.5
    zero = np.zeros((len(GRID), 2, 2))
    found = TransferMatrix(GRID, resonance(GRID, 150.3, 0.01), zero, zero).at(middle).response
    truth = resonance(middle, 150.3, 0.01)
    missed = np.linalg.norm(found - truth, 2, axis=(1, 2)) / np.linalg.norm(truth, 2, axis=(1, 2))
    assert predicted / 3 < missed.max() < predicted * 3


def test_no_interval_becomes_smaller_than_the_finest() -> None:
    grid = refined(GRID, resonance(GRID, 150.0, 0.001), 1e-6, 0.3)
    assert np.diff(grid).min() == pytest.approx(0.5)


def test_the_memory_at_a_resonance_is_its_time_constant() -> None:
    fine = np.arange(100.0, 200.0, 0.05)
    seconds = memory(fine, resonance(fine, 150.0, 0.01))
    assert seconds.max() == pytest.approx(1 / (0.01 * 2 * np.pi * 150), rel=0.02)
    assert seconds[0] < 0.1 * seconds.max()
