"""The transfer matrix, its inverse, its certificate and its file."""

from pathlib import Path

import numpy as np
import pytest

from rigkit.model_file import ModelFileError
from tests.vibractl.linear_rig import linear_matrix
from vibractl.model_file import read_model, write_model
from vibractl.transfer_matrix import TransferMatrix, contraction, line_weights, norm, regularized_inverse

RNG = np.random.default_rng(9)


def matrix(bins: int = 30, deviation: float = 0.01) -> TransferMatrix:
    """Return a random 2x2 matrix from 20 Hz up, 1 Hz apart."""
    response = RNG.standard_normal((bins, 2, 2)) + 1j * RNG.standard_normal((bins, 2, 2))
    shape = response.shape
    return TransferMatrix(20.0 + np.arange(bins), response, np.full(shape, deviation**2), np.ones(shape), {"rig": "a"})


def test_without_weight_the_inverse_is_the_inverse() -> None:
    response = matrix().response
    np.testing.assert_allclose(regularized_inverse(response, 0.0), np.linalg.inv(response), rtol=1e-9)


def test_with_weight_the_inverse_is_tikhonovs_in_singular_values() -> None:
    response = matrix().response
    left, values, right = np.linalg.svd(response)
    wanted = right.conj().swapaxes(1, 2) @ ((values / (values**2 + 0.1))[..., None] * left.conj().swapaxes(1, 2))
    np.testing.assert_allclose(regularized_inverse(response, 0.1), wanted, rtol=1e-9)


def test_the_inverse_is_bounded_where_the_matrix_is_singular() -> None:
    singular = np.array([[[1.0 + 1j, 1.0], [1.0 + 1j, 1.0]]])
    assert norm(regularized_inverse(singular, 0.01))[0] <= 1 / (2 * np.sqrt(0.01))


def test_line_weights_follow_each_line() -> None:
    response = matrix().response
    weights = line_weights(response, 1e-3, 1e-5)
    size = np.linalg.svd(response, compute_uv=False)[:, 0] ** 2
    np.testing.assert_allclose(weights, 1e-3 * size + 1e-5 * size.max())


def test_an_exact_estimate_contracts_by_one_minus_the_gain() -> None:
    exact = matrix(deviation=0.0)
    bound = contraction(exact.response, exact.variance, np.linalg.inv(exact.response), 0.3)
    np.testing.assert_allclose(bound, 0.7, rtol=1e-9)


def test_the_certificate_bounds_what_a_wrong_estimate_does() -> None:
    estimate = matrix(deviation=0.02)
    inverse = regularized_inverse(estimate.response, line_weights(estimate.response, 1e-3, 1e-5))
    bound = contraction(estimate.response, estimate.variance, inverse, 0.5, deviations=3.0)
    for _ in range(50):
        noise = (RNG.standard_normal((30, 2, 2)) + 1j * RNG.standard_normal((30, 2, 2))) * 0.02 / np.sqrt(2)
        actual = norm(np.eye(2) - 0.5 * (estimate.response + noise) @ inverse)
        assert np.mean(actual <= bound) > 0.95


def test_interpolation_of_a_1_hz_grid_is_good_to_two_percent() -> None:
    fine = linear_matrix()
    coarse = TransferMatrix(*(value[::4] for value in (fine.frequency, fine.response, fine.variance, fine.coherence)))
    inside = (fine.frequency >= coarse.frequency[0]) & (fine.frequency <= coarse.frequency[-1])
    wrong = norm(coarse.at(fine.frequency[inside]).response - fine.response[inside]) / norm(fine.response[inside])
    assert np.percentile(wrong, 99) < 0.02


def test_lines_outside_the_measured_band_are_refused() -> None:
    with pytest.raises(ValueError, match="bins 10 to 30 Hz are wanted, the model was measured from 20 to 49 Hz"):
        matrix().at(np.array([10.0, 30.0]))


def test_a_matrix_that_is_not_finite_is_refused_with_its_frequency() -> None:
    good = matrix()
    bad = good.response.copy()
    bad[3, 0, 1] = np.nan
    with pytest.raises(ValueError, match="response is not finite at 23 Hz"):
        TransferMatrix(good.frequency, bad, good.variance, good.coherence)


def test_a_model_file_comes_back_bit_for_bit(tmp_path: Path) -> None:
    written = matrix()
    write_model(tmp_path / "m.h5", written)
    back = read_model(tmp_path / "m.h5", (2, 2))
    for name in ("frequency", "response", "variance", "coherence"):
        np.testing.assert_array_equal(getattr(back, name), getattr(written, name))
    assert dict(back.provenance) == {"rig": "a"}


def test_a_model_of_another_size_is_refused(tmp_path: Path) -> None:
    write_model(tmp_path / "m.h5", matrix())
    with pytest.raises(ModelFileError, match="2 accelerometers and 2 coils, this rig has 3 and 1"):
        read_model(tmp_path / "m.h5", (3, 1))


def test_what_is_no_model_file_is_refused_by_name(tmp_path: Path) -> None:
    (tmp_path / "m.h5").write_bytes(b"not HDF5")
    for path in (tmp_path / "m.h5", tmp_path / "absent.h5"):
        with pytest.raises(ModelFileError, match=path.name):
            read_model(path)
