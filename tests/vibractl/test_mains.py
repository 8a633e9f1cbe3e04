"""The hum between silences is found from them, whatever its level; nothing is found where there is none.

Guards against a drive that follows the mains, and against a verdict on what the vibrator did not emit.
"""

import numpy as np
import pytest

from vibractl.mains import KEPT, Hum, Mains, aligned

RATE, LEAD, FRAMES, TAIL = 11_025.0, 2_205, 55_125, 4_410
TOTAL = LEAD + FRAMES + TAIL
GAP = 3_000
"""Samples between two shots."""
AMPLITUDE = np.array([[1.0, 0.3], [0.1, 0.05], [0.5, 0.8], [0.0, 0.0], [0.3, 0.2]])
"""m/s^2 of the first harmonics in two sensors."""


class Heard:
    """Shots of a room: hum of a wandering frequency, noise, and a mode that rings down after the reference."""

    def __init__(
        self, frequency: float, level: float = 1.0, wander: float = 0.0, noise: float = 0.02, ring: float = 0.0
    ):
        self._rng = np.random.default_rng(7)
        self._frequency, self._wander, self._phase, self._off = frequency, wander, 0.3, 0.0
        turn = np.exp(1j * self._rng.uniform(0, 2 * np.pi, AMPLITUDE.shape))
        self._amplitude, self._noise, self._ring = level * AMPLITUDE * turn, noise, ring

    def shot(self) -> tuple[np.ndarray, np.ndarray]:
        """Return what is heard in a shot without a reference, and the hum in it, (samples, 2), m/s^2."""
        steps = self._rng.standard_normal(TOTAL + GAP) * self._wander * np.sqrt(2 / (30.0 * RATE))
        off = self._off + np.cumsum(steps)
        self._off = 0.8 * off[-1]
        phase = self._phase + 2 * np.pi * np.cumsum(self._frequency + off) / RATE
        self._phase = phase[-1]
        tones = np.exp(1j * np.outer(phase[:TOTAL], np.arange(1, len(AMPLITUDE) + 1)))
        hum = (tones @ self._amplitude).real
        heard = hum + self._noise * self._rng.standard_normal(hum.shape)
        after = np.arange(TAIL) / RATE
        heard[-TAIL:, 0] += self._ring * np.cos(2 * np.pi * 49.8 * after) * np.exp(-after / 0.5)
        return heard, hum


def mains() -> Mains:
    return Mains(LEAD, TAIL, TOTAL, RATE, 650.0)


def left(heard: Heard, shots: int, followed: Mains | None = None) -> tuple[float, Hum]:
    """Return how much of the hum is left between the silences of the last shot, dB, and what was found."""
    followed = followed or mains()
    for _ in range(shots):
        recorded, hum = heard.shot()
        found = followed.observe(recorded)
    between = slice(LEAD, LEAD + FRAMES)
    rest = hum[between] - found.signal(TOTAL, RATE)[between]
    return float(20 * np.log10(np.linalg.norm(rest) / np.linalg.norm(hum[between]))), found


@pytest.mark.parametrize("frequency", [49.95, 50.0, 50.0371, 59.96, 60.05])
def test_steady_mains_are_known_to_a_millihertz_and_taken_out_from_the_first_shot(frequency: float) -> None:
    rest, found = left(Heard(frequency), 1)
    assert rest < -25
    rest, found = left(Heard(frequency), 5)
    assert rest < -30
    assert abs(found.frequency - frequency) < 1e-3


@pytest.mark.sample(1)
@pytest.mark.parametrize(("wander", "most"), [(0.002, -25), (0.005, -20), (0.02, -8)])
def test_mains_that_wander_are_followed_as_far_as_a_line_between_two_phases_does(wander: float, most: float) -> None:
    followed, heard = mains(), Heard(50.02, wander=wander)
    rests = [left(heard, 1, followed)[0] for _ in range(12)]
    assert np.median(rests) < most


