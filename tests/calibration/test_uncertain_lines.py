import numpy as np
import pytest

from calibration.uncertain_lines import MOST, merged, uncertain_lines
from vibractl.transfer_matrix import TransferMatrix

FREQUENCY = np.arange(100.0, 200.0, 0.5)


def matrix(frequency: np.ndarray, response: np.ndarray | float, variance: np.ndarray | float) -> TransferMatrix:
    shape = (len(frequency), 2, 2)
    full = [np.broadcast_to(np.reshape(part, (-1, 1, 1)), shape) for part in (response, variance)]
    return TransferMatrix(frequency, full[0] + 0j, full[1] + 0.0, np.full(shape, 0.5), {"rig": "x"})


def test_lines_that_stand_out_are_chosen_and_no_others() -> None:
    doubt = np.where((FREQUENCY > 140) & (FREQUENCY < 144), 0.1, 0.01) ** 2
    chosen = uncertain_lines(matrix(FREQUENCY, 1.0, doubt))
    assert chosen.tolist() == [140.5, 141.5, 142.5, 143.5]


def test_where_all_lines_are_alike_none_is_chosen() -> None:
    assert len(uncertain_lines(matrix(FREQUENCY, 1.0, 1e-4))) == 0


def test_the_worst_come_first_where_there_are_too_many() -> None:
    many = np.arange(100.0, 400.0, 0.5)
    doubt = np.where(many > 260, 0.0, np.where(many > 200, 0.1, 0.2)) ** 2 + 1e-6
    doubt[many > 240] = 1e-6
    chosen = uncertain_lines(matrix(many, 1.0, doubt))
    assert len(chosen) == MOST
    assert chosen.max() < 200.5


def test_tones_are_weighed_in_by_their_variance() -> None:
    tones = matrix(FREQUENCY[10:50:2], 1.1, 0.03)
    both = merged(matrix(FREQUENCY, 1.0, 0.01), tones)
    assert both.response[10].real == pytest.approx(1.025)
    assert both.variance[10] == pytest.approx(0.0075)
    assert both.response[11] == pytest.approx(1.0)


def test_tones_of_another_operating_point_count_less() -> None:
    tones = matrix(FREQUENCY[10:50:2], 2.0, 1e-6)
    both = merged(matrix(FREQUENCY, 1.0, 0.01), tones)
    assert both.response[10].real == pytest.approx(1 + 0.01 / 1.0, rel=0.02)


def test_tones_beside_the_lines_are_refused() -> None:
    with pytest.raises(ValueError, match="must lie on bins"):
        merged(matrix(FREQUENCY, 1.0, 0.01), matrix(FREQUENCY[:8] + 0.1, 1.0, 0.01))
