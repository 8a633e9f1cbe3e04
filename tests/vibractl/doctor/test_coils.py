"""Which accelerometer answers which coil, and with which sign, on answers that are known."""

import numpy as np
import pytest

from tests.vibractl.doctor.doctor_rig import verdict, wired
from vibractl.doctor.coils import answers, assignment, polarity, sweep
from vibractl.doctor.examination import examine

RATE = 4_410
BAND = (15.0, 90.0)


def test_a_sweep_begins_and_ends_at_rest_and_stays_within_its_amplitude() -> None:
    wave = sweep(RATE, BAND, 2.0, 0.3)
    assert 0.29 < np.abs(wave).max() <= 0.3
    assert np.abs(wave[[0, 1, -2, -1]]).max() < 1e-4
    size = np.abs(np.fft.rfft(wave))
    frequency = np.fft.rfftfreq(len(wave), 1 / RATE)
    inside = (frequency > 20) & (frequency < 85)
    assert (size[inside] ** 2).sum() > 0.9 * (size**2).sum()


def test_the_answers_are_the_response_with_the_round_trip_in_it() -> None:
    wave, sides, late = sweep(RATE, BAND, 2.0, 0.3), np.array([[10.0, 1.0], [-2.0, 8.0]]), 57
    recorded = []
    for coil in range(2):
        each = np.zeros((len(wave) + RATE, 2))
        each[late : late + len(wave)] = wave[:, None] * sides[:, coil]
        recorded.append(each)
    quiet = 1e-3 * np.random.default_rng(2).standard_normal((5 * RATE, 2))
    found = answers(wave, recorded, quiet, RATE, BAND)
    delay = np.exp(-2j * np.pi * found.frequency * late / RATE)
    np.testing.assert_allclose(found.response, delay[:, None, None] * sides, rtol=1e-6)
    assert np.argmax(found.loudness, axis=0).tolist() == [0, 1]
    assert found.loudness.min() > 40
    np.testing.assert_allclose(polarity(found), [1.0, 1.0], atol=1e-6)


def test_the_pairing_is_that_of_the_largest_sum() -> None:
    level = np.array([[0.0, -3.0, 20.0], [15.0, 0.0, -3.0], [-3.0, 18.0, 0.0]])
    assert assignment(level)[0] == [1, 2, 0]
    owner, margin = assignment(np.array([[20.0, 14.0], [11.0, 16.0]]))
    assert owner == [0, 1]
    assert margin == pytest.approx(2.0)
    assert assignment(np.array([[3.0]])) == ([0], np.inf)


@pytest.mark.slow
@pytest.mark.usefixtures("brief")
def test_any_number_of_sides_is_looked_at(tmp_path: object) -> None:
    three = {"drive_channels": (1, 2, 3), "response_channels": (1, 2, 3), "loopback_output": 4, "loopback_input": 4}
    sides = np.array([[10.0, 1.0, 0.5], [1.0, 8.0, 1.0], [0.5, 1.0, -9.0]])
    found = examine(wired(tmp_path, sides, **three))  # type: ignore[arg-type]
    assert verdict(found, "channel map").grade == "pass"
    assert "side 3 moves against side 1" in verdict(found, "polarity").measured
    rolled = examine(wired(tmp_path, np.roll(np.abs(sides), 1, axis=0), **three))  # type: ignore[arg-type]
    assert "audio.response_channels = [2, 3, 1]" in verdict(rolled, "channel map").advice
