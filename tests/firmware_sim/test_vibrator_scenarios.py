"""What can happen to a simulated vibrator: it warms, a mode moves, it is stronger than usual, it is put into water."""

import numpy as np
import pytest

from firmware_sim.plants.immersion import FLUID_MASS, flexure_in_water, immersed_modes
from firmware_sim.plants.modal_drift import ModalDrift
from firmware_sim.plants.vibrator import VibratorPlant
from firmware_sim.plants.vibrator_modes import SHELL_AREA, flexural_modes, vibrator_modes
from firmware_sim.plants.vibrator_options import VibratorOptions

RATE = 44_100
STILL = {"drift": 0.0, "noise": -300.0, "hum": -300.0}


def moved(seconds: float, **options: float) -> np.ndarray:
    """Return by what part of itself each of seed 1's modal frequencies has moved."""
    rng = np.random.default_rng(1)
    modes = vibrator_modes(rng)
    drift = ModalDrift(modes, VibratorOptions(**({"drift": 0.0} | options)), rng)
    return drift.at(seconds) / modes.frequency - 1


def transfer_matrix(seed: int = 1, begin: int = 0, **options: object) -> np.ndarray:
    """Return the linear plant's responses (1400, 2, 2), 0.5 Hz apart, to impulses after `begin` seconds."""
    columns = []
    for coil in range(2):
        drive = np.zeros(((begin + 2) * RATE, 2))
        drive[begin * RATE, coil] = 1.0
        response = np.zeros_like(drive)
        VibratorPlant(RATE, seed=seed, **(STILL | {"nonlinearity": 0.0} | options)).run(drive, response)
        columns.append(np.fft.rfft(response[begin * RATE :], axis=0)[:1400])
    return np.stack(columns, axis=-1)


def overtones(root: float, volts: float, **options: object) -> tuple[float, np.ndarray]:
    """Return the amplitude at `root` Hz, m/s^2, and the levels of overtones 2 to 5 against it, dB."""
    time = np.arange(4 * RATE) / RATE
    drive = np.repeat(volts * np.sin(2 * np.pi * root * time)[:, None], 2, axis=1)
    response = np.zeros_like(drive)
    VibratorPlant(RATE, **(STILL | options)).run(drive, response)
    lines = np.abs(np.fft.rfft(response[2 * RATE :, 0])) / RATE
    return lines[int(2 * root)], 20 * np.log10(
        lines[[int(2 * root * order) for order in (2, 3, 4, 5)]] / lines[int(2 * root)]
    )


def test_a_trend_moves_all_modes_alike_steadily_and_then_holds_them() -> None:
    for seconds, expected in ((0.0, 0.0), (50.0, 0.01), (100.0, 0.02), (5000.0, 0.02)):
        np.testing.assert_allclose(moved(seconds, trend=0.02, trend_seconds=100.0), expected, atol=1e-12)
    np.testing.assert_allclose(moved(100.0, trend=-0.05, trend_seconds=50.0), -0.05, atol=1e-12)


def test_the_resonances_of_the_plant_follow_the_trend() -> None:
    before = np.abs(transfer_matrix()[:, 0, 0])
    after = np.abs(transfer_matrix(begin=2, trend=0.02, trend_seconds=1.0)[:, 0, 0])
    frequency = np.arange(1400) / 2
    stretched = np.interp(frequency, 1.02 * frequency, before)
    band = (frequency > 60) & (frequency < 640)
    assert np.linalg.norm((after - stretched)[band]) < 0.06 * np.linalg.norm(before[band])
    assert np.linalg.norm((after - before)[band]) > 0.3 * np.linalg.norm(before[band])


def test_the_swing_of_each_mode_goes_on_under_a_trend() -> None:
    alone, both = moved(300.0, drift=0.01), moved(300.0, drift=0.01, trend=0.02, trend_seconds=100.0)
    assert np.ptp(alone) > 0.005
    np.testing.assert_allclose(1 + both, (1 + alone) * 1.02, rtol=1e-12)


@pytest.mark.parametrize("widths", [1.0, -2.0])
def test_one_mode_moves_by_widths_from_a_given_time_on(widths: float) -> None:
    modes = vibrator_modes(np.random.default_rng(1))
    mode = int(np.argmin(np.abs(modes.frequency - 545)))
    options = {"moving_mode": 545.0, "moving_widths": widths, "moving_at": 20.0, "moving_seconds": 10.0}
    for seconds, part in ((19.9, 0.0), (25.0, 0.5), (30.0, 1.0), (900.0, 1.0)):
        expected = np.zeros(len(modes.frequency))
        expected[mode] = part * widths * 2 * modes.damping[mode]
        np.testing.assert_allclose(moved(seconds, **options), expected, atol=1e-12)
    jump = moved(20.0, moving_mode=545.0, moving_widths=widths, moving_at=20.0)
    assert jump[mode] == pytest.approx(widths * 2 * modes.damping[mode])


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_mode_that_moves_by_its_width_makes_another_plant_there_and_there_only(seed: int) -> None:
    before, after = transfer_matrix(seed)[60:1300], transfer_matrix(seed, moving_mode=545.0, moving_at=0.0)[60:1300]
    change, frequency = (
        np.linalg.norm(after @ np.linalg.inv(before) - np.eye(2), 2, axis=(1, 2)),
        np.arange(60, 1300) / 2,
    )
    assert change[(frequency > 500) & (frequency < 600)].max() > 1  # (6.18) fails at gain 1 with the old model
    assert np.median(change[frequency < 300]) < 0.03


