"""What has been changed about a rig is named; a poor model, or a machine that has moved, is not taken for it."""

from collections.abc import Callable

import numpy as np
import pytest

from vibractl.learning.changed_rig import Change, change_of

FREQUENCY = np.arange(40.0, 90.0, 0.5)
Channels = Callable[[np.ndarray], np.ndarray]


def matrix(sides: int, generator: np.random.Generator) -> np.ndarray:
    """Return a matrix (lines, sides, sides) with resonances; coils are heard at the other sides at a third."""
    place, damping = generator.uniform(30, 100, (sides, sides)), 0.05
    mode = 1 / (1 - (FREQUENCY[:, None, None] / place) ** 2 + 2j * damping * FREQUENCY[:, None, None] / place)
    response: np.ndarray = mode * np.where(np.eye(sides) > 0, 1.0, 0.33)
    return response


def found(
    sides: int = 2,
    at_drives: Channels = lambda lines: lines,
    at_responses: Channels = lambda lines: lines,
    wrong: float = 0.15,
    seed: int = 0,
) -> Change | None:
    """Return what is found of a rig whose channels pass through these on the way, with a model that wrong."""
    generator = np.random.default_rng(seed)
    true = matrix(sides, generator)
    drive = np.exp(2j * np.pi * generator.uniform(size=(len(FREQUENCY), sides)))
    heard = at_responses((true @ at_drives(drive)[..., None])[..., 0])
    error = generator.normal(size=(*true.shape, 2)) @ (1, 1j) / np.sqrt(2)
    return change_of(true + wrong * np.abs(true) * error, drive, heard, FREQUENCY)


def channel(number: int, gain: float, late: float = 0.0) -> Channels:
    """Return what a channel, counted from 1, with another gain and `late` s does to all (lines, channels)."""

    def through(lines: np.ndarray) -> np.ndarray:
        changed = lines.copy()
        changed[:, number - 1] *= gain * np.exp(-2j * np.pi * FREQUENCY * late)
        return changed

    return through


def exchanged(lines: np.ndarray) -> np.ndarray:
    return lines[:, [1, 0, *range(2, lines.shape[1])]]


def turned(lines: np.ndarray) -> np.ndarray:
    return -lines


@pytest.mark.parametrize("sides", [1, 2, 3, 6])
@pytest.mark.parametrize("wrong", [0.0, 0.15, 0.3])
@pytest.mark.parametrize("seed", range(5))
def test_of_a_rig_that_is_the_calibrated_one_nothing_is_said(sides: int, wrong: float, seed: int) -> None:
    assert found(sides, wrong=wrong, seed=seed) is None


@pytest.mark.parametrize("wrong", [0.6, 1.0, 5.0])
@pytest.mark.parametrize("seed", range(5))
def test_a_model_that_says_nothing_of_the_machine_is_not_taken_for_a_change(wrong: float, seed: int) -> None:
    assert found(wrong=wrong, seed=seed) is None


def test_a_poor_model_of_coils_that_do_nearly_the_same_is_not_taken_for_gains_of_each() -> None:
    """Four gains fit to it what nothing has done: by one limit for all, one in eight such was taken for a change."""
    told = []
    for seed in range(60):
        generator = np.random.default_rng(seed)

        def wandering(*sides: int, generator: np.random.Generator = generator) -> np.ndarray:
            steps: np.ndarray = generator.normal(size=(len(FREQUENCY), *sides, 2)) @ (1, 1j)
            return steps.cumsum(axis=0)

        common = np.exp(2j * np.pi * 0.003 * FREQUENCY)[:, None, None] * (1 + 0.04 * wandering(1, 1))
        true = common + 0.033 * wandering(4, 4)
        believed = true + 0.067 * wandering(4, 4)
        wanted = np.broadcast_to(generator.normal(size=(4, 2)) @ (1, 1j), (len(FREQUENCY), 4))
        drive = np.linalg.solve(believed, wanted[..., None])
        told.append(change_of(believed, drive[..., 0], (true @ drive)[..., 0], FREQUENCY))
    assert sum(each is not None for each in told) <= 1


