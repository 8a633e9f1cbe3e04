"""Delays with a fraction of a sample, sensors that resonate or bend, mains, noise and ships."""

import numpy as np
import pytest

from firmware_sim.plants.pickup import Mains, Noise, Ships
from firmware_sim.plants.reception import BLOCK, Receiver, Reception, Sensors, silent_reception

RATE = 44_100
FRAMES = 2**16


def sensors(**changed: np.ndarray) -> Sensors:
    """Return two sensors, as good as they can be but for what is changed."""
    plain = {"delay": np.full(2, 2e-3), "resonance": np.zeros(2), "damping": np.full(2, 0.5), "bend": np.zeros((2, 2))}
    return Sensors(**{**plain, **changed})


def received(
    reception: Reception, motion: np.ndarray, rate: float = RATE, seed: int = 1, piece: int = 512
) -> np.ndarray:
    """Return what the sensors make of a motion, shape (frames, 2), in pieces."""
    receiver, heard = Receiver(reception, rate, seed), motion.copy()
    for start in range(0, len(heard), piece):
        if start % BLOCK == 0:
            receiver.begin_block()
        receiver.hear(heard[start : start + piece])
    return heard


def impulse_response(reception: Reception, rate: float = RATE) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies and the sensors' response, shape (bins, 2)."""
    motion = np.zeros((FRAMES, 2))
    motion[0] = 1.0
    heard = received(reception, motion, rate)
    return np.fft.rfftfreq(FRAMES, 1 / rate), np.fft.rfft(heard, axis=0)


@pytest.mark.parametrize(
    ("seconds", "rate"), [(1e-3, 44_100.0), (0.02947312, 44_100.0), (7.77e-3, 48_000.0), (9e-3, 8_000.0)]
)
def test_a_delay_is_right_to_a_thousandth_of_a_sample(seconds: float, rate: float) -> None:
    frequency, response = impulse_response(silent_reception(sensors(delay=np.array([seconds, 2 * seconds]))), rate)
    inside = (frequency > 10) & (frequency < 0.3 * rate)
    for sensor, delay in enumerate((seconds, 2 * seconds)):
        left = response[inside, sensor] * np.exp(2j * np.pi * frequency[inside] * delay)
        assert np.abs(np.angle(left) / (2 * np.pi * frequency[inside]) * rate).max() < 1e-3
        assert np.abs(np.abs(left) - 1).max() < 1e-3


def test_a_sensor_resonates_where_and_as_much_as_it_says() -> None:
    its = sensors(resonance=np.array([0.0, 1500.0]), damping=np.array([0.5, 0.02]))
    frequency, response = impulse_response(silent_reception(its))
    near = (frequency > 20) & (frequency < 3000)
    wanted = its.response(frequency)
    np.testing.assert_allclose(np.abs(response[near, 0]), 1.0, rtol=1e-4)
    assert frequency[near][np.abs(response[near, 1]).argmax()] == pytest.approx(1500.0, rel=1e-3)
    below = (frequency > 20) & (frequency < 1000)
    np.testing.assert_allclose(response[below, 1], wanted[below, 1], rtol=0.02)
    assert np.abs(response[near, 1]).max() == pytest.approx(np.abs(wanted[near, 1]).max(), rel=0.03)


@pytest.mark.parametrize(("column", "overtone"), [(0, 2), (1, 3)])
def test_a_sensor_that_is_off_by_a_thousandth_has_that_overtone(column: int, overtone: int) -> None:
    bend = np.zeros((2, 2))
    bend[1, column] = 1e-3 / 20.0 ** (1 + column)
    sine = 20.0 * np.sin(2 * np.pi * 64 * np.arange(2 * RATE) / RATE)
    heard = received(silent_reception(sensors(bend=bend)), np.stack([sine, sine], axis=1))[RATE:]
    size = np.abs(np.fft.rfft(heard, axis=0)[[overtone * 64, 64]])
    size = size[0] / size[1]
    assert size[0] < 1e-6
    assert size[1] == pytest.approx({2: 1e-3 / 2, 3: 1e-3 / 4}[overtone], rel=0.05)


def picked_up(seconds: float, seed: int = 1, rate: float = RATE, **parts: object) -> np.ndarray:
    """Return what is heard of no motion, shape (frames, 2)."""
    silent = silent_reception(sensors(delay=np.full(2, 4e-3)))
    whole = Reception(**{**vars(silent), **parts})  # type: ignore[arg-type]
    return received(whole, np.zeros((round(seconds * rate), 2)), rate, seed)


