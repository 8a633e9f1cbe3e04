"""Both proofs of alignment learn the session's delay once, and say of every recording whether it still holds."""

import math
import re

import numpy as np
import pytest

from firmware_sim.plants.vibrator import VibratorPlant
from vibractl.config import Audio, Limits
from vibractl.loopback import Loopback
from vibractl.marker import Marker
from vibractl.proof import Emission, Proof

RATE = 44_100
LATE = 573


def heard(emission: Emission, plant: VibratorPlant, late: int = LATE) -> tuple[np.ndarray, np.ndarray]:
    """Return the responses and the loopback that are recorded, `late` samples after the emission."""
    drive = np.zeros((emission.frames + RATE, 2))
    drive[late : late + len(emission.drive)] = emission.drive
    response = np.zeros_like(drive)
    plant.run(drive, response)
    loopback = np.zeros(len(drive))
    loopback[late : late + len(emission.timing)] = emission.timing
    return response[: emission.frames].astype(np.float32), loopback[: emission.frames].astype(np.float32)


def made(which: str) -> Proof:
    return Loopback(Audio()) if which == "loopback" else Marker(Audio(), Limits())


def learned(which: str, plant: VibratorPlant) -> Proof:
    found = made(which)
    assert found.learn(*heard(found.probe(), plant)) == ""
    return found


def sweep(amplitude: float) -> np.ndarray:
    time = np.arange(2 * RATE) / RATE
    return (
        amplitude * np.sin(2 * np.pi * np.array([40.0, 76.0]) * time[:, None]) * np.sin(np.pi * time / 2)[:, None] ** 2
    )


def test_the_loopback_emits_nothing_on_the_drives_and_knows_the_delay_exactly() -> None:
    plant = VibratorPlant(RATE)
    cable = learned("loopback", plant)
    assert not cable.probe().drive.size
    assert cable.whole == LATE
    assert cable.first == pytest.approx(LATE, abs=1e-6)
    emission = cable.emission(sweep(1.0))
    assert emission.before == 0
    np.testing.assert_array_equal(emission.drive, sweep(1.0))
    assert len(emission.timing) >= len(emission.drive)
    evidence = cable.judge(emission, *heard(emission, plant))
    assert evidence.fault == ""
    assert abs(evidence.residual) < 1e-6


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_marker_holds_to_a_twentieth_of_a_sample_on_the_simulated_vibrator(seed: int) -> None:
    plant = VibratorPlant(RATE, seed=seed)
    marker = learned("marker", plant)
    assert abs(marker.whole - LATE) < 20  # the vibrator's own delay is in it
    for amplitude in (0.1, 1.0, 4.0):
        emission = marker.emission(sweep(amplitude))
        evidence = marker.judge(emission, *heard(emission, plant))
        assert evidence.fault == ""
        assert abs(evidence.residual) < 0.05
        assert evidence.quality > 0.97


def test_the_marker_is_fifty_decibels_below_the_peak_limit_and_beside_the_drive() -> None:
    marker = learned("marker", VibratorPlant(RATE))
    emission = marker.emission(sweep(1.0))
    drive = emission.drive[emission.before : emission.before + 2 * RATE]
    np.testing.assert_array_equal(drive, sweep(1.0))
    before, after = emission.drive[: emission.before], emission.drive[emission.before + 2 * RATE :]
    for beside in (before, after):
        assert np.abs(beside[:, 0]).max() == pytest.approx(9.0 * 10 ** (-50 / 20), rel=0.01)
        assert not beside[:, 1].any()
    assert not before[-10_000:].any()
    assert not after[:10_000].any()


@pytest.mark.parametrize("which", ["loopback", "marker"])
@pytest.mark.parametrize("slip", [1, -1, 7, 64])
def test_a_slip_is_told_with_its_size_while_it_is_small(which: str, slip: int) -> None:
    plant = VibratorPlant(RATE)
    judge = learned(which, plant)
    emission = judge.emission(sweep(1.0))
    evidence = judge.judge(emission, *heard(emission, plant, LATE + slip))
    assert evidence.fault
    if which == "loopback" or abs(slip) == 1:
        assert evidence.fault.startswith("slip: the delay is")
        assert evidence.residual == pytest.approx(slip, abs=0.1)
    else:
        assert re.match("the marker (before|after) the drive is wrong: quality", evidence.fault)


@pytest.mark.parametrize("which", ["loopback", "marker"])
def test_silence_noise_and_nan_are_not_trusted(which: str) -> None:
    judge = learned(which, VibratorPlant(RATE))
    emission = judge.emission(sweep(1.0))
    probe = judge.probe().frames
    noise = np.random.default_rng(1).standard_normal((max(probe, emission.frames), 2)).astype(np.float32)
    for response in (np.zeros_like(noise), noise, np.full_like(noise, math.nan)):
        assert judge.judge(emission, response, response[:, 0]).fault
        assert made(which).learn(response[:probe], response[:probe, 0]) != ""


def test_an_inverted_cable_is_not_accepted() -> None:
    cable = Loopback(Audio())
    response, loopback = heard(cable.probe(), VibratorPlant(RATE))
    assert "not inverted" in cable.learn(response, -loopback)
