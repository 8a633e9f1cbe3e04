"""Learning from hydrophones: what is controlled, what is left open, and how weights settle a conflict."""

import numpy as np
import pytest

from rigkit import config as rig_file
from rigkit.config import ConfigError
from tests.vibractl.far_field_plant import far_config, far_model
from tests.vibractl.learning.line_plant import LinePlant, law_of, matrix_of, modal
from vibractl.config import Adaptation, Learning, RigConfig, Watch
from vibractl.learning.algorithm import Algorithm
from vibractl.learning.law import bounded_inverse
from vibractl.setup import Setup, setup

FAR = "learning.sensors=far-field"


def made(hydrophones: int, *overrides: str) -> Setup:
    matrix, far = far_model(hydrophones)
    return setup(far_config(hydrophones, FAR, *overrides), matrix, far=far)


def test_the_plant_is_the_far_transfer_times_the_vibrators() -> None:
    law, (matrix, far) = made(2).law, far_model(2)
    frequency = law.matrix.frequency
    late = np.array(made(2).learned.late) * 4 / 44_100
    turned = np.exp(2j * np.pi * np.outer(frequency, late))[..., None]
    expected = far.at(frequency).response * turned @ matrix.at(frequency).response
    np.testing.assert_allclose(law.matrix.response, expected, atol=1e-9)
    assert law.reference.shape[1] == 2
    assert (law.matrix.variance > 0).all()


def test_one_hydrophone_leaves_the_share_of_each_coil_to_the_smallest_drive() -> None:
    run = made(1)
    plant, start = run.law.matrix.response[:, 0], run.law.start
    np.testing.assert_allclose(start[:, 0] * plant[:, 1].conj(), start[:, 1] * plant[:, 0].conj(), atol=1e-12)
    assert run.note.startswith("1 hydrophone and 2 coils: only what they do together at the hydrophones is controlled")
    assert made(2).note == ""
    assert made(1, "learning.structure=common").note == ""


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        (("quality.where=far-field",), "quality.where is far-field, but audio.far_field_channels is empty"),
        ((FAR,), "learning.sensors is far-field, but audio.far_field_channels is empty"),
        (("audio.far_field_channels=[4]", FAR), "learning.sensors is far-field, but quality.where is accelerometers"),
        (("learning.weights=[1.0]",), r"learning.weights is \[1.0\], must be 2 numbers >= 0, not all 0"),
        (("learning.weights=[0.0,0.0]",), "must be 2 numbers >= 0, not all 0"),
        (("learning.weights=[-1.0,1.0]",), "must be 2 numbers >= 0, not all 0"),
        (
            ("audio.far_field_channels=[4]", FAR, "quality.where=far-field", "learning.weights=[1.0,2.0]"),
            "must be 1 num",
        ),
    ],
)
def test_sensors_that_are_not_there_are_refused(settings: tuple[str, ...], said: str) -> None:
    with pytest.raises(ConfigError, match=said):
        rig_file.load(None, RigConfig, settings)


def test_what_leaves_out_elements_of_g_cannot_be_learned_from_afar() -> None:
    with pytest.raises(
        ValueError, match="structure is decentralised: learning.sensors is far-field, must be accelerom"
    ):
        made(2, "learning.structure=decentralised", "learning.law=thesis")


def conflict(weights: tuple[float, ...]) -> np.ndarray:
    """Return the error (3,) that two coils leave at three accelerometers, which want what cannot be had together."""
    rng = np.random.default_rng(4)
    response = rng.standard_normal((1, 3, 2)) + 1j * rng.standard_normal((1, 3, 2))
    wanted = np.ones((1, 3, 1), complex)
    inverse = bounded_inverse(response, Learning(weights=weights, epsilon=0.0, floor=0.0))
    return np.abs((wanted - response @ inverse @ wanted)[0, :, 0])


def test_three_accelerometers_and_two_coils_share_the_error_by_their_weights() -> None:
    plain, third, without = conflict(()), conflict((1.0, 1.0, 10.0)), conflict((1.0, 1.0, 0.0))
    assert third[2] < 0.1 * plain[2]
    assert np.linalg.norm(third[:2]) > np.linalg.norm(plain[:2])
    np.testing.assert_allclose(without[:2], 0.0, atol=1e-9)
    assert without[2] > plain[2]
    np.testing.assert_array_equal(conflict((1.0, 1.0, 1.0)), plain)


def test_the_weighted_inverse_is_the_least_squares_solution() -> None:
    rng, weight = np.random.default_rng(5), np.array([1.0, 3.0, 0.5])
    response, wanted = rng.standard_normal((1, 3, 2)) + 0j, rng.standard_normal(3) + 0j
    drive = bounded_inverse(response, Learning(weights=tuple(weight), epsilon=0.0, floor=0.0))[0] @ wanted
    best = np.linalg.lstsq(weight[:, None] * response[0], weight * wanted, rcond=None)[0]
    np.testing.assert_allclose(drive, best, atol=1e-9)


def test_weights_are_those_of_the_side_that_is_controlled() -> None:
    law = made(2, "learning.weights=[1.0,2.0]").law
    np.testing.assert_array_equal(law.settings.weights, (1.0, 2.0))
    matrix, far = far_model(2)
    one = setup(far_config(2, "learning.side=2", "learning.weights=[1.0,5.0]"), matrix, far=far).law
    assert one.settings.weights == (5.0,)


def learned_error(weights: tuple[float, ...]) -> np.ndarray:
    """Return the rms error (3,) that learning leaves at three accelerometers on two coils, re the reference's."""
    response = modal(3, 2)
    law = law_of(matrix_of(response), weights=weights)
    plant, algorithm = LinePlant(response, law), Algorithm(law, Adaptation(), Watch(), -40.0)
    for _ in range(6):
        algorithm.step(plant.shot(algorithm.lines))
    error = law.reference - plant.shot(algorithm.lines).response
    return np.asarray(np.linalg.norm(error, axis=0) / np.linalg.norm(law.reference, axis=0))


def test_learning_settles_where_the_weights_say() -> None:
    plain, third = learned_error(()), learned_error((1.0, 1.0, 10.0))
    assert third[2] < 0.1 * plain[2]
    assert np.linalg.norm(third[:2]) > np.linalg.norm(plain[:2])
    np.testing.assert_allclose(learned_error((1.0, 1.0, 0.0))[:2], 0.0, atol=0.01)
