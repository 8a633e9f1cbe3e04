"""The loopback cable, the clocks and the distortion, measured on signals whose faults are known."""

import numpy as np
import pytest

from vibractl import alignment
from vibractl.doctor.chain import TONES, cable, clock, distortion, products, two_tones

RATE = 44_100
CHIRP = alignment.timing_signal(RATE, alignment.LOOPBACK_BAND, 0.1)


def heard(count: int, delay: float, deviation: float = 0.0) -> np.ndarray:
    """Return a train of chirps as an input whose clock is slow by `deviation` hears it, `delay` samples late."""
    train = alignment.timing_train(CHIRP, count)
    points = np.arange(len(train) + 4_096)
    fine = np.fft.irfft(np.fft.rfft(train), 8 * len(train)) * 8  # so that lines between points are close enough
    return np.interp((points - delay) / (1 + deviation), np.arange(len(fine)) / 8, fine, left=0, right=0)


@pytest.mark.parametrize("gain", [1.0, -0.5, 0.1])
def test_the_cable_is_found_with_its_gain_and_sign(gain: float) -> None:
    train = alignment.timing_train(CHIRP, 20)
    found = cable(train, gain * heard(20, 573.0), RATE)
    assert found.delay == pytest.approx(573.0, abs=0.01)
    assert found.gain == pytest.approx(gain, rel=0.02)
    assert found.quality > 0.995


def test_silence_and_noise_are_no_cable() -> None:
    train = alignment.timing_train(CHIRP, 20)
    assert cable(train, np.zeros(30_000), RATE).quality == 0.0
    assert cable(train, np.random.default_rng(1).standard_normal(30_000), RATE).quality < 0.1


@pytest.mark.parametrize("deviation", [0.0, 2e-6, -50e-6])
def test_two_clocks_show_as_a_slope_without_steps(deviation: float) -> None:
    found = clock(CHIRP, 400, heard(400, 573.0, deviation), 573.0, RATE)
    assert found.deviation == pytest.approx(deviation, abs=2e-9 + 0.01 * abs(deviation))
    assert found.slip < 0.05
    assert found.quality > (0.98 if deviation < -1e-5 else 0.99)
    assert found.time[-1] - found.time[0] > 8.5


def test_a_lost_block_and_a_slip_show_where_the_slope_does_not() -> None:
    whole = heard(400, 573.0)
    silent = whole.copy()
    silent[200_000:200_512] = 0.0
    assert clock(CHIRP, 400, silent, 573.0, RATE).quality < 0.99
    slipped = np.concatenate((whole[:200_000], whole[200_512:]))
    found = clock(CHIRP, 400, slipped, 573.0, RATE)
    assert found.slip > 100
    assert found.delay[-1] == pytest.approx(-512.0, abs=0.1)


def test_the_tones_are_as_loud_as_said_and_their_products_keep_clear_of_the_mains() -> None:
    tones = two_tones(RATE, 4.2, 0.1)
    assert 0.095 < np.abs(tones).max() <= 0.1
    assert tones[0] == 0.0
    lines = products(645.0)
    for mains in (50.0, 60.0):
        assert np.abs(lines - mains * np.round(lines / mains)).min() >= 2.0
    assert set(TONES) & set(lines) == set()
    assert {22.0, 44.0, 110.0, 132.0, 154.0, 176.0, 264.0, 440.0} <= set(lines)


def test_distortion_is_measured_against_what_the_bent_line_makes() -> None:
    """For x + b x^2 with two tones of amplitude a: 2 f at b a^2 / 2 each, f2 - f1 and f1 + f2 at b a^2 each."""
    tones = two_tones(RATE, 4.2, 0.1)[4_410:-4_410]
    bend = 0.5
    level, noise, worst = distortion(tones + bend * tones**2, RATE, 645.0)
    a = 0.05
    wanted = 10 * np.log10((2 * (bend * a**2 / 2) ** 2 + 2 * (bend * a**2) ** 2) / (2 * a**2))
    assert level == pytest.approx(wanted, abs=0.05)
    assert worst in (22.0, 154.0)
    assert noise < level - 60


def test_mains_hum_on_the_cable_is_not_taken_for_distortion() -> None:
    tones = two_tones(RATE, 4.2, 0.1)[4_410:-4_410]
    time = np.arange(len(tones)) / RATE
    hum = sum(1e-3 * np.sin(2 * np.pi * n * mains * time) for n in range(1, 12) for mains in (50.0, 60.0))
    assert distortion(tones + hum, RATE, 645.0)[0] < -75