def mains(wander: float, frequency: float = 50.0) -> Mains:
    """Return mains with a first, a second and a fifth harmonic."""
    sizes = np.zeros((5, 2))
    sizes[[0, 1, 4]] = [[0.3, 0.1], [0.02, 0.04], [0.05, 0.0]]
    return Mains(frequency, wander, sizes, np.zeros((5, 2)))


def test_hum_has_the_harmonics_it_says_at_each_sensor() -> None:
    heard = picked_up(4.0, mains=mains(0.0))
    lines = 2 * np.abs(np.fft.rfft(heard, axis=0)) / len(heard)
    np.testing.assert_allclose(lines[[200, 400, 1000]], [[0.3, 0.1], [0.02, 0.04], [0.05, 0.0]], rtol=1e-6, atol=1e-9)
    lines[[200, 400, 1000]] = 0.0
    assert lines.max() < 1e-9


def test_the_mains_are_off_by_what_they_say_and_their_phase_wanders() -> None:
    time = np.arange(480_000) / 8_000
    phases = []
    for wander in (0.0, 0.02):
        heard = picked_up(60.0, rate=8_000.0, mains=mains(wander, 50.04))[:, 1]
        turned = (heard * np.exp(-2j * np.pi * 50.04 * time)).reshape(60, -1).mean(axis=1)
        phases.append(np.unwrap(np.angle(turned)))
    assert np.ptp(phases[0]) < 5e-3
    assert 0.2 < np.ptp(phases[1]) < 2 * np.pi * 0.02 * 60 * 3


def density(heard: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies and one-sided spectral density, (m/s^2)^2/Hz, shape (bins, 2)."""
    cut = heard[: len(heard) // RATE * RATE].reshape(-1, RATE, 2)
    return np.fft.rfftfreq(RATE, 1 / RATE), 2 * (np.abs(np.fft.rfft(cut, axis=1)) ** 2).mean(axis=0) / RATE**2


def test_white_noise_has_its_rms() -> None:
    heard = picked_up(4.0, noise=Noise(np.array([0.1, 0.02]), np.zeros(2), 0.0))
    np.testing.assert_allclose(heard.std(axis=0), [0.1, 0.02], rtol=0.02)
    assert abs(np.corrcoef(heard.T)[0, 1]) < 0.02


def test_rising_noise_falls_by_three_decibels_an_octave_and_is_as_strong_as_it_says_at_100_hz() -> None:
    heard = picked_up(40.0, noise=Noise(np.zeros(2), np.array([0.1, 0.1]), 0.0))
    frequency, power = density(heard)
    white = 0.1**2 / (RATE / 2)
    for low, high in ((10, 20), (90, 110), (400, 600), (1500, 2500)):
        band = (frequency >= low) & (frequency <= high)
        expected = white * (100 / frequency[band]).mean()
        assert 10 * np.log10(power[band].mean() / expected) == pytest.approx(0.0, abs=1.0)


def test_the_sea_swells() -> None:
    sizes = []
    for swell in (0.0, 0.5):
        heard = picked_up(240.0, rate=8_000.0, noise=Noise(np.zeros(2), np.full(2, 0.1), swell))
        sizes.append(np.log(heard[:, 0].reshape(48, -1).std(axis=1)).std())
    assert sizes[1] > 2 * sizes[0]


def test_a_ship_goes_by_in_its_band_and_is_the_same_to_all_but_for_its_size() -> None:
    ships = Ships(2.0, 0.1, 3.0, 200.0, 8.0, 0.5, np.array([1.0, 0.5]))
    heard = picked_up(90.0, seed=4, ships=ships)
    np.testing.assert_allclose(heard[:, 1], 0.5 * heard[:, 0], atol=1e-12)
    loud = heard[:, 0].reshape(90, -1).std(axis=1)
    assert loud.max() > 5 * np.percentile(loud, 20)
    frequency, power = density(heard)
    near, away = (power[(frequency > low) & (frequency < high), 0].mean() for low, high in ((150, 260), (3000, 6000)))
    assert near > 30 * away


def test_what_is_picked_up_does_not_depend_on_the_pieces() -> None:
    parts = {
        "mains": mains(0.02),
        "noise": Noise(np.ones(2), np.ones(2), 0.3),
        "ships": Ships(5.0, 1.0, 3.0, 200.0, 8.0, 0.5, np.ones(2)),
    }
    whole = Reception(sensors(), **parts)  # type: ignore[arg-type]
    still = np.zeros((3 * BLOCK, 2))
    np.testing.assert_array_equal(received(whole, still, piece=BLOCK), received(whole, still, piece=256))
