"""`vibrostage.ilc`: the programs' laws on plain arrays, and linear laws beside them."""

import numpy as np
import pytest
from scipy.signal import dlti

from tests.vibractl.learning.line_plant import LinePlant, law_of, matrix_of, modal
from vibractl.config import Adaptation, Watch
from vibractl.learning.algorithm import Algorithm
from vibrostage.ilc import KalmanILC, LinearILC, ThesisILC, convergence, lifted, norm_optimal, p_type, with_low_pass

LINES = np.arange(1.0, 200.0)
PLANT = 1.0 / (1.0 + 0.02j * LINES) * np.exp(-0.01j * LINES) * (1 + 0.5 / (1 + 1j * (LINES - 80) / 6))
WANTED = np.exp(-0.5 * ((LINES - 70) / 20) ** 2).astype(complex)


def error_after(law: KalmanILC | ThesisILC, trials: int, plant: np.ndarray = PLANT, noise: float = 1e-6) -> float:
    random = np.random.default_rng(1)
    for _ in range(trials):
        spoilt = noise * (random.standard_normal(len(LINES)) + 1j * random.standard_normal(len(LINES)))
        law.step(law.drive, plant * law.drive + spoilt, noise=2 * noise**2)
    return float(np.abs(WANTED - plant * law.drive).max())


@pytest.mark.parametrize(("name", "made"), [("kalman", KalmanILC), ("thesis", ThesisILC)])
def test_drives_are_those_of_the_programs_bit_for_bit(name: str, made: type[KalmanILC]) -> None:
    true = modal(2, 2)
    model = matrix_of(1.3 * true, 0.2)
    law = law_of(model, law=name)
    own, plant = Algorithm(law, Adaptation(), Watch(on=False), -40.0), LinePlant(true, law)
    used = law.matrix
    arrays = made(used.response, used.variance, law.reference, frequency=used.frequency)
    for _ in range(5):
        assert arrays.drive.tobytes() == own.lines.tobytes()
        shot = plant.shot(own.lines)
        own.step(shot)
        arrays.step(shot.drive, shot.response, noise=shot.noise)


@pytest.mark.parametrize("factor", [0.4, 3.0, np.exp(1j), 2 * np.exp(-2.0j)])
def test_a_model_that_is_far_off_is_learned_where_the_fixed_one_may_diverge(factor: complex) -> None:
    """Off by a factor of three, or turned by 57 and 115 degrees: beyond 90 the law of a fixed model grows."""
    doubt = 2.0 * np.abs(factor * PLANT) ** 2
    followed = error_after(KalmanILC(factor * PLANT, doubt, WANTED), 25)
    assert followed < 0.02
    fixed = LinearILC((0.3 / (factor * PLANT))[:, None, None])
    assert convergence(fixed, PLANT[:, None, None]).converges == (abs(np.angle(factor)) < np.pi / 2)


def test_a_trial_may_be_made_with_another_drive_and_the_reference_may_come_later() -> None:
    law = KalmanILC(2.0 * PLANT, 4.0 * np.abs(PLANT) ** 2)
    with pytest.raises(ValueError, match="reference is not given"):
        _ = law.drive
    played = 0.1 * WANTED
    following = law.step(played, PLANT * played, WANTED)
    assert following.shape == WANTED.shape
    assert error_after(law, 15) < 0.02