def test_hum_that_is_hardly_above_the_noise_is_taken_out_as_far_as_it_is_known() -> None:
    rest, _ = left(Heard(50.01, level=0.2, noise=0.2), KEPT)
    assert rest < -15


def test_noise_alone_is_hardly_ever_taken_for_hum() -> None:
    taken = []
    for seed in range(20):
        rng, followed = np.random.default_rng(seed), mains()
        for _ in range(4):
            found = followed.observe(rng.standard_normal((TOTAL, 2)))
        taken.append(np.count_nonzero(found.amplitude))
    assert sum(taken) <= 0.02 * 20 * found.amplitude.size


def test_silence_gives_silence() -> None:
    found = mains().observe(np.zeros((TOTAL, 2)))
    assert not found.amplitude.any()
    assert not found.signal(TOTAL, RATE).any()
    assert np.isfinite(found.doubted(np.arange(3.0, 600.0), FRAMES / RATE)).all()


def test_a_mode_that_rings_down_near_the_mains_frequency_does_not_spoil_the_other_harmonics() -> None:
    followed, heard = mains(), Heard(50.02, ring=3.0)
    for _ in range(6):
        recorded, hum = heard.shot()
        found = followed.observe(recorded)
    between = slice(LEAD, LEAD + FRAMES)
    rest = np.fft.rfft((hum - found.signal(TOTAL, RATE))[between], axis=0)
    there = np.fft.rfft(hum[between], axis=0)
    line = round(150.06 * FRAMES / RATE)
    assert np.abs(rest[line]).max() < 0.1 * np.abs(there[line]).max()
    assert abs(found.frequency - 50.02) < 5e-3


def test_what_is_doubted_covers_what_is_left() -> None:
    ratios = []
    for wander in (0.0, 0.003, 0.01):
        followed, heard = mains(), Heard(50.03, wander=wander)
        for _ in range(10):
            recorded, hum = heard.shot()
            found = followed.observe(recorded)
            rest = (hum - found.signal(TOTAL, RATE))[LEAD : LEAD + FRAMES]
            lines = np.fft.rfft(rest, axis=0) / RATE
            place = np.round(np.array([50.0, 150.0, 250.0]) * FRAMES / RATE).astype(int)
            doubted = found.doubted(place * RATE / FRAMES, FRAMES / RATE)
            ratios.append(np.abs(lines[place]) ** 2 / doubted)
    assert 0.02 < np.median(ratios) < 1.5
    assert np.mean(np.array(ratios) < 3) > 0.85


def test_a_tone_in_doubt_lies_around_its_frequency_with_all_of_its_power() -> None:
    doubt = np.zeros((3, 1))
    doubt[2] = 0.04
    hum, frequency = Hum(50.03, np.zeros((3, 1), complex), doubt), np.arange(2.0, 400.0, RATE / FRAMES)
    power = hum.doubted(frequency, FRAMES / RATE)[:, 0]
    time = np.arange(FRAMES) / RATE
    lines = np.fft.rfft(0.2 * np.cos(2 * np.pi * 150.09 * time)) / RATE
    assert power.sum() == pytest.approx((np.abs(lines) ** 2).sum(), rel=0.02)
    assert abs(frequency[power.argmax()] - 150.09) < RATE / FRAMES
    assert power.max() > 0.4 * (np.abs(lines) ** 2).max()


def ringing(frequency: float, size: float, decay: float, level: float, shots: int) -> tuple[Hum, np.ndarray]:
    """Return what is found, and the hum there was, where a mode rings down after each shot."""
    heard, followed = Heard(50.02, level=level), mains()
    after = np.arange(TAIL) / RATE
    for _ in range(shots):
        recorded, hum = heard.shot()
        recorded[-TAIL:, 0] += size * np.cos(2 * np.pi * frequency * after) * np.exp(-after / decay)
        found = followed.observe(recorded)
    return found, hum


