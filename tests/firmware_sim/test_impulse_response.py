"""Partitioned convolution equals direct convolution, in frames of any length, from made and from measured responses."""

import tracemalloc

import numpy as np
import pytest
from scipy.signal import fftconvolve

from ctlblocks.recording import read
from firmware_sim.plants.impulse_response import BLOCK, ImpulseResponsePlant
from tests.shared_data import shared


def noise(*shape: int, seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).standard_normal(shape)


def run(plant: ImpulseResponsePlant, drive: np.ndarray, outputs: int, frames: int) -> np.ndarray:
    response = np.full((len(drive), outputs), np.nan)
    for start in range(0, len(drive), frames):
        plant.run(drive[start : start + frames], response[start : start + frames])
    return response


def convolved(responses: np.ndarray, drive: np.ndarray) -> np.ndarray:
    """Return the same by scipy."""
    columns = []
    for output in range(responses.shape[1]):
        parts = [fftconvolve(drive[:, i], responses[:, output, i])[: len(drive)] for i in range(drive.shape[1])]
        columns.append(np.sum(parts, axis=0))
    return np.stack(columns, axis=1)


@pytest.mark.parametrize("taps", [1, 2, BLOCK - 1, BLOCK, BLOCK + 1, 3 * BLOCK, 5000])
@pytest.mark.parametrize(("outputs", "inputs"), [(2, 2), (1, 1), (3, 2)])
def test_it_equals_scipys_convolution(taps: int, outputs: int, inputs: int) -> None:
    responses, drive = noise(taps, outputs, inputs, seed=2), noise(6000, inputs)
    expected = convolved(responses, drive)
    found = run(ImpulseResponsePlant(responses), drive, outputs, 512)
    assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()


@pytest.mark.parametrize("frames", [1, 7, 64, 100, 256, 441, 6000])
def test_the_frames_change_nothing_bit_for_bit(frames: int) -> None:
    responses, drive = noise(2000, 2, 2, seed=2), noise(6000, 2)
    whole = run(ImpulseResponsePlant(responses), drive, 2, 512)
    assert run(ImpulseResponsePlant(responses), drive, 2, frames).tobytes() == whole.tobytes()


def test_an_impulse_gives_the_response_without_added_delay() -> None:
    responses = noise(1000, 2, 2)
    drive = np.zeros((1200, 2))
    drive[0, 1] = 1.0
    found = run(ImpulseResponsePlant(responses), drive, 2, 64)
    np.testing.assert_allclose(found[:1000], responses[:, :, 1], atol=1e-14)
    np.testing.assert_allclose(found[1000:], 0.0, atol=1e-14)


def test_reset_forgets_all_drives() -> None:
    plant = ImpulseResponsePlant(noise(2000, 2, 2))
    drive = noise(3000, 2)
    first = run(plant, drive, 2, 512)
    plant.reset()
    assert run(plant, drive, 2, 512).tobytes() == first.tobytes()


def test_a_call_allocates_nothing_of_the_size_of_a_frame() -> None:
    plant = ImpulseResponsePlant(noise(20_000, 2, 2))
    drive, response = noise(8192, 2), np.zeros((8192, 2))
    plant.run(drive, response)
    tracemalloc.start()
    plant.run(drive, response)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 8192


@pytest.mark.parametrize(
    "responses", [np.zeros((5, 2)), np.zeros((0, 2, 2)), np.zeros((5, 0, 2)), np.full((5, 1, 1), np.nan)]
)
def test_responses_without_shape_or_not_finite_are_refused(responses: np.ndarray) -> None:
    with pytest.raises(ValueError, match=r"must be \(taps, outputs, inputs\), all >= 1, and finite"):
        ImpulseResponsePlant(responses)


def test_measured_responses_of_a_head_to_two_loudspeakers() -> None:
    files = [shared(f"kemar/H0e{angle:03d}a.wav") for angle in (30, 90)]
    measured = [read(file, rate=44_100, channels=2).data for file in files]
    responses = np.stack(measured, axis=-1).astype(float)
    drive = noise(4410, 2)
    expected = convolved(responses, drive)
    found = run(ImpulseResponsePlant(responses), drive, 2, 100)
    assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()
