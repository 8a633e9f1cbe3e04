"""The update, its gains, and that it learns."""

import numpy as np
import pytest

from vibractl.learning.gains import Gains
from vibractl.learning.update import update
from vibractl.transfer_matrix import regularized_inverse

RNG = np.random.default_rng(5)


def spectra(*shape: int) -> np.ndarray:
    """Return complex noise."""
    return RNG.standard_normal(shape) + 1j * RNG.standard_normal(shape)


@pytest.mark.parametrize(("inputs", "outputs"), [(1, 1), (2, 2), (1, 2), (3, 2)])
def test_update_is_the_formula(inputs: int, outputs: int) -> None:
    drive, error, inverse = spectra(50, inputs), spectra(50, outputs), spectra(50, inputs, outputs)
    gain = RNG.uniform(0, 1, 50)
    wanted = 0.9 * drive + gain[:, None] * (inverse @ error[..., None])[..., 0]
    np.testing.assert_allclose(update(drive, inverse, error, gain, 0.9), wanted, rtol=1e-13)


def test_update_leaves_its_arguments_alone() -> None:
    drive, error, inverse = spectra(5, 2), spectra(5, 2), spectra(5, 2, 2)
    kept = drive.copy(), error.copy(), inverse.copy()
    update(drive, inverse, error, 0.3)
    for before, after in zip(kept, (drive, error, inverse), strict=True):
        np.testing.assert_array_equal(before, after)


def test_a_gain_of_zero_freezes_a_line() -> None:
    drive = spectra(2, 2)
    following = update(drive, spectra(2, 2, 2), spectra(2, 2), np.array([0.0, 1.0]))
    np.testing.assert_array_equal(following[0], drive[0])
    assert np.all(following[1] != drive[1])


def test_with_an_exact_model_the_error_shrinks_by_one_minus_the_gain() -> None:
    response, reference, drive = spectra(40, 2, 2), spectra(40, 2), np.zeros((40, 2), complex)
    inverse = regularized_inverse(response, 0.0)
    for shot in range(1, 6):
        error = reference - (response @ drive[..., None])[..., 0]
        drive = update(drive, inverse, error, 0.3)
        left = reference - (response @ drive[..., None])[..., 0]
        np.testing.assert_allclose(left, 0.7**shot * reference, rtol=1e-8, atol=1e-9)


def test_shapes_that_disagree_are_refused() -> None:
    with pytest.raises(ValueError, match="drive is"):
        update(spectra(5, 1), spectra(5, 2, 2), spectra(5, 2), 0.3)


@pytest.mark.parametrize(
    ("gains", "stages", "words"),
    [((0.3, 0.1), (), "one fewer"), ((1.2,), (), "1.2, must be 0 to 1"), ((0.3, 0.1), (0,), "0, must be >= 1")],
)
def test_gains_that_do_not_fit_are_refused(gains: tuple[float, ...], stages: tuple[int, ...], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        Gains(gains, stages)
