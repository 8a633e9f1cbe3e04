"""The plants as blocks: at rest after prepare, refused in words when they cannot be built."""

import inspect
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest
import soundfile

from ctlblocks.block import Block
from firmware_sim.plant_blocks import ImpulseResponse, Vibrator, VibratorArray, VibratorImpulseResponse
from firmware_sim.plants.impulse_response import ImpulseResponsePlant
from firmware_sim.plants.vibrator import LumpedVibratorPlant, VibratorPlant
from firmware_sim.plants.vibrator_array import VibratorArrayPlant
from firmware_sim.plants.vibrator_options import VibratorOptions
from tests.shared_data import MEASURED_PAIRS, measured_pair, shared

RATE = 44_100.0
STILL = {"drift": 0.0, "noise": -300.0, "hum": -300.0}


def run(block: Block, drive: np.ndarray, frames: int = 512) -> np.ndarray:
    response = np.full((len(drive), block.outputs[0].width), np.nan)
    for start in range(0, len(drive), frames):
        block.process(drive[start : start + frames], response[start : start + frames])
    return response


def noise(samples: int = 4096) -> np.ndarray:
    return np.random.default_rng(1).standard_normal((samples, 2))


def written(tmp_path: Path, **columns: np.ndarray) -> list[str]:
    for name, column in columns.items():
        soundfile.write(tmp_path / f"{name}.wav", column, int(RATE), subtype="FLOAT")
    return [str(tmp_path / f"{name}.wav") for name in columns]


@pytest.mark.parametrize(("kind", "plant"), [(Vibrator, VibratorPlant), (VibratorArray, VibratorArrayPlant)])
def test_a_block_takes_what_its_plant_takes(kind: type[Block], plant: type) -> None:
    own = list(inspect.signature(kind).parameters.values())
    assert own == [each for each in inspect.signature(plant).parameters.values() if each.name != "rate"]
    assert {each.name for each in own} >= {each.name for each in fields(VibratorOptions)}


def test_the_vibrator_block_is_the_vibrator_plant_with_the_same_options() -> None:
    block, plant = Vibrator(seed=7, nonlinearity=2.0), VibratorPlant(RATE, seed=7, nonlinearity=2.0)
    block.prepare(RATE, 512)
    expected = np.empty((4096, 2))
    plant.run(noise(), expected)
    assert run(block, noise()).tobytes() == expected.tobytes()


def test_prepared_again_the_vibrator_is_at_rest_and_gives_the_same() -> None:
    block = Vibrator()
    runs = []
    for frames in (512, 64):
        block.prepare(RATE, frames)
        runs.append(run(block, noise(), frames))
    assert runs[0].tobytes() == runs[1].tobytes()


def test_a_wrong_option_is_refused_when_the_block_is_made() -> None:
    with pytest.raises(ValueError, match=r"simulator.options.noise is 3.0, must be -400 to 0 dB"):
        Vibrator(noise=3.0)


def test_each_file_is_a_drive_and_each_of_its_channels_a_response(tmp_path: Path) -> None:
    files = written(tmp_path, one=np.array([[1.0, 2.0]]), two=np.array([[0.0, 0.0], [3.0, 4.0]]))
    block = ImpulseResponse(files, gain=10.0)
    assert (block.inputs[0].width, block.outputs[0].width) == (2, 2)
    block.prepare(RATE, 4)
    response = run(block, np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0], [0.0, 0.0]]))
    np.testing.assert_array_equal(response, [[10, 20], [0, 0], [30, 40], [0, 0]])


def test_prepared_again_an_impulse_response_starts_at_rest(tmp_path: Path) -> None:
    block = ImpulseResponse(written(tmp_path, one=noise(600), two=noise(600)))
    runs = []
    for frames in (512, 64):
        block.prepare(RATE, frames)
        runs.append(run(block, noise(), frames))
    assert runs[0].tobytes() == runs[1].tobytes()


def test_another_rate_than_the_files_is_refused(tmp_path: Path) -> None:
    block = ImpulseResponse(written(tmp_path, one=np.ones((2, 2))))
    with pytest.raises(ValueError, match=r"one.wav: 44100 samples/s, must be 48000"):
        block.prepare(48_000.0, 512)


def test_files_that_differ_or_are_not_there_are_refused_by_name(tmp_path: Path) -> None:
    files = written(tmp_path, one=np.ones((2, 2)), mono=np.ones((2, 1)))
    with pytest.raises(ValueError, match=r"mono.wav: 1 channels, must be 2"):
        ImpulseResponse(files)
    with pytest.raises(ValueError, match=r"missing.wav: No such file"):
        ImpulseResponse([files[0], str(tmp_path / "missing.wav")])
    for nothing in ([], "one.wav"):
        with pytest.raises(ValueError, match="must be a list with one WAV file per drive"):
            ImpulseResponse(nothing)
    with pytest.raises(ValueError, match="gain is 0.0, must be finite and not 0"):
        ImpulseResponse(files, gain=0.0)


