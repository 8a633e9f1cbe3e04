"""Forces from torques: optimal, all of them found, and named where there are many."""

import numpy as np
import pytest

from stagectl.robot.milling.force_estimate import estimate_force, estimate_wrench
from tests.stagectl.robot.milling.force_cases import Cases, extremes, random_cases, reference


def objective_at(cases: Cases, n: int, force: np.ndarray) -> float:
    """Return (5.6) with the force given: friction alone is left to choose; by projected coordinates' own solver."""
    given = Cases(
        cases.torque[n : n + 1] + force @ cases.jacobian[n], np.zeros((1, 3, 6)), cases.friction[n : n + 1],
        cases.covariance, force[None],
    )  # fmt: skip
    return reference(given, 0)[0]


@pytest.mark.sample(1)
@pytest.mark.parametrize(("reach", "samples"), [(1.0, 700), (1.5, 650), (4.0, 650)])
def test_the_objective_is_that_of_a_reference_solver(reach: float, samples: int) -> None:
    """2000 cases in all, with noise that is correlated between joints."""
    cases = random_cases(samples, reach)
    found = estimate_force(cases.torque, cases.jacobian, cases.friction, cases.covariance)
    expected = np.array([reference(cases, n)[0] for n in range(samples)])
    assert np.abs(found.objective - expected).max() < 1e-8
    assert (reach == 1.0) == (not expected[expected > 1e-9].size)


@pytest.mark.sample(2)
@pytest.mark.parametrize("tie_break", ["centre", "minimum-norm"])
@pytest.mark.parametrize("reach", [1.0, 1.5, 4.0])
def test_the_estimate_is_optimal_and_its_box_is_that_of_linear_programming(reach: float, tie_break: str) -> None:
    cases = random_cases(25, reach, seed=2)
    found = estimate_force(cases.torque, cases.jacobian, cases.friction, cases.covariance, tie_break)
    for n in range(25):
        objective, left = reference(cases, n)
        assert objective_at(cases, n, found.force[n]) == pytest.approx(objective, abs=1e-8)
        assert np.array([found.low[n], found.high[n]]) == pytest.approx(extremes(cases, n, left, 1e-9), abs=1e-4)
    assert (found.low <= found.force).all()
    assert (found.force <= found.high).all()


def test_the_true_force_is_in_the_box_wherever_friction_is_in_its_range() -> None:
    cases = random_cases(2_000, 1.0, seed=3)
    found = estimate_force(cases.torque, cases.jacobian, cases.friction, cases.covariance)
    assert (found.low <= cases.force + 1e-9).all()
    assert (cases.force - 1e-9 <= found.high).all()
    assert (found.objective == 0.0).all()
    assert not found.unique.any()


