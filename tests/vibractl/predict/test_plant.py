"""Vibrators drawn from a model: as uncertain as it says, and distorting."""

from dataclasses import replace

import numpy as np
import pytest

from tests.vibractl.linear_rig import linear_config, linear_matrix
from vibractl.predict.plant import AT_WORK, DrawnPlant, drawn_response
from vibractl.setup import Setup, setup
from vibractl.spectrum import LineSpectrum
from vibractl.transfer_matrix import TransferMatrix


def uncertain(deviation: float) -> TransferMatrix:
    matrix = linear_matrix()
    return replace(matrix, variance=deviation**2 * np.abs(matrix.response) ** 2)


def drawn(made: Setup, seed: int) -> DrawnPlant:
    lines = made.law.matrix.frequency
    spectrum = LineSpectrum(
        made.shot.frames // 4, made.law.matrix.outputs, made.shot.rate / 4, (lines[0], lines[-1]), made.plans
    )
    return DrawnPlant(made.law, spectrum, np.random.default_rng(seed))


@pytest.mark.parametrize("deviation", [1e-3, 0.2])
def test_what_is_drawn_strays_from_the_model_by_as_much_as_it_says(deviation: float) -> None:
    matrix, rng = uncertain(deviation), np.random.default_rng(1)
    strayed = np.stack([drawn_response(matrix, rng) / matrix.response - 1 for _ in range(4)])
    assert np.mean(np.abs(strayed) ** 2) == pytest.approx(deviation**2 + AT_WORK**2, rel=0.2)


def test_neighbouring_lines_stray_together_and_distant_ones_do_not() -> None:
    matrix = uncertain(0.2)
    strayed = (drawn_response(matrix, np.random.default_rng(1)) / matrix.response - 1)[:, 0, 0]

    def together(lines: int) -> float:
        return float(np.abs(np.vdot(strayed[lines:], strayed[:-lines])) / np.vdot(strayed, strayed).real)

    assert together(1) > 0.9
    assert together(40) < 0.2


def test_it_distorts_at_overtones_and_more_when_driven_harder() -> None:
    made = setup(linear_config(), linear_matrix())
    plant, frequency, drive = drawn(made, 1), made.law.matrix.frequency, made.law.start

    def unexplained(scale: float) -> np.ndarray:
        said = plant.respond(scale * drive) - scale * (plant.response @ drive[..., None])[..., 0]
        return np.linalg.norm(said, axis=1)

    gentle, usual = unexplained(0.5), unexplained(1.0)
    second, seventh = (frequency >= 100) & (frequency <= 160), (frequency >= 560) & (frequency <= 600)
    assert np.median(usual[second]) > 3 * np.median(usual[seventh])
    assert np.median(usual[second]) > 3 * np.median(gentle[second])


def test_one_side_alone_and_one_drive_for_both_are_drawn_as_well() -> None:
    for override in ("learning.side=1", "learning.structure=common"):
        made = setup(linear_config(override), linear_matrix())
        assert drawn(made, 1).respond(made.law.start).shape == made.law.reference.shape


def test_more_coils_than_accelerometers_are_drawn_as_well() -> None:
    matrix = linear_matrix()
    parts = {name: getattr(matrix, name)[:, :1] for name in ("response", "variance", "coherence")}
    made = setup(linear_config("audio.response_channels=[1]"), replace(matrix, **parts))
    assert drawn(made, 1).respond(made.law.start).shape == (len(made.law.matrix.frequency), 1)


def test_a_seed_is_one_vibrator() -> None:
    made = setup(linear_config(), linear_matrix())
    first, again, other = (drawn(made, seed).respond(made.law.start) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert not np.allclose(first, other)
