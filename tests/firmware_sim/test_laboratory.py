"""The bench: channels go where they are wired, converters saturate, and a wrong plant is refused in words."""

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
        ("math:floor", {}, "simulator.plant is 'math:floor', must be the class of a Block"),
        ("builtins:dict", {"a": 1}, "simulator.plant is 'builtins:dict', must be the class of a Block"),
        ("vibrator", {"sed": 1}, "'vibrator': got an unexpected keyword argument 'sed'; there are seed, nonlinearity"),
        ("vibrator", {"seed": -1}, "simulator.options.seed is -1"),
        ("impulse-response", {}, "'impulse-response': missing a required argument: 'files'; there are files, gain"),
    ],
)
def test_a_plant_that_cannot_be_built_is_refused_with_the_reason(name: str, options: dict, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        plant_block(name, options)


def test_a_plant_that_does_not_fit_the_wiring_is_refused() -> None:
    with pytest.raises(ValueError, match=r"Follow has inputs \[\('V', 2\)\] .* wired for inputs \[\('V', 1\)\]"):
        Laboratory(Follow(), Wiring(drive_channels=(1,)))


def test_anybodys_block_on_the_path_can_be_the_plant() -> None:
    block = plant_block("firmware_sim.plant_blocks:Vibrator", {"seed": 2})
    assert type(block).__name__ == "Vibrator"
