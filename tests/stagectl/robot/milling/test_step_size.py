"""How much of a correction is made after trials that came out otherwise than predicted."""

import numpy as np
import pytest

from stagectl.robot.milling.learning import PathLaw, predicted, update
from stagectl.robot.milling.step_size import FLOOR, heeding, witnessed
from tests.stagectl.robot.milling.trial_models import RATE, axis, process, square

LAW = PathLaw((axis(2), axis(3, 0.3), axis(2, -0.5)), process())
SENT = [square() + 1e-4 * np.random.default_rng(seed).standard_normal(square().shape) for seed in (1, 2, 3)]
HEARD = np.array([0.5, 1.0, 2.0, 4.0, 8.0])
"""Hz."""


def part(come: list[np.ndarray], law: PathLaw = LAW) -> np.ndarray:
    return heeding(law, SENT[: len(come)], come).passed(HEARD) / law.passed(HEARD)


def answered(factor: float) -> list[np.ndarray]:
    """Where a tool comes that answers to a change by so much of what the models say."""
    whole = [predicted(np.zeros_like(sent), sent, LAW) for sent in SENT]
    return [whole[0] + factor * (each - whole[0]) for each in whole]


def test_after_one_trial_nothing_is_known_and_the_law_stays() -> None:
    assert heeding(LAW, SENT[:1], answered(2.0)[:1]) is LAW


@pytest.mark.parametrize(("factor", "expected"), [(1.0, 1.0), (2.0, 0.5), (4.0, 0.25), (0.5, 1.0), (-1.0, FLOOR)])
@pytest.mark.parametrize("trials", [2, 3])
def test_the_step_is_as_much_smaller_as_the_answer_was_larger(factor: float, expected: float, trials: int) -> None:
    np.testing.assert_allclose(
        part(answered(factor)[:trials]), expected, rtol=0.25
    )  # the ends of noise, and L is regularised


def test_answers_that_have_nothing_to_do_with_what_was_sent_are_hardly_learned_from() -> None:
    drawn = [np.random.default_rng(10 + n).standard_normal(SENT[0].shape) for n in range(3)]
    assert part(drawn).max() == FLOOR


def test_noise_as_large_as_the_answer_halves_the_step() -> None:
    whole = answered(1.0)
    drawn = np.random.default_rng(20)
    noise = [predicted(np.zeros_like(each), 1e-4 * drawn.standard_normal(each.shape), LAW) for each in whole]
    found = part([each + other for each, other in zip(whole, noise, strict=True)])
    np.testing.assert_allclose(found.mean(axis=1), 0.5, atol=0.2)


def noisy(size: float, seed: int) -> np.ndarray:
    """Return what is beside an answer, as a change of the path by so many m in each sample would make it."""
    drawn = size * np.random.default_rng(seed).standard_normal(SENT[0].shape)
    return predicted(np.zeros_like(drawn), drawn, LAW)


def after_a_small_change(error: float) -> np.ndarray:
    """Return the part of a step that is made after a change of 100 µm and one of 2, in noise of 10, by error in µm."""
    sent = [SENT[0], SENT[0] + (SENT[1] - square()), SENT[0] + 1.02 * (SENT[1] - square())]
    come = [predicted(np.zeros_like(each), each, LAW) + noisy(1e-5, 40 + at) for at, each in enumerate(sent)]
    found = heeding(LAW, sent, come, error=noisy(1e-6 * error, 50))
    return found.passed(HEARD) / LAW.passed(HEARD)


def test_a_change_that_noise_hides_takes_nothing_back_of_what_a_large_one_has_proved() -> None:
    assert after_a_small_change(100.0).min() > 0.8


def test_of_errors_as_large_as_noise_little_is_learned() -> None:
    """10 µm in each trial: of 20 µm of error three quarters are learned, of 10 or less next to nothing."""
    assert after_a_small_change(20.0).mean() == pytest.approx(0.75, abs=0.1)
    assert after_a_small_change(10.0).mean() < 0.35
    assert after_a_small_change(2.0).max() == pytest.approx(FLOOR)


def test_an_error_under_a_cut_that_answers_threefold_shrinks_where_it_would_have_grown() -> None:
    wanted = SENT[0]
    off = 1e-4 * np.sin(2 * np.pi * 1.0 * np.arange(len(wanted)) / RATE)[:, None] * [1.0, -1.0, 0.5]

    def milled(sent: np.ndarray) -> np.ndarray:
        return np.asarray(wanted + off + 3.0 * predicted(np.zeros_like(sent), sent - wanted, LAW))

    sent = [wanted, update(wanted, -off, LAW)]
    come = [milled(each) for each in sent]
    by_models, heeded = (
        float(np.abs(wanted - milled(update(sent[1], wanted - come[1], law))).mean())
        for law in (LAW, heeding(LAW, sent, come))
    )
    assert by_models > 3.0 * np.abs(off).mean()
    assert heeded < 0.1 * np.abs(off).mean()


def test_what_was_cautious_before_stays_so() -> None:
    cautious = PathLaw(LAW.axes, LAW.process, caution=(np.array([0.0, 25.0]), np.full((2, 3), 0.5)))
    np.testing.assert_allclose(part(answered(1.0), cautious), 1.0)
    np.testing.assert_allclose(part(answered(4.0), cautious), 0.5, rtol=0.25)


def test_a_direction_that_answers_twofold_is_learned_by_half_and_the_others_whole() -> None:
    law, come = PathLaw(LAW.axes), [np.zeros_like(SENT[0])]
    come.append(come[0] + predicted(np.zeros_like(SENT[0]), SENT[1] - SENT[0], law) * [1.0, 2.0, 1.0])
    found = heeding(law, SENT[:2], come).passed(HEARD) / law.passed(HEARD)
    np.testing.assert_allclose(found, np.tile([1.0, 0.5, 1.0], (len(HEARD), 1)), rtol=0.25)


STEP = 1e-4 * np.sin(2 * np.pi * 0.7 * np.arange(len(SENT[0])) / RATE)[:, None] * [1.0, -0.5, 0.2]
"""A change of the tool that a correction is foreseen to make, m."""
OTHER = np.random.default_rng(30).standard_normal(STEP.shape) * STEP.std()
"""Errors that have nothing to do with it."""


@pytest.mark.parametrize(("share", "expected"), [(1.0, 1.0), (2.0, 1.0), (0.5, 0.5), (0.0, 0.0), (-1.0, 0.0)])
def test_a_correction_is_made_as_far_as_a_witness_saw_the_error_it_corrects(share: float, expected: float) -> None:
    assert witnessed(share * STEP, STEP, LAW) == pytest.approx(expected, abs=1e-6)


def test_a_correction_of_errors_that_a_witness_did_not_see_is_not_made() -> None:
    assert witnessed(OTHER, STEP, LAW) < 0.15


def test_what_is_left_to_a_witness_is_never_surely_more_than_before() -> None:
    for part in (0.1, 0.3, 0.6, 1.0):
        error = part * STEP + 0.5 * OTHER
        share = witnessed(error, STEP, LAW)
        assert np.sum((error - share * STEP) ** 2) <= np.sum(error**2)


def test_noise_far_above_the_cutoff_does_not_count_for_a_witness() -> None:
    fast = 3e-4 * np.sin(2 * np.pi * 60.0 * np.arange(len(STEP)) / RATE)[:, None]
    assert witnessed(STEP + fast, STEP, LAW) == pytest.approx(1.0, abs=0.01)
