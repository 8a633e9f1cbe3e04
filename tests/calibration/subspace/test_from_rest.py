"""Predictors that can be begun from rest, and what they give for it."""

import numpy as np
import pytest

from calibration import subspace
from calibration.fit_measures import nrmse
from calibration.state_space.model import InnovationModel
from calibration.subspace.from_rest import COST, RISE, from_rest

SAMPLES = 1000


def smooth(seed: int) -> tuple[InnovationModel, np.ndarray, np.ndarray]:
    """Return a plant of five slow poles, whose best predictor extrapolates, and a record from the midst of a longer."""
    random = np.random.default_rng(seed)
    a = np.diag(np.ones(4), 1)
    a[:, 0] = -np.poly([0.97, 0.96, 0.95, 0.9 + 0.2j, 0.9 - 0.2j]).real[1:]
    c = np.eye(1, 5)
    gain = a[:, :1] + np.poly([0.93, 0.92 + 0.02j, 0.92 - 0.02j, 0.9, 0.88]).real[1:, None]
    model = InnovationModel(a, np.full((5, 1), 0.1), c, np.zeros((1, 1)), gain, 1.0, np.array([[1e-4]]))
    u, e = random.standard_normal((3 * SAMPLES, 1)), 1e-2 * random.standard_normal((3 * SAMPLES, 1))
    joint = InnovationModel(a, np.hstack([model.B, gain]), c, np.array([[0.0, 1.0]]), gain, 1.0, np.array([[1e-4]]))
    y = joint.simulate(np.hstack([u, e]))
    return model, u[-SAMPLES:], y[-SAMPLES:]


def fits(model: InnovationModel, u: np.ndarray, y: np.ndarray) -> tuple[float, float]:
    """Return the fit one step ahead, %, from rest and from the state that suits best."""
    fitted = model.predict(u, y, model.initial_predictor_state(u, y))
    return float(nrmse(y, model.predict(u, y))[0]), float(nrmse(y, fitted)[0])


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_predictor_that_extrapolates_is_calmed_for_a_little_of_its_sharpness(seed: int) -> None:
    model, u, y = smooth(seed)
    begun = from_rest(model, [u], [y])
    before, after = fits(model, u, y), fits(begun, u, y)
    assert 100 - after[0] < 0.6 * (100 - before[0])
    assert 100 - after[1] <= 1.01 * RISE * (100 - before[1])
    for name in "ABCD":
        np.testing.assert_array_equal(getattr(begun, name), getattr(model, name))


def test_one_that_forgets_within_its_record_is_left_as_it_is() -> None:
    model, u, y = smooth(1)
    quick = InnovationModel(0.5 * np.eye(1), model.B[:1], np.eye(1), model.D, 0.3 * np.eye(1), 1.0, np.eye(1))
    assert from_rest(quick, [u], [y]) is quick
    long = [np.tile(each, (int(1 / COST) * 40, 1)) for each in (u, y)]
    assert from_rest(model, [long[0]], [long[1]]) is model


@pytest.mark.parametrize("stable", [True, False])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_what_integrates_is_foretold_from_rest_about_a_point_that_its_records_are_near_to(
    seed: int, stable: bool
) -> None:
    random = np.random.default_rng(seed)
    u = random.standard_normal(2000)
    y = np.cumsum(0.05 * np.r_[0, u[:-1]]) + 0.05 * random.standard_normal(2000)
    found = subspace.identify(u[:1000], y[:1000], 1.0, stable=stable)
    assert abs(found.output_offset[0] - y[:1000].mean()) < y[:1000].std()
    fresh = found.compare(u[1000:], y[1000:]).fit
    assert fresh.from_rest.nrmse[0] > 60
    assert fresh.one_step.nrmse[0] > 85