def test_an_array_has_two_coils_and_shells_a_vibrator() -> None:
    block = VibratorArray(vibrators=3, hydrophones=2, seed=7)
    widths = [[(port.unit, port.width) for port in side] for side in (block.inputs, block.outputs)]
    assert widths == [[("V", 6)], [("m/s^2", 6), ("Pa", 2)]]
    block.prepare(RATE, 512)
    drive = np.repeat(noise(), 3, axis=1)
    found, expected = ([np.zeros((4096, 6)), np.zeros((4096, 2))] for _ in range(2))
    block.process(drive, *found)
    VibratorArrayPlant(RATE, vibrators=3, hydrophones=2, seed=7).run(drive, *expected)
    assert [each.tobytes() for each in found] == [each.tobytes() for each in expected]


def test_a_measured_head_and_two_loudspeakers_are_a_plant() -> None:
    block = ImpulseResponse([shared("kemar/H0e030a.wav"), shared("kemar/H0e090a.wav")])
    block.prepare(RATE, 512)
    response = run(block, noise())
    assert np.isfinite(response).all()
    assert response.std() > 0.1


def test_shells_in_front_of_impulse_responses_move_what_those_start_from(tmp_path: Path) -> None:
    taps = noise(900).reshape(900, 2)
    block = VibratorImpulseResponse(files=written(tmp_path, one=taps, two=taps[::-1]), gain=0.5, seed=3, **STILL)
    block.prepare(RATE, 512)
    shells, expected = np.zeros((4096, 2)), np.zeros((4096, 2))
    LumpedVibratorPlant(RATE, seed=3, **STILL).run(noise(), shells)
    ImpulseResponsePlant(0.5 * np.stack([taps, taps[::-1]], axis=-1).astype(np.float32)).run(shells, expected)
    np.testing.assert_allclose(run(block, noise()), expected, rtol=1e-6, atol=1e-6 * expected.std())


def test_the_sensors_behind_impulse_responses_have_noise(tmp_path: Path) -> None:
    block = VibratorImpulseResponse(files=written(tmp_path, one=np.ones((2, 2)), two=np.ones((2, 2))), noise=-60.0)
    block.prepare(RATE, 44_100)
    assert np.std(run(block, np.zeros((44_100, 2)), 44_100) - 0.0) == pytest.approx(0.01, rel=0.5)


def test_other_than_two_times_two_impulse_responses_are_refused_behind_a_vibrator(tmp_path: Path) -> None:
    one, two, mono = written(tmp_path, one=np.ones((2, 2)), two=np.ones((2, 2)), mono=np.ones((2, 1)))
    with pytest.raises(ValueError, match="files: 3 with 2 channels, must be two with two"):
        VibratorImpulseResponse(files=[one, two, one])
    with pytest.raises(ValueError, match="files: 2 with 1 channels, must be two with two"):
        VibratorImpulseResponse(files=[mono, mono])
    with pytest.raises(ValueError, match="simulator.options.nonlinearity is 9.0, must be 0 to 5$"):
        VibratorImpulseResponse(files=[one, two], nonlinearity=9.0)


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", MEASURED_PAIRS)
def test_measured_pairs_behind_the_vibrator_have_overtones_like_the_vibrator_itself(name: str, tmp_path: Path) -> None:
    """A sweep from 40 to 90 Hz of 10 m/s^2 on both sides: the loudest line above 101 Hz against the sweep."""
    made = [(Vibrator, {}), (VibratorImpulseResponse, {"files": measured_pair(name, tmp_path)})]
    usual, measured = (loudest_overtone(kind, options) for kind, options in made)
    assert -25 < usual < -8
    assert usual - 10 < measured < usual + 10


def loudest_overtone(kind: type[Block], options: dict[str, object]) -> float:
    """Drive what the linear plant would need for the sweep; return the loudest line from 101 to 645 Hz, dB re it."""
    frames = 5 * 44_100
    seconds = np.arange(frames) / 44_100
    sweep = (
        10
        * np.sin(2 * np.pi * (40 * seconds + 6.25 * seconds**2))
        * np.clip(10 * np.minimum(seconds, 4 - seconds), 0, 1)
    )
    wanted = np.fft.rfft(np.where(seconds < 4, sweep, 0.0))
    linear, lines = kind(nonlinearity=0.0, **STILL, **options), np.zeros((len(wanted), 2, 2), complex)
    for coil in range(2):
        linear.prepare(RATE, frames)
        impulse, response = np.zeros((frames, 2)), np.zeros((frames, 2))
        impulse[0, coil] = 1.0
        linear.process(impulse, response)
        lines[:, :, coil] = np.fft.rfft(response, axis=0)
    needed = np.zeros((len(wanted), 2), complex)
    band = slice(75, 3250)
    needed[band] = np.linalg.solve(lines[band], np.ones((2, 1)))[..., 0] * wanted[band, None]
    block, response = kind(**STILL, **options), np.zeros((frames, 2))
    block.prepare(RATE, frames)
    block.process(np.fft.irfft(needed, frames, axis=0), response)
    heard = np.abs(np.fft.rfft(response, axis=0))
    return float(20 * np.log10(heard[505:3225].max() / np.abs(wanted).max()))