@pytest.mark.sample(4)
@pytest.mark.parametrize(("frequency", "decay"), [(150.0, 0.5), (148.0, 0.5), (49.9, 0.5), (150.0, 0.15), (250.0, 2.0)])
@pytest.mark.parametrize("shots", [1, 3, 12])
def test_what_rings_down_is_not_hum(frequency: float, decay: float, shots: int) -> None:
    found, _ = ringing(frequency, 1.0, decay, 0.0, shots)
    assert np.abs(found.amplitude).max() < 0.01


@pytest.mark.parametrize("level", [0.02, 0.05])
def test_what_rings_down_beside_weak_hum_makes_it_no_louder(level: float) -> None:
    found, hum = ringing(150.0, 1.0, 0.5, level, 6)
    between = slice(LEAD, LEAD + FRAMES)
    rest = (hum - found.signal(TOTAL, RATE))[between]
    assert np.linalg.norm(rest) <= 1.02 * np.linalg.norm(hum[between])


@pytest.mark.sample(3)
@pytest.mark.parametrize("orders", [(2,), (3,), (2, 4), (3, 5)])
@pytest.mark.parametrize("seed", range(3))
def test_a_frequency_that_few_harmonics_do_not_tell_is_not_guessed(orders: tuple[int, ...], seed: int) -> None:
    rng, followed = np.random.default_rng(seed), mains()
    time = np.arange(TOTAL) / RATE
    for _ in range(8):
        base = 2 * np.pi * (50.03 * time + rng.uniform())
        hum = sum(np.cos(order * base + order)[:, None] * np.ones(2) for order in orders)
        found = followed.observe(hum + 0.02 * rng.standard_normal(hum.shape))
        rest = (hum - found.signal(TOTAL, RATE))[LEAD : LEAD + FRAMES]
        assert np.linalg.norm(rest) <= 1.02 * np.linalg.norm(hum[LEAD : LEAD + FRAMES])


@pytest.mark.parametrize("seconds", [10, 20])
def test_over_a_long_reference_the_hum_is_left_where_it_is(seconds: int) -> None:
    total = LEAD + round(seconds * RATE) + TAIL
    followed, time = Mains(LEAD, TAIL, total, RATE, 650.0), np.arange(total) / RATE
    base = 2 * np.pi * 50.05 * time
    hum = (np.cos(base) + 0.5 * np.cos(3 * base) + 0.3 * np.cos(2 * base))[:, None]
    for _ in range(3):
        found = followed.observe(hum)
    assert not found.amplitude.any()
    assert found.doubted(np.array([150.0]), float(seconds))[0] > 0


def test_without_hum_the_mains_stay_where_they_are() -> None:
    rng, followed = np.random.default_rng(2), mains()
    frequencies = {followed.observe(rng.standard_normal((TOTAL, 2))).frequency for _ in range(10)}
    assert frequencies <= {50.0, 60.0}


def test_noise_that_is_louder_after_the_reference_is_not_taken_for_hum() -> None:
    taken = []
    for seed in range(20):
        rng, followed = np.random.default_rng(seed), mains()
        for _ in range(4):
            noise = rng.standard_normal((TOTAL, 2))
            noise[-TAIL:] *= 3
            taken.append(np.count_nonzero(followed.observe(noise).amplitude))
    assert sum(taken) <= 2


def test_pieces_that_are_turned_are_turned_back() -> None:
    rng = np.random.default_rng(3)
    orders, vector = np.arange(1, 6), rng.standard_normal((5, 2)) + 1j * rng.standard_normal((5, 2))
    phase = rng.uniform(0, 2 * np.pi, (4, 2))
    pieces = vector * np.exp(1j * phase[..., None] * orders)[..., None]
    fit = aligned(pieces, orders)
    turned = fit.vector * np.exp(1j * fit.phase[..., None] * orders)[..., None]
    assert np.abs(turned - pieces).max() < 1e-3 * np.abs(pieces).max()