def test_the_tie_breaks_are_what_they_are_called() -> None:
    """No point of the box's set is nearer; looked for by chance among points that are as likely."""
    cases = random_cases(40, 1.0, seed=4)
    middle, half = cases.friction.mean(axis=1), 0.5 * np.ptp(cases.friction, axis=1)
    rng = np.random.default_rng(1)
    found = {
        name: estimate_force(cases.torque, cases.jacobian, cases.friction, cases.covariance, name).force
        for name in ("centre", "minimum-norm")
    }

    def off_centre(force: np.ndarray) -> np.ndarray:
        friction = cases.torque + np.einsum("nij,...ni->...nj", cases.jacobian, force)
        return np.asarray((friction - middle) / half)

    def seen(force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return np.linalg.norm(off_centre(force), axis=-1), np.linalg.norm(force, axis=-1)

    tries = cases.force + 10 * rng.normal(size=(20_000, 40, 3))
    likely = (np.abs(off_centre(tries)) <= 1).all(axis=-1)
    assert likely.any(axis=0).sum() > 30
    for place, name in enumerate(("centre", "minimum-norm")):
        sizes = np.where(likely, seen(tries)[place], np.inf)
        assert (seen(found[name])[place] <= sizes.min(axis=0) + 1e-9).all(), name
    assert seen(found["minimum-norm"])[1].mean() < seen(found["centre"])[1].mean()


def test_a_joint_without_lever_does_not_pin_the_force() -> None:
    """The last axis goes through the tool: its torque beyond its range is noise, and says nothing of the force."""
    cases = random_cases(50, 1.0, seed=5)
    jacobian, torque = cases.jacobian.copy(), cases.torque.copy()
    torque[:, 5] += np.einsum("ni,ni->n", cases.force, jacobian[:, :, 5])
    jacobian[:, :, 5] = 0.0
    quiet = estimate_force(torque, jacobian, cases.friction, np.eye(6))
    torque[:, 5] = cases.friction[:, 1, 5] + 2.0
    found = estimate_force(torque, jacobian, cases.friction, np.eye(6))
    assert found.objective == pytest.approx(4.0)
    assert found.low == pytest.approx(quiet.low, abs=1e-6)
    assert found.high == pytest.approx(quiet.high, abs=1e-6)
    assert not found.unique.any()


def test_a_single_sample_is_that_of_the_stack() -> None:
    cases = random_cases(20, 1.5, seed=6)
    found = estimate_force(cases.torque, cases.jacobian, cases.friction, cases.covariance)
    for n in range(20):
        part = slice(n, n + 1)
        one = estimate_force(cases.torque[part], cases.jacobian[part], cases.friction[part], cases.covariance)
        assert (one.force == found.force[part]).all()
        assert (one.low == found.low[part]).all()
        assert (one.high == found.high[part]).all()


def test_what_torques_do_not_tell_is_not_made_up() -> None:
    cases = random_cases(3, 1.0)
    jacobian, torque = cases.jacobian.copy(), cases.torque.copy()
    jacobian[0, 2] = jacobian[0, 1]  # y and z have the same torques
    torque[1, 3] = np.nan
    found = estimate_force(torque, jacobian, cases.friction, cases.covariance)
    assert np.isnan(found.force[:2]).all()
    assert np.isnan(found.objective[:2]).all()
    assert (found.low[:2] == -np.inf).all()
    assert (found.high[:2] == np.inf).all()
    assert np.isfinite(found.force[2]).all()


def test_a_wrench_has_six_parts_that_are_never_one_only() -> None:
    rng = np.random.default_rng(7)
    cases = random_cases(60, 1.0, seed=7)
    jacobian = rng.normal(size=(60, 6, 6))
    wrench = rng.normal(size=(60, 6))
    friction = cases.friction.mean(axis=1) + 0.5 * rng.uniform(-1, 1, (60, 6)) * np.ptp(cases.friction, axis=1)
    torque = friction - np.einsum("nij,ni->nj", jacobian, wrench)
    found = estimate_wrench(torque, jacobian, cases.friction)
    assert ((found.low <= wrench) & (wrench <= found.high)).all()
    assert not found.unique.any()
    centred = estimate_wrench(torque - friction + cases.friction.mean(axis=1), jacobian, cases.friction)
    assert centred.force == pytest.approx(wrench, rel=1e-6, abs=1e-6)
    jacobian[0, 5] = jacobian[0, 4]
    assert np.isnan(estimate_wrench(torque, jacobian, cases.friction).force[0]).all()


@pytest.mark.parametrize(
    ("name", "change", "said"),
    [
        ("torque", lambda each: each[:, :5], r"torque has shape \(3, 5\), must be \(samples, 6\)"),
        ("jacobian", lambda each: each[:2], r"jacobian has shape \(2, 3, 6\), must be \(3, 3 or 6, 6\)"),
        ("friction", lambda each: each[:, ::-1], "friction of joint 1, sample 0: .* must rise"),
        ("covariance", lambda each: 0 * each, "covariance has the eigenvalue 0, must be > 0"),
        ("covariance", lambda each: each[:3], r"covariance has shape \(3, 6\), must be \(6, 6\) and symmetric"),
    ],
)
def test_what_does_not_fit_is_refused(name: str, change: object, said: str) -> None:
    cases = random_cases(3, 1.0)
    names = ("torque", "jacobian", "friction", "covariance")
    given = {each: getattr(cases, each) for each in names}
    with pytest.raises(ValueError, match=said):
        estimate_force(**given | {name: change(given[name])})  # type: ignore[operator,arg-type]
    with pytest.raises(ValueError, match="tie_break is 'middle', must be one of centre, minimum-norm"):
        estimate_force(*given.values(), tie_break="middle")
