"""The simulated vibrator behaves as the thesis describes the real one."""

import numpy as np
import pytest

from firmware_sim.plants.vibrator import VibratorPlant
from firmware_sim.plants.vibrator_modes import vibrator_modes

RATE = 44_100
SILENT = {"drift": 0.0, "noise": -300.0, "hum": -300.0}


def driven(drive: np.ndarray, **options: float) -> np.ndarray:
    """Return the response (frames, 2) to a drive from rest."""
    response = np.zeros_like(drive)
    VibratorPlant(RATE, **options).run(drive, response)
    return response


def transfer_matrix(seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies (0.5 Hz apart) and the linear plant's response (bins, 2, 2)."""
    frames, columns = 2 * RATE, []
    for coil in range(2):
        drive = np.zeros((frames, 2))
        drive[0, coil] = 1.0
        columns.append(np.fft.rfft(driven(drive, seed=seed, nonlinearity=0.0, **SILENT), axis=0)[:1400])
    return np.arange(1400) / 2, np.stack(columns, axis=-1)


def test_two_wanted_resonances_lie_between_20_and_100_hz() -> None:
    frequency, response = transfer_matrix()
    size = np.abs(response[:, 0, 0])
    peaks = [f for f, a, b, c in zip(frequency[1:], size, size[1:], size[2:], strict=False) if b > a and b > c]
    assert sum(20 <= f <= 100 for f in peaks) in (2, 3)  # the lower one may be split by the frame
    assert sum(100 < f <= 650 for f in peaks) >= 10


def test_at_least_twenty_modes_lie_below_650_hz() -> None:
    modes = vibrator_modes(np.random.default_rng(1))
    assert np.sum(modes.frequency < 650) >= 20


@pytest.mark.parametrize("seed", range(5))
def test_it_is_diagonally_dominant_below_150_hz_and_coupled_above(seed: int) -> None:
    frequency, response = transfer_matrix(seed)
    cross = np.abs(response[:, [0, 1], [1, 0]]) / np.abs(response[:, [0, 1], [0, 1]])
    low, high = (frequency > 40) & (frequency < 110), (frequency > 200) & (frequency < 650)
    assert np.median(cross[low]) < 0.3
    assert np.median(cross[high]) > 0.5


def test_it_has_zeros_outside_the_unit_circle() -> None:
    frequency, response = transfer_matrix()
    # the phase of a minimum-phase response is the Hilbert transform of its log magnitude; the excess is delay or such
    phase = np.unwrap(np.angle(response[40:1300, 0, 1]))
    assert phase[0] - phase[-1] > 4 * np.pi


@pytest.mark.parametrize(("root", "volts"), [(24, 3.66), (80, 0.35), (85, 0.71), (90, 1.26)])  # 10 m/s^2
def test_overtones_are_10_to_25_db_below_the_root_with_an_open_loop_drive(root: int, volts: float) -> None:
    time = np.arange(4 * RATE) / RATE
    drive = np.repeat(volts * np.sin(2 * np.pi * root * time)[:, None], 2, axis=1)
    lines = np.abs(np.fft.rfft(driven(drive, **SILENT)[2 * RATE :, 0]))
    level = 20 * np.log10(lines[[2 * root * order for order in (2, 3, 4, 5)]].max() / lines[2 * root])
    assert -25 <= level <= -10


def test_without_nonlinearity_it_is_linear() -> None:
    drive = np.random.default_rng(3).standard_normal((2_000, 2))
    half, whole = (driven(scale * drive, nonlinearity=0.0, **SILENT) for scale in (0.5, 1.0))
    # the amplifier's clip and the coil's force factor are the only limits left
    assert np.abs(whole - 2 * half).max() < 1e-3 * np.abs(whole).max()


def test_the_joints_stick_at_small_motion_and_slip_under_load() -> None:
    time = np.arange(3 * RATE) / RATE
    probe = 0.05 * np.sin(2 * np.pi * 290 * time)
    load = 0.8 * np.sin(2 * np.pi * 61.5 * time)
    gains = []
    for preload in (0.0, 1.0):
        drive = np.stack([probe + preload * load, preload * load], axis=1)
        response = driven(drive, **SILENT)[RATE:, 0]
        gains.append(np.fft.rfft(response)[580] / np.fft.rfft(drive[RATE:, 0])[580])
    assert abs(gains[0] - gains[1]) > 0.2 * abs(gains[1])


def test_noise_and_hum_have_the_levels_asked_for() -> None:
    quiet = np.zeros((4 * RATE, 2))
    noise = driven(quiet, noise=-60.0, hum=-300.0)
    assert np.std(noise) == pytest.approx(10e-3, rel=0.02)
    hum = np.fft.rfft(driven(quiet, noise=-300.0, hum=-40.0)[:, 0])[4 * 50] / (2 * RATE)
    assert abs(hum) == pytest.approx(0.1, rel=1e-3)


def test_drift_moves_the_modes_slowly() -> None:
    drive = np.zeros((60 * RATE, 2))
    drive[[0, 59 * RATE], 0] = 1.0
    response = driven(drive, nonlinearity=0.0, drift=0.02, noise=-300.0, hum=-300.0)
    early, late = response[:RATE, 0], response[59 * RATE :, 0]
    assert 0.005 < np.linalg.norm(late - early) / np.linalg.norm(early) < 1.5


def test_it_answers_the_same_in_one_piece_and_in_many() -> None:
    drive = np.random.default_rng(3).standard_normal((9_000, 2))
    whole = driven(drive)
    pieces, plant = np.zeros_like(drive), VibratorPlant(RATE)
    for start in range(0, 9_000, 500):
        plant.run(drive[start : start + 500], pieces[start : start + 500])
    np.testing.assert_array_equal(pieces, whole)


def test_seeds_give_different_vibrators() -> None:
    _, one = transfer_matrix(1)
    _, two = transfer_matrix(2)
    assert np.linalg.norm(one - two) > 0.3 * np.linalg.norm(one)


def test_it_stays_finite_whatever_the_drive() -> None:
    assert np.isfinite(driven(1e4 * np.random.default_rng(3).standard_normal((RATE, 2)))).all()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"noise": 5.0}, "simulator.options.noise is 5.0, must be -400 to 0 dB"),
        ({"nonlinearity": float("nan")}, "simulator.options.nonlinearity is nan, must be 0 to 5"),
        ({"seed": -1}, "simulator.options.seed is -1"),
        ({"drift": True}, "simulator.options.drift is True"),
    ],
)
def test_an_option_out_of_range_is_refused_by_name(options: dict[str, float], words: str) -> None:
    with pytest.raises(ValueError, match=words.replace(".", r"\.")):
        VibratorPlant(RATE, **options)
