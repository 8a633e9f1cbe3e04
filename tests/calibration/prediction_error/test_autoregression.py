"""ARX models: exact on data of their own kind, orders found, and the state space that says the same."""

import numpy as np
import pytest

from calibration.prediction_error import arx

A = np.array([[[1.2, 0.1], [0.0, 0.9]], [[-0.7, 0.0], [0.1, -0.5]]])
B = np.array([[[0.0], [0.0]], [[1.0], [0.0]], [[0.4], [0.5]]])


def measured(seed: int, samples: int = 3000, noise: float = 0.1) -> tuple[np.ndarray, np.ndarray]:
    """Run the model above: two outputs, one input that reaches the second a sample later than the first."""
    rng = np.random.default_rng(seed)
    u, e = rng.standard_normal((samples, 1)), noise * rng.standard_normal((samples, 2))
    y = np.zeros((samples, 2))
    for k in range(2, samples):
        y[k] = A[0] @ y[k - 1] + A[1] @ y[k - 2] + B[1] @ u[k - 1] + B[2] @ u[k - 2] + e[k]
    return u, y


def test_noiseless_records_give_the_coefficients_back() -> None:
    found = arx(*measured(1, 200, 0.0), 100.0, 2)
    np.testing.assert_allclose(found.a, A, atol=1e-10)
    np.testing.assert_allclose(found.b, B, atol=1e-10)


def test_several_records_are_fitted_together_and_not_across_their_joints() -> None:
    records = [measured(seed, 150, 0.0) for seed in range(3)]
    found = arx([u for u, _ in records], [y for _, y in records], 100.0, (2, 2))
    np.testing.assert_allclose(found.a, A, atol=1e-10)


@pytest.mark.parametrize("criterion", ["aic", "bic"])
def test_the_order_is_found(criterion: str) -> None:
    found = arx(*measured(2), 100.0, 8, choose=criterion)  # type: ignore[arg-type]
    if criterion == "bic":
        assert len(found.a) == 2
    assert 2 <= len(found.a) <= 5
    np.testing.assert_allclose(found.a[:2], A, atol=0.05)
    np.testing.assert_allclose(found.covariance, 0.01 * np.eye(2), atol=1e-3)


def test_a_delay_leaves_the_lags_before_it_out() -> None:
    u, y = measured(3, 500, 0.0)
    found = arx(np.roll(u, -2, axis=0)[:-2], y[:-2], 100.0, (2, 2), delays=[3])
    np.testing.assert_allclose(found.b[:3], 0.0)
    np.testing.assert_allclose(found.b[3:], B[1:], atol=1e-10)


def test_a_longer_model_of_noiseless_records_predicts_as_well() -> None:
    """Its regressors depend on each other."""
    u, y = measured(4, 400, 0.0)
    model = arx(u, y, 100.0, 6).model()
    np.testing.assert_allclose(model.predict(u, y)[20:], y[20:], atol=1e-7)


def test_its_state_space_predicts_what_the_coefficients_predict() -> None:
    u, y = measured(5)
    found = arx(u, y, 100.0, (3, 2), delays=0)
    u_at, y_at = (np.concatenate([np.zeros((4, s.shape[1])), s]) for s in (u, y))
    expected = np.zeros_like(y)
    for lag, matrix in enumerate(found.a, start=1):
        expected += y_at[4 - lag : len(y_at) - lag] @ matrix.T
    for lag, matrix in enumerate(found.b):
        expected += u_at[4 - lag : len(u_at) - lag] @ matrix.T
    np.testing.assert_allclose(found.model().predict(u, y), expected, atol=1e-9)


def test_chunks_make_no_difference(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = arx(*measured(6), 100.0, 2)
    monkeypatch.setattr("calibration.prediction_error.autoregression.CHUNK_ROWS", 97)
    np.testing.assert_allclose(arx(*measured(6), 100.0, 2).a, whole.a, rtol=1e-9)


@pytest.mark.parametrize(
    ("lags", "delays", "complaint"),
    [(0, 1, "lags are 0"), (2, -1, "delays are -1"), (2, [1, 1], "delays are"), (400, 1, "samples with a whole past")],
)
def test_what_cannot_be_fitted_is_refused(lags: int, delays: int | list[int], complaint: str) -> None:
    with pytest.raises(ValueError, match=complaint):
        arx(*measured(7, 500), 100.0, lags, delays=delays)


def test_records_that_do_not_belong_together_are_refused() -> None:
    u, y = measured(8, 100)
    with pytest.raises(ValueError, match=r"inputs have \[99\] samples and outputs \[100\]"):
        arx(u[1:], y, 100.0, 2)
    y[7] = np.nan
    with pytest.raises(ValueError, match="output 1 of record 1 is not finite at sample 7"):
        arx(u, y, 100.0, 2)
