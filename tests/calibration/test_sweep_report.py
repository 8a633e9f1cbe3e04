"""The transfer matrix drawn, with a few channels and with many."""

import warnings

import numpy as np
import pytest

from calibration.sweep_report import bode_figure, certainty_figure
from rigkit.figure_style import styled
from rigkit.report import lay_out
from vibractl.transfer_matrix import TransferMatrix


def matrix(sides: int) -> TransferMatrix:
    """Return a matrix in which each output answers the drive after its own the most."""
    frequency = np.linspace(15, 650, 40)
    response = np.broadcast_to(np.roll(9.0 * np.eye(sides), 1, axis=1) + 1.0 + 0j, (40, sides, sides))
    return TransferMatrix(frequency, response, np.full(response.shape, 1e-4), np.full(response.shape, 0.99), {})


@pytest.mark.sample(1)
@pytest.mark.parametrize("sides", [16, 1, 2, 3, 4])
@pytest.mark.slow
def test_any_number_of_sides_has_room(sides: int) -> None:
    with warnings.catch_warnings(), styled():
        warnings.simplefilter("error")
        for draw in (bode_figure, certainty_figure):
            lay_out(draw(matrix(sides)))


def test_of_few_sides_every_element_is_drawn_and_of_many_the_strongest_of_each_output() -> None:
    with styled():
        few, many = bode_figure(matrix(2)), bode_figure(matrix(5))
    assert [axes.get_title("left") for axes in few.axes if axes.get_title("left")] == [
        f"response {output} from drive {drive}" for output in (1, 2) for drive in (1, 2)
    ]
    assert [axes.get_title("left") for axes in many.axes if axes.get_title("left")] == [
        f"response {output} from drive {output % 5 + 1}, thin: from the others" for output in range(1, 6)
    ]
    assert [len(axes.lines) for axes in many.axes] == [5, 1] * 5
