"""The learning law on linear robots that are what the models say, and on ones that are not."""

import numpy as np
import pytest

from stagectl.robot.milling.convergence import Doubt, cautious, contraction
from stagectl.robot.milling.learning import PathLaw, predicted, update
from stagectl.robot.milling.trial_error import TrialSignals, kinematic_error, tool_position
from stagectl.robot.milling.zero_phase import filtered
from tests.stagectl.robot.milling.trial_models import RATE, axis, process, square


def law(**changes) -> PathLaw:  # type: ignore[no-untyped-def]
    return PathLaw((axis(2), axis(3, 0.3), axis(2, -0.5)), **changes)


def milled(sent: np.ndarray, by: PathLaw) -> np.ndarray:
    return filtered(sent, RATE, by.plant)


def size(error: np.ndarray) -> float:
    return float(np.linalg.norm(np.abs(error).mean(axis=0)))


@pytest.mark.parametrize("kind", ["regularised", "mirrored"])
def test_in_free_space_one_trial_is_nearly_enough(kind) -> None:  # type: ignore[no-untyped-def]
    by, wanted = law(kind=kind), square()
    off = 1e-4 * np.sin(np.arange(len(wanted)) / 70.0)[:, None] * [1.0, -2.0, 0.5]
    first = milled(wanted, by) + off
    again = milled(update(wanted, wanted - first, by), by) + off
    assert size(wanted - again) < 0.03 * size(wanted - first)


def test_in_material_the_coupling_is_undone_as_well() -> None:
    by, wanted = law(process=process()), square()
    first = milled(wanted, by)
    again = milled(update(wanted, wanted - first, by), by)
    assert size(wanted - again) < 0.03 * size(wanted - first)


def test_the_path_predicted_is_the_one_that_comes() -> None:
    by, wanted = law(process=process()), square()
    first = milled(wanted, by)
    sent = update(wanted, wanted - first, by)
    assert predicted(first, sent - wanted, by) == pytest.approx(milled(sent, by), abs=1e-9)


def test_all_methods_learn_the_same_where_their_models_are_exact() -> None:
    """Methods differ in e alone, so with exact models, no noise and the kinematic error known all give one path."""
    models = process()
    by, wanted = law(process=models), square()
    off = np.array([2e-4, -1e-4, 3e-4])
    seen = milled(wanted, by) + off
    force = filtered(seen - off, RATE, models.force.frequency_response)
    joints = seen - off - models.deflection(force, RATE)
    trial = TrialSignals(wanted, joints, seen, force)
    free = TrialSignals(wanted, seen - off, seen)
    known = kinematic_error([free])
    for method in (1, 2, 3):
        where = tool_position(trial, method, RATE, models, known)
        assert where == pytest.approx(seen, abs=1e-9)


def test_a_method_says_what_it_lacks() -> None:
    trial = TrialSignals(square(), square())
    for method, words in (
        (1, "what the tracker saw"),
        (2, "a measured force"),
        (3, "motor torques"),
        (4, "method is 4"),
    ):
        with pytest.raises(ValueError, match=words):
            tool_position(trial, method, RATE, None, None)


def test_exact_models_contract_and_the_factor_is_what_a_sine_shrinks_by() -> None:
    by = law(process=process(), gain=0.5)
    found = contraction(by)
    assert found.is_monotone
    at = int(np.argmin(np.abs(found.frequency - 3.0)))
    frequency = found.frequency[at : at + 1]
    moved = np.eye(3) - by.plant(frequency)[0] @ by.step(frequency)[0]
    assert found.factor[at] == pytest.approx(np.linalg.svd(moved)[1].max())
    assert found.factor[0] == pytest.approx(0.5, abs=2e-3)


def test_a_law_that_diverges_on_a_robot_is_refused_before_it_runs_there() -> None:
    """A robot with three times the gain of its model: errors grow twofold, and the doubt of such a model says so."""
    by, wanted = law(), square()
    real = law()
    sent, sizes = wanted, []
    for _ in range(3):
        error = wanted - 3.0 * milled(sent, real)
        sizes.append(size(error))
        sent = update(sent, error, by)
    assert sizes[1] > sizes[0]
    assert sizes[2] > sizes[1]
    frequency = np.linspace(0.5, 25.0, 50)
    measured = 3.0 * np.stack([each.response(frequency) for each in by.axes], axis=-1)
    found = contraction(by, Doubt(frequency, measured, np.zeros((50, 3))))
    with pytest.raises(ValueError, match="lower learning.gain or learning.cutoff"):
        found.refuse_divergence()


def test_doubt_only_widens_the_bound() -> None:
    by = law(process=process())
    exact = contraction(by)
    frequency = np.linspace(0.5, 25.0, 200)
    measured = np.stack([each.response(frequency) for each in by.axes], axis=-1)
    unsure = contraction(by, Doubt(frequency, measured, np.full((200, 3), 0.02), 1.3 * by.process.coupling(frequency)))
    assert (unsure.bound >= exact.factor - 1e-12).all()
    assert unsure.worst > exact.worst
    assert unsure.is_monotone


def test_paths_and_errors_of_different_length_are_refused() -> None:
    with pytest.raises(ValueError, match="must be alike"):
        update(np.zeros((10, 3)), np.zeros((11, 3)), law())


def test_caution_makes_a_law_shrink_errors_in_material_and_in_the_air_alike() -> None:
    """All of a strong coupling undone makes errors grow where the path meets no material; a cautious law does not."""
    strong = process(stiffness=1e4)
    by = law(process=strong)
    frequency = np.linspace(0.5, 25.0, 200)
    measured = np.stack([each.response(frequency) for each in by.axes], axis=-1)
    doubt = Doubt(frequency, measured, np.full((200, 3), 0.01), strong.coupling(frequency))
    assert not contraction(by, doubt).is_monotone
    careful = cautious(by, doubt)
    assert contraction(careful, doubt).is_monotone
    wanted = square()
    for real in (by, law()):
        sent, sizes = wanted, []
        for _ in range(4):
            error = wanted - milled(sent, real)
            sizes.append(size(error))
            sent = update(sent, error, careful)
        assert sizes[3] < 0.2 * sizes[0]
        assert sorted(sizes, reverse=True) == sizes
