"""What hydrophones should hear, and when."""

from dataclasses import replace

import numpy as np
import pytest

from firmware_sim.plants.vibrator_array import VibratorArrayPlant
from tests.vibractl.far_field_plant import LINEAR, RATE, STEADY, far_config, far_model
from vibractl.place import Place, at_accelerometers
from vibractl.quality import Judge
from vibractl.setup import Setup, setup


def made(hydrophones: int, *overrides: str, distance: float = 10.0) -> Setup:
    matrix, far = far_model(hydrophones, distance)
    return setup(far_config(hydrophones, *overrides), matrix, far=far)


@pytest.mark.parametrize("distance", [10.0, 150.0])
def test_what_the_plant_radiates_is_what_the_reference_becomes_at_the_hydrophones(distance: float) -> None:
    """Whatever the shells do, taken as the reference: the plant's own sound leaves no error, however far away."""
    run = made(2, distance=distance)
    rng, shot, total = np.random.default_rng(1), run.shot, run.shot.total
    drive = np.zeros((total, 2))
    drive[shot.window] = rng.standard_normal((shot.frames, 2)) * np.hanning(shot.frames)[:, None] ** 2
    plant = VibratorArrayPlant(
        RATE, vibrators=1, hydrophones=2, medium="water", distance=distance, **{**STEADY, **LINEAR}
    )
    response, pressure = np.zeros((total, 2)), np.zeros((total, 2))
    plant.run(drive, response, pressure)
    near, far = (Judge(run, place) for place in run.places)
    felt, heard = near.lines(-near.error(response)), far.lines(-far.error(pressure))
    felt += near.lines(near.place.reference)
    heard += far.lines(far.place.reference)
    inside = (near.frequency > 30) & (near.frequency < 600)
    lines = run.law.matrix.frequency
    transfer = run.places[1].transfer[np.searchsorted(lines, near.frequency[inside] - 1e-6)]
    expected = (transfer @ felt[inside][..., None])[..., 0]
    assert np.linalg.norm(heard[inside] - expected) < 2e-3 * np.linalg.norm(expected)


def test_the_far_reference_has_the_level_of_the_sound_of_both_shells() -> None:
    far = made(1).places[1]
    loudest = 1000.0 * 0.3 / (8 * np.pi) * 10.0 * (1 / 9.5 + 1 / 10.5)
    assert np.abs(far.reference).max() == pytest.approx(loudest, rel=0.02)
    assert (far.unit, far.prefix, far.sensors) == ("Pa", "far_", (0,))


def test_one_side_alone_is_heard_without_the_other() -> None:
    far = made(1, "learning.side=2", "learning.sensors=far-field").places[1]
    assert np.abs(far.reference).max() == pytest.approx(1000.0 * 0.3 / (8 * np.pi) * 10.0 / 9.5, rel=0.04)


def test_a_hydrophone_that_hears_later_than_the_shot_lasts_is_refused() -> None:
    matrix, far = far_model(2)
    later = replace(far, delay=far.delay + np.array([0.0, 0.4]))
    with pytest.raises(ValueError, match=r"hydrophone 2 hears the vibrator 0.406 s late, must be <= shot.tail, 0.4 s"):
        setup(far_config(2), matrix, far=later)


def test_a_far_field_objective_needs_a_model_with_a_far_field() -> None:
    matrix, _ = far_model(1)
    with pytest.raises(ValueError, match="quality.where is far-field, but the model was measured without hydrophones"):
        setup(far_config(1), matrix)


def test_without_a_far_objective_an_old_model_does() -> None:
    matrix, _ = far_model(1)
    assert len(setup(far_config(1, "quality.where=accelerometers"), matrix).places) == 1


def test_a_frame_begins_later_where_sound_comes_later() -> None:
    near = at_accelerometers(np.zeros((3, 2)), (0, 1))
    heard = np.arange(20.0).reshape(10, 2)
    np.testing.assert_array_equal(near.frame(heard, 2), heard[2:5])
    far = Place("far-field", (0, 1), np.zeros((3, 2)), (1, 4))
    np.testing.assert_array_equal(far.frame(heard, 2), np.stack([heard[3:6, 0], heard[6:9, 1]], axis=1))
