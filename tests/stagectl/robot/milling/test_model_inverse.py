"""Both inverses of a model with a delay and a zero outside of the unit circle."""

from typing import get_args

import numpy as np
import pytest

from stagectl.robot.milling.axis_model import AxisModel
from stagectl.robot.milling.model_inverse import inverse
from stagectl.robot.pocket_config import Inverse
from tests.stagectl.robot.milling.trial_models import RATE, axis

FREQUENCY = np.linspace(0.0, 40.0, 81)


@pytest.mark.parametrize("kind", get_args(Inverse))
def test_without_such_a_zero_both_undo_the_model_with_its_delay(kind) -> None:  # type: ignore[no-untyped-def]
    model = axis(delay=3, zero=0.4)
    undone = model.response(FREQUENCY) * inverse(model, FREQUENCY, kind, 0.0)
    assert undone == pytest.approx(1.0, abs=1e-9)


def test_the_mirrored_inverse_has_the_magnitude_and_a_stable_phase() -> None:
    model = axis(delay=0, zero=-1.6)
    undone = model.response(FREQUENCY) * inverse(model, FREQUENCY, "mirrored", 0.0)
    assert np.abs(undone) == pytest.approx(1.0, abs=1e-9)
    assert np.abs(np.angle(undone)).max() > 0.05  # what the mirrored zero costs
    assert undone[0] == pytest.approx(1.0)


def test_the_regularised_inverse_has_no_phase_error_and_a_bound() -> None:
    model = axis(delay=4)
    got = inverse(model, FREQUENCY, "regularised", 0.04)
    undone = model.response(FREQUENCY) * got
    assert np.abs(np.angle(undone)).max() < 1e-12
    assert np.abs(got).max() <= 1 / (2 * np.sqrt(0.04))


def test_an_unstable_model_is_refused() -> None:
    with pytest.raises(ValueError, match="its slowest pole has modulus 1.1, must be < 1"):
        AxisModel(np.array([1.0, 0, 0]), np.poly([1.1, 0.2, 0.1]), 0, RATE)
