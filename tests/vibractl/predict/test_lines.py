"""Each reason for which a line is not certified, made on purpose."""

from dataclasses import replace

import numpy as np
import pytest

from tests.vibractl.linear_rig import linear_config, linear_matrix
from vibractl.predict.lines import MEANINGS, REASONS, certificates
from vibractl.setup import setup
from vibractl.transfer_matrix import TransferMatrix


def easy(variance: float = 1e-6) -> TransferMatrix:
    """Return a model that is the same on every line, and far from singular."""
    matrix = linear_matrix()
    response = np.broadcast_to(np.array([[2.0, 0.5], [0.5, 2.0]], complex), matrix.response.shape).copy()
    return replace(matrix, response=response, variance=np.full(response.shape, variance))


def reasons(matrix: TransferMatrix, *overrides: str) -> tuple[np.ndarray, np.ndarray]:
    found = certificates(setup(linear_config("quality.judged_to=645.0", *overrides), matrix))
    assert np.array_equal(found.reason == "", found.certified)
    return found.frequency, found.reason


def test_every_line_of_an_easy_model_is_certified() -> None:
    frequency, reason = reasons(easy())
    assert frequency[0] == pytest.approx(15)
    assert set(reason) == {""}


def test_uncertain_lines_are_named_and_grouped() -> None:
    matrix = easy()
    matrix.variance[(matrix.frequency >= 200) & (matrix.frequency <= 210)] = 4.0
    found = certificates(setup(linear_config("quality.judged_to=645.0"), matrix))
    ((low, high, reason, bound),) = found.ranges()
    assert (reason, bound > 1) == ("variance", True)
    assert (low, high) == pytest.approx((200, 210), abs=1)


@pytest.mark.parametrize(("weakest", "reason"), [(0.1, "near singular"), (0.01, "regularisation")])
def test_lines_near_singular_and_those_only_regularisation_bounds_are_told_apart(weakest: float, reason: str) -> None:
    matrix = easy(variance=4e-2)
    matrix.response[:] = [[2.0, 0.0], [0.0, weakest]]
    assert set(reasons(matrix)[1]) == {reason}


def test_doubt_of_the_law_is_told_from_the_models_own() -> None:
    assert set(reasons(easy(), "learning.law=kalman", "adaptation.doubt=1.5")[1]) == {"doubt"}


def test_one_drive_for_two_sides_is_too_few() -> None:
    assert set(reasons(easy(), "learning.structure=common")[1]) == {"too few coils"}


def test_judged_lines_beyond_the_learned_band_are_outside_the_model() -> None:
    frequency, reason = reasons(easy(), "learning.band=[15.0,600.0]")
    outside = reason == "outside the model"
    assert (frequency[outside].min(), frequency[outside].max()) == pytest.approx((600 + 1 / 1.4, 645))


def test_an_overtone_beyond_those_learned_is_outside_the_model() -> None:
    settings = ("reference.signal=sine:50:1", "learning.band=[15.0,160.0]", "quality.judged_to=220.0")
    frequency, reason = reasons(easy(), *settings)
    assert list(frequency[reason == "outside the model"]) == [200.0]


def test_every_reason_has_its_meaning() -> None:
    assert set(MEANINGS) == set(REASONS)
