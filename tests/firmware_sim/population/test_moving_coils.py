"""The family `moving-coil`: by name only, the same everywhere, within its ranges, and linear when faint."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from firmware_sim.plants.moving_coil import Heating, MovingCoil, MovingCoilPlant
from firmware_sim.plants.moving_coil_response import linear_response
from firmware_sim.plants.reception import Sensors, silent_reception
from firmware_sim.plants.suspension_drift import Softening
from firmware_sim.population import Vibrator
from firmware_sim.population.draw import Draw
from firmware_sim.population.machine import Machine
from firmware_sim.population.moving_coil_draw import EXCURSION, FRACTION, draw_moving_coil
from firmware_sim.population.vibrators import MOVING_COIL, VIBRATORS
from rigkit.config import load
from rigkit.toml_text import value_text
from tests.firmware_sim.population.census import checksum, fills, numbers
from vibractl.config import RigConfig

RATE = 44_100
CHECKSUM = "0910e7dc19caf07a"
"""Of all that is drawn by five seeds, to six digits."""


@cache
def draws() -> list[Draw]:
    """Draw the first seeds, once."""
    return [VIBRATORS.draw(seed, MOVING_COIL) for seed in range(80)]


def whole(machine: Machine) -> MovingCoil:
    """Return a machine's whole description."""
    described: MovingCoil = machine.respond.args[0]  # type: ignore[attr-defined]
    return described


def test_no_seed_chooses_it() -> None:
    assert MOVING_COIL not in VIBRATORS.families
    assert MOVING_COIL not in {VIBRATORS.family(seed) for seed in range(300)}
    assert draws()[7].command == "firmware-sim draw vibrator --seed 7 --family moving-coil"


def test_a_seed_is_the_same_machine_everywhere() -> None:
    assert checksum(draws()[:5]) == CHECKSUM
    assert checksum(draws()[:5]) == checksum(VIBRATORS.draw(seed, MOVING_COIL) for seed in range(5))


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [
        ("coils", 1, 3),
        ("first resonance", 15, 40),
        ("first break-up", 120, 600),
        ("mounts' resonance", 2, 8),
        ("moving mass", 0.045, 11),
        ("gas swept at x_max", 3e-4, 0.1),
        ("x_max", 1e3 * EXCURSION[0], 1e3 * EXCURSION[1]),
        ("excursion of the reference over x_max", *FRACTION),
        ("coil's warming by the reference", 0.5, 40),
        ("drive needed over reference, rms", 0.003, 3),
    ],
)
def test_what_is_drawn_is_within_its_range_and_fills_it(name: str, low: float, high: float) -> None:
    assert fills(numbers(draws(), name), low, high, 0.3)


def test_bl_or_the_suspension_ends_x_max_and_never_both_by_chance() -> None:
    field, spring = numbers(draws(), "Bl left at x_max"), numbers(draws(), "compliance left at x_max")
    assert ((field == 0.82) ^ (spring == 0.75)).all()
    assert 0.3 < np.mean(field == 0.82) < 0.7


@pytest.mark.slow
@pytest.mark.sample(2)
@pytest.mark.parametrize("seed", range(5))
def test_faint_it_responds_as_it_says(seed: int) -> None:
    """With seal, hum, noise and heat off, and sensors that bend no more."""
    machine = draw_moving_coil(MOVING_COIL, seed)
    described = whole(machine)
    straight = described.reception.sensors
    reception = silent_reception(
        Sensors(straight.delay, straight.resonance, straight.damping, np.zeros_like(straight.bend))
    )
    faint = replace(
        described,
        large=replace(described.large, seal=()),
        heating=Heating(),
        softening=Softening(),
        reception=reception,
    )
    frames, units = 8 * RATE, machine.widths[0]
    drive, heard = np.zeros((frames, units)), np.zeros((frames, units))
    drive[0, 0] = 1e-3 * machine.level
    MovingCoilPlant(faint, RATE, seed).run(drive, heard)
    frequency = np.fft.rfftfreq(frames, 1 / RATE)
    inside = (frequency > 10) & (frequency < 650)
    response = np.fft.rfft(heard, axis=0)[inside] / drive[0, 0]
    wanted = machine.respond(frequency[inside])[:, :, 0]
    sensor = straight.response(frequency[inside])
    error = np.abs(response - wanted) / np.abs(sensor)
    assert (error.max(axis=1) / np.abs(wanted / sensor).max(axis=1)).max() < 0.01
    np.testing.assert_array_equal(machine.respond(frequency[1:9]), linear_response(described, frequency[1:9]))


@pytest.mark.slow
@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", [1, 6, 19])
def test_its_distortion_grows_with_level(seed: int) -> None:
    """The overtones of a sine of 45 Hz, over itself, at one drive and at four times that."""
    described = whole(draw_moving_coil(MOVING_COIL, seed))
    silent = replace(
        described, large=replace(described.large, seal=()), heating=Heating(), softening=Softening(),
        reception=silent_reception(described.reception.sensors),
    )  # fmt: skip
    units, ratios = len(described.moving.mass), []
    peak = draws()[seed].keys["limits.peak"] / 4
    for size in (0.25 * peak, peak):
        drive = size * np.sin(2 * np.pi * 45 * np.arange(3 * RATE) / RATE)[:, None] * np.ones(units)
        heard = np.zeros_like(drive)
        MovingCoilPlant(silent, RATE, seed).run(drive, heard)
        size_of = np.abs(np.fft.rfft(heard[-RATE:, 0]))
        ratios.append(np.linalg.norm(size_of[90:360:45]) / size_of[45])
    assert 2 < ratios[1] / ratios[0] < 40


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", range(0, 80, 16))
@pytest.mark.slow
def test_a_rig_file_fits_it_and_its_limit_does_not_upset_it(seed: int) -> None:
    draw = draws()[seed]
    load(None, RigConfig, [f"{key}={value_text(value)}" for key, value in draw.keys.items()])
    block = Vibrator(seed=seed, family=MOVING_COIL)
    block.prepare(float(RATE), RATE // 2)
    rng = np.random.default_rng(seed)
    drive = draw.keys["limits.peak"] * np.clip(rng.standard_normal((RATE // 2, block.inputs[0].width)), -1, 1)
    heard = np.zeros_like(drive)
    for _ in range(2):
        block.process(drive, heard)
        assert np.isfinite(heard).all()
    assert heard.any()


def test_no_reference_asks_for_more_excursion_than_it_is_made_for() -> None:
    for draw in draws():
        machine = draw_moving_coil(MOVING_COIL, draw.seed)
        levels = [each.value for each in draw.quantities if each.name.startswith("level of reference")]
        assert all(level <= most * 1.001 for level, most in zip(levels, machine.most, strict=True))
        assert levels[0] == pytest.approx(machine.level, rel=1e-3)


@pytest.mark.slow
def test_a_seed_runs_the_same_twice() -> None:
    """To the last bit, noise and all."""
    machine = draw_moving_coil(MOVING_COIL, 3)
    drive = 0.1 * np.random.default_rng(1).standard_normal((9_000, machine.widths[0]))
    runs = [np.zeros_like(drive) for _ in range(2)]
    for heard in runs:
        machine.build(float(RATE)).run(drive, heard)
    np.testing.assert_array_equal(*runs)