def test_a_mode_that_is_not_there_cannot_move() -> None:
    with pytest.raises(
        ValueError, match=r"moving_mode is 1300 Hz, must be within 30 Hz of a mode: the nearest is at 1"
    ):
        VibratorPlant(RATE, moving_mode=1300.0, seed=6)


def test_without_trend_and_moving_mode_nothing_else_of_them_matters() -> None:
    drive = np.random.default_rng(3).standard_normal((9_000, 2))
    responses = np.zeros((2, 9_000, 2))
    VibratorPlant(RATE).run(drive, responses[0])
    VibratorPlant(RATE, trend_seconds=1.0, moving_widths=5.0, moving_at=0.0, moving_seconds=1.0).run(
        drive, responses[1]
    )
    assert responses[0].tobytes() == responses[1].tobytes()


def test_overtones_grow_with_the_nonlinearity() -> None:
    (_, usual), (_, strong) = (overtones(80, 0.35, nonlinearity=scale) for scale in (1.0, 1.6))
    assert strong[:2].max() > usual[:2].max() + 2


def test_water_pulls_resonances_down_and_together_and_damps_them() -> None:
    air, water = (draw(np.random.default_rng(1)) for draw in (vibrator_modes, immersed_modes))
    ratio = water.frequency / air.frequency
    assert np.all(ratio < 1)
    assert np.all(np.diff(ratio[np.argsort(air.frequency)][5:]) > 0)  # flexure: the lower, the more
    assert 0.83 < ratio[5] < 0.87
    assert 0.93 < ratio[-1] < 0.96
    assert np.all(water.damping >= air.damping - 1e-15)
    assert 1.1 < water.damping[5:].mean() / air.damping[5:].mean() < 2.0


def test_the_water_on_a_plate_weighs_what_thin_plate_theory_says() -> None:
    """At 300 Hz in water: 25.5 mm of steel, D = 302 kN m, k = 6.97/m, 143 kg/m^2 on 0.3 of 200."""
    assert FLUID_MASS == pytest.approx(1000 * SHELL_AREA * 0.6133 * 0.309 / 3, rel=1e-3)
    dry = flexural_modes(np.random.default_rng(1))
    wet = flexure_in_water(dry)
    for name in ("coil", "spring", "joint", "shell"):  # normalised by a mass that grew
        np.testing.assert_allclose(
            getattr(wet, name) / getattr(dry, name), np.tile(wet.frequency / dry.frequency, (2, 1))
        )
    load = np.interp(300.0, wet.frequency[10:37], (dry.frequency / wet.frequency)[10:37] ** 2 - 1)
    assert load == pytest.approx(0.3 * 143 / 200, rel=0.02)


def test_the_vibrator_in_water_works_with_overtones_and_more_drive() -> None:
    air, _ = overtones(60, 0.8)
    water, levels = overtones(60, 0.93, medium="water")
    assert water == pytest.approx(10.0, rel=0.03)
    assert water / 0.93 < 0.9 * air / 0.8
    assert -35 < levels.max() < -15


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"medium": "mud"}, "simulator.options.medium is 'mud', must be 'air' or 'water'"),
        ({"trend": 0.3}, "simulator.options.trend is 0.3, must be -0.2 to 0.2"),
        ({"trend_seconds": 0.0}, "simulator.options.trend_seconds is 0.0, must be 1 to 1e+06 s"),
        ({"moving_widths": np.nan}, "simulator.options.moving_widths is nan, must be -10 to 10 half-power bandwidths"),
        ({"moving_at": -1}, "simulator.options.moving_at is -1, must be 0 to 1e+06 s"),
        ({"nonlinearity": True}, "simulator.options.nonlinearity is True, must be 0 to 5"),
        ({"seed": 1.0}, "simulator.options.seed is 1.0, must be a whole number >= 0"),
    ],
)
def test_an_option_out_of_range_is_refused_by_name(options: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=f"^{words.replace('.', '[.]').replace('+', '[+]')}$"):
        VibratorPlant(RATE, **options)
