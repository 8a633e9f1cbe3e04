"""The bench: channels go where they are wired, converters saturate, and a wrong plant is refused in words."""

from types import SimpleNamespace

import numpy as np
import pytest

from ctlblocks.block import Block, Port
from firmware_sim.laboratory import Laboratory, Wiring, plant_block


class Follow(Block):
    """Return the drive, as an acceleration."""

    inputs = (Port("drive", "V", 2),)
    outputs = (Port("response", "m/s^2", 2),)

    def process(self, drive: np.ndarray, response: np.ndarray) -> None:
        response[:] = drive


class Afar(Follow):
    """Return twice the first drive as a pressure as well."""

    outputs = (Port("response", "m/s^2", 2), Port("far_field", "Pa", 1))

    def process(self, drive: np.ndarray, response: np.ndarray, far_field: np.ndarray) -> None:  # type: ignore[override]
        response[:] = drive
        np.multiply(drive[:, :1], 2.0, out=far_field)


def prepared(wiring: Wiring) -> Laboratory:
    laboratory = Laboratory(Follow(), wiring)
    laboratory.prepare(44_100.0, 2)
    return laboratory


def test_channels_and_full_scales_are_those_of_the_wiring() -> None:
    wiring = Wiring((4, 1), (2, 5), 2, 1, output_full_scale=10.0, input_full_scale=40.0)
    assert (wiring.outputs, wiring.inputs) == (4, 5)
    recorded = np.full((2, 5), np.nan)
    prepared(wiring).step(np.array([[0.1, 0.2, 0.3, 0.4], [0.5, 0.6, 0.7, 0.8]]), recorded)
    np.testing.assert_allclose(recorded, [[0.2, 0.1, 0, 0, 0.025], [0.6, 0.2, 0, 0, 0.125]])


def test_both_converters_saturate_at_full_scale() -> None:
    recorded = np.zeros((2, 3))
    played = np.array([[1.5, -2.0, 3.0], [0.1, 0.0, -0.5]])
    prepared(Wiring(output_full_scale=10.0, input_full_scale=40.0)).step(played, recorded)
    np.testing.assert_allclose(recorded, [[0.25, -0.25, 1.0], [0.025, 0.0, -0.5]])
    prepared(Wiring(output_full_scale=10.0, input_full_scale=5.0)).step(0.9 * played, recorded)
    np.testing.assert_allclose(recorded, [[1.0, -1.0, 1.0], [0.18, 0.0, -0.45]])


def test_a_card_opened_with_fewer_channels_plays_nothing_on_the_others() -> None:
    recorded = np.zeros((2, 1))
    prepared(Wiring()).step(np.full((2, 1), 0.4), recorded)
    np.testing.assert_allclose(recorded, 0.4 * 10 / 400)


@pytest.mark.parametrize(
    ("name", "options", "reason"),
    [
        ("wibrator", {}, "simulator.plant is 'wibrator', must be vibrator, vibrator-array, impulse-response, "),
        ("no.such:Plant", {}, "simulator.plant, no.such:Plant: there is no module no"),
        ("math:flor", {}, "simulator.plant, math:flor: module math has no flor; did you mean floor"),
        ("math:floor", {}, "simulator.plant, math:floor is a builtin_function_or_method, must be the class of a Block"),
        ("builtins:dict", {"a": 1}, "simulator.plant, builtins:dict is another class, must be the class of a Block"),
        (
            "vibrator",
            {"sed": 1},
            "Vibrator does not take .* argument 'sed'; there are seed, nonlinearity",
        ),
        ("vibrator", {"seed": -1}, "simulator.options.seed is -1"),
        ("impulse-response", {}, "ImpulseResponse does not take .* it needs 'files'; there are files, gain"),
    ],
)
def test_a_plant_that_cannot_be_built_is_refused_with_the_reason(name: str, options: dict, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        plant_block(name, options)


def test_a_plant_that_does_not_fit_the_wiring_is_refused() -> None:
    with pytest.raises(ValueError, match=r"Follow has inputs 2 x V .* must have 1 x V and"):
        Laboratory(Follow(), Wiring(drive_channels=(1,)))


def test_a_hydrophone_is_recorded_on_its_channel_at_its_own_full_scale() -> None:
    wiring = Wiring(input_full_scale=40.0, far_field_channels=(5,), far_field_full_scale=100.0)
    assert wiring.inputs == 5
    laboratory, recorded = Laboratory(Afar(), wiring), np.full((2, 5), np.nan)
    laboratory.prepare(44_100.0, 2)
    laboratory.step(np.array([[0.1, 0.2, 0.3], [0.4, 0.5, 0.6]]), recorded)
    np.testing.assert_allclose(recorded, [[0.025, 0.05, 0.3, 0, 0.02], [0.1, 0.125, 0.6, 0, 0.08]])


def test_a_hydrophone_need_not_be_plugged_in() -> None:
    laboratory, recorded = Laboratory(Afar(), Wiring()), np.zeros((2, 3))
    laboratory.prepare(44_100.0, 2)
    laboratory.step(np.full((2, 3), 0.4), recorded)
    np.testing.assert_allclose(recorded, [[0.01, 0.01, 0.4]] * 2)


@pytest.mark.parametrize(("plant", "channels"), [(Follow(), (4,)), (Afar(), (4, 5))])
def test_other_hydrophones_than_the_plant_has_cannot_be_plugged_in(plant: Block, channels: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match=rf"must have 2 x V and 2 x m/s\^2, {len(channels)} x Pa, as audio"):
        Laboratory(plant, Wiring(far_field_channels=channels))


def test_what_a_rig_file_does_not_say_of_the_wiring_is_as_by_default() -> None:
    assert Wiring.of(SimpleNamespace(drive_channels=(2,), rate=1)) == Wiring(drive_channels=(2,))
    said = SimpleNamespace(far_field_channels=(7,), far_field_full_scale=20.0)
    assert Wiring.of(said) == Wiring(far_field_channels=(7,), far_field_full_scale=20.0)


def test_anybodys_block_on_the_path_can_be_the_plant() -> None:
    block = plant_block("firmware_sim.plant_blocks:Vibrator", {"seed": 2})
    assert type(block).__name__ == "Vibrator"