@pytest.mark.parametrize("sides", [2, 4])
@pytest.mark.parametrize("seed", range(3))
def test_a_gain_of_all_coils_is_named_by_a_poor_model(sides: int, seed: int) -> None:
    """As of a volume that was turned down: the gains that fit differ by what the model is off."""
    change = found(sides, at_drives=lambda lines: 0.4 * lines, wrong=0.2, seed=seed)
    assert change is not None
    assert "times as large" in change.text


@pytest.mark.parametrize("sides", [2, 3])
@pytest.mark.parametrize("seed", range(3))
def test_unlike_gains_of_two_coils_are_named_where_the_model_is_good(sides: int, seed: int) -> None:
    change = found(sides, at_drives=lambda lines: channel(2, 2.0)(channel(1, 0.4)(lines)), seed=seed)
    assert change is not None
    assert change.text.startswith("drive 1 is 0.")
    assert "; drive 2 is " in change.text


@pytest.mark.parametrize("sides", [2, 3])
@pytest.mark.parametrize(
    ("change", "text"),
    [
        (channel(2, -1.0), "response 2 is turned round (its polarity)"),
        (channel(1, 0.5), "response 1 is 0.5 times as large"),
        (channel(2, 2.0), "response 2 is 2 times as large"),
        (channel(2, 1e-3), "response 2 is silent"),
        (channel(2, 1.0, late=5e-3), "response 2 comes 5.1 ms late"),
        (exchanged, "response 1 is where response 2 was; response 2 is where response 1 was"),
    ],
)
def test_a_sensor_that_was_changed_is_named(sides: int, change: Channels, text: str) -> None:
    seen = found(sides, at_responses=change, wrong=0.03)
    assert seen is not None
    assert seen.text == text
    assert seen.left < 0.4 * seen.off


@pytest.mark.parametrize("sides", [2, 3])
@pytest.mark.parametrize(
    ("change", "text"),
    [
        (channel(1, -1.0), "drive 1 is turned round (its polarity)"),
        (channel(2, 0.4), "drive 2 is 0.4 times as large"),
        (channel(2, 2.5), "drive 2 is 2.5 times as large"),
        (channel(1, 0.0), "drive 1 is silent"),
        (exchanged, "drive 1 is where drive 2 was; drive 2 is where drive 1 was"),
    ],
)
def test_a_coil_that_was_changed_is_named(sides: int, change: Channels, text: str) -> None:
    seen = found(sides, at_drives=change, wrong=0.03)
    assert seen is not None
    assert seen.text == text


@pytest.mark.parametrize("at", ["at_drives", "at_responses"])
def test_what_may_be_one_thing_or_another_is_named_as_both(at: str) -> None:
    seen = found(2, **{at: turned})  # type: ignore[arg-type]
    assert seen is not None
    assert sorted(seen.text.split(", or: ")) == [
        "every drive is turned round (its polarity)",
        "every response is turned round (its polarity)",
    ]


def test_channels_that_hear_the_same_are_not_said_to_be_exchanged() -> None:
    """As where a model's inverse has made every side do as the reference does."""
    generator = np.random.default_rng(1)
    true = matrix(2, generator)
    drive = np.linalg.solve(true, np.ones((len(FREQUENCY), 2, 1)))[..., 0]
    heard = (true @ drive[..., None])[..., 0]
    assert change_of(true, drive, heard[:, ::-1], FREQUENCY) is None
    heard[:, 1] *= -1
    seen = change_of(true, drive, heard, FREQUENCY)
    assert seen is not None
    assert seen.text == "response 2 is turned round (its polarity)"


def test_a_few_lines_tell_nothing() -> None:
    few = np.ones((5, 1, 1), complex)
    assert change_of(few, few[..., 0], -few[..., 0], FREQUENCY[:5]) is None