def test_several_drives_and_sensors_are_learned_together() -> None:
    random = np.random.default_rng(3)
    plant = modal(3, 2, 5)[:150]
    wanted = (plant @ np.ones(2))[:, :]
    model = plant * (1 + 0.2 * random.standard_normal(plant.shape))
    law = KalmanILC(model, 0.08 * np.abs(model) ** 2, wanted)
    errors = []
    for _ in range(12):
        measured = (plant @ law.drive[..., None])[..., 0]
        errors.append(np.abs(wanted - measured).max())
        law.step(law.drive, measured)
    assert errors[-1] < 0.05 * errors[0]


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (([1.0, 2.0], None, None), "response has shape"),
        ((PLANT, None, WANTED[:-1]), r"reference has shape \(198,\), must be \(199,\)"),
        ((PLANT, None, np.zeros(199)), "reference is zero on every bin"),
        ((PLANT, None, np.full(199, np.nan)), "reference is not finite on bin 0"),
    ],
)
def test_what_does_not_fit_is_refused_by_name(arguments: tuple[np.ndarray, None, np.ndarray], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        KalmanILC(*arguments)


def decaying(samples: int = 60) -> np.ndarray:
    time = np.arange(samples)
    return lifted(np.where(time > 0, 0.5 * 0.8 ** (time - 1.0), 0.0), samples)


def test_the_norm_optimal_law_makes_its_criterion_smallest() -> None:
    plant, random = decaying(), np.random.default_rng(2)
    before, wanted = random.standard_normal(60), random.standard_normal(60)
    law = norm_optimal(plant, 2.0, 0.01, 0.3)
    found = law.step(before, wanted - plant @ before)
    stacked = np.concatenate([np.sqrt(2.0) * plant, 0.1 * np.eye(60), np.sqrt(0.3) * np.eye(60)])
    target = np.concatenate([np.sqrt(2.0) * wanted, np.zeros(60), np.sqrt(0.3) * before])
    np.testing.assert_allclose(found, np.linalg.lstsq(stacked, target, rcond=None)[0], atol=1e-9)
    assert convergence(norm_optimal(plant, change=0.3), plant).norm <= 1.0 + 1e-9


def test_what_is_left_and_how_fast_is_what_trials_show() -> None:
    plant, wanted = decaying(), np.sin(np.arange(60) / 5.0)
    law = norm_optimal(plant, 1.0, 0.05, 0.5)
    foreseen, drive = convergence(law, plant), np.zeros(60)
    assert foreseen.is_monotone
    errors = []
    for _ in range(60):
        error = wanted - plant @ drive
        errors.append(error)
        drive = law.step(drive, error)
    np.testing.assert_allclose(errors[-1], foreseen.left @ wanted, atol=1e-6)


def test_a_law_may_converge_and_grow_on_the_way() -> None:
    """P-type on a plant that rings: every eigenvalue is that of its first sample, the norm is not."""
    time = np.arange(40)
    plant = lifted(np.where(time > 0, np.cos(0.6 * (time - 1.0)) * 0.97 ** (time - 1.0), 0.0), 40)
    found = convergence(p_type(0.5, 40), plant)
    assert not found.is_monotone
    inside = convergence(LinearILC(p_type(0.5, 40).learning[:-1, 1:]), plant[1:, :-1])
    assert inside.radius == pytest.approx(0.5, abs=0.05)
    assert inside.converges
    assert inside.norm > 1.0


def test_a_plant_with_dead_time_converges_where_that_is_left_out() -> None:
    """In the whole trial the last samples of the drive have no answer: nothing of them comes nearer to a limit."""
    plant = dlti([0.5], [1.0, -0.8, 0.0, 0.0, 0.0], dt=0.01)  # four samples late
    whole, inside = lifted(plant, 40), lifted(plant, 40, lead=4)
    np.testing.assert_array_equal(inside[:-4], whole[4:])
    assert convergence(norm_optimal(whole, change=0.1), whole).radius == pytest.approx(1.0)
    found = convergence(norm_optimal(inside, change=0.1), inside)
    assert found.is_monotone
    assert repr(found).endswith("; converges, monotone>")
    assert "does not converge" in repr(convergence(p_type(9.0, 40, lead=0), inside))
    assert repr(p_type(1.0, 3)) == "<LinearILC: L of shape (3, 3), Q of shape ()>"


def test_a_low_pass_makes_robust_what_the_model_does_not_know() -> None:
    wrong = np.where(LINES > 120, -1.0, 1.0) * PLANT
    inverse = (0.5 / wrong)[:, None, None]
    plant = PLANT[:, None, None]
    assert not convergence(LinearILC(inverse), plant).converges
    law = with_low_pass(inverse, LINES, lambda frequency: 1.0 * (frequency <= 120))
    found = convergence(law, plant)
    assert found.converges
    assert np.abs(found.left[LINES <= 120]).max() < 1e-9
    np.testing.assert_allclose(found.left[LINES > 120, 0, 0], 1.0)


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda: norm_optimal(np.eye(3), error=-1.0), "error is -1.0, must be >= 0"),
        (lambda: norm_optimal(decaying()), "drive or change must be > 0"),
        (lambda: p_type(1.0, 5, 5), "lead is 5 and samples 5, must be whole numbers with 0 <= lead < samples"),
        (lambda: p_type(5, 0.1), "lead is 1 and samples 0.1"),  # type: ignore[arg-type]
        (lambda: lifted(np.ones((5, 1)), 5), r"impulse response has shape \(5, 1\), must be \(taps,\)"),
        (lambda: lifted(np.array([0.0, np.nan]), 5), "not finite at sample 1"),
        (lambda: lifted(np.ones(3), 5.0), "samples is 5.0, must be a whole number >= 1"),  # type: ignore[arg-type]
        (lambda: lifted(np.ones(3), 5, lead=-1), "lead is -1, must be a whole number >= 0"),
        (lambda: norm_optimal(np.ones(5), change=1.0), r"plant has shape \(5,\), must be .*lifted"),
        (lambda: norm_optimal(dlti([1.0], [1.0, 0.5], dt=1.0), change=1.0), "plant is a .*lifted"),
        (lambda: convergence(p_type(1.0, 5), np.eye(4)), r"plant has shape \(4, 4\) and the law's L \(5, 5\)"),
        (lambda: convergence(np.eye(5), np.eye(5)), "law is a ndarray, must be a LinearILC"),  # type: ignore[arg-type]
        (
            lambda: p_type(1.0, 5).step(np.ones(4), np.ones(5)),
            r"drive has shape \(4,\) and error \(5,\), must",
        ),
        (
            lambda: with_low_pass(np.eye(5), np.arange(3.0), np.cos),
            r"learning has shape \(5, 5\) and what passes",
        ),
        (lambda: LinearILC(0.5), r"learning has shape \(\)"),  # type: ignore[arg-type]
        (lambda: LinearILC(np.eye(3), np.eye(2)), r"learning has shape \(3, 3\) and robustness \(2, 2\)"),
    ],
)
def test_numbers_that_cannot_be_are_refused(call: object, text: str) -> None:
    with pytest.raises(ValueError, match=text):
        call()  # type: ignore[operator]
