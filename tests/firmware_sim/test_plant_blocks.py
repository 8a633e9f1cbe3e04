"""The plants as blocks: at rest after prepare, refused in words when they cannot be built."""

import inspect
from pathlib import Path

import numpy as np
import pytest
import soundfile

from ctlblocks.block import Block
from firmware_sim.plant_blocks import ImpulseResponse, Vibrator
from firmware_sim.plants.vibrator import VibratorPlant

KEMAR = Path("/work/shared/data/kemar")
RATE = 44_100.0


def run(block: Block, drive: np.ndarray, frames: int = 512) -> np.ndarray:
    response = np.full((len(drive), block.outputs[0].width), np.nan)
    for start in range(0, len(drive), frames):
        block.process(drive[start : start + frames], response[start : start + frames])
    return response


def drive(samples: int = 4096) -> np.ndarray:
    return np.random.default_rng(1).standard_normal((samples, 2))


def written(tmp_path: Path, **columns: np.ndarray) -> list[str]:
    for name, column in columns.items():
        soundfile.write(tmp_path / f"{name}.wav", column, int(RATE), subtype="FLOAT")
    return [str(tmp_path / f"{name}.wav") for name in columns]


def test_the_vibrator_block_is_the_vibrator_plant_with_the_same_options() -> None:
    own = list(inspect.signature(Vibrator).parameters.values())
    assert own == list(inspect.signature(VibratorPlant).parameters.values())[1:]
    block, plant = Vibrator(seed=7, nonlinearity=2.0), VibratorPlant(RATE, seed=7, nonlinearity=2.0)
    block.prepare(RATE, 512)
    expected = np.empty((4096, 2))
    plant.run(drive(), expected)
    assert run(block, drive()).tobytes() == expected.tobytes()


def test_prepared_again_the_vibrator_is_at_rest_and_gives_the_same() -> None:
    block = Vibrator()
    runs = []
    for frames in (512, 64):
        block.prepare(RATE, frames)
        runs.append(run(block, drive(), frames))
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
    block = ImpulseResponse(written(tmp_path, one=drive(600), two=drive(600)))
    runs = []
    for frames in (512, 64):
        block.prepare(RATE, frames)
        runs.append(run(block, drive(), frames))
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


@pytest.mark.skipif(not KEMAR.is_dir(), reason=f"{KEMAR} is not here")
def test_a_measured_head_and_two_loudspeakers_are_a_plant() -> None:
    block = ImpulseResponse([KEMAR / "H0e030a.wav", KEMAR / "H0e090a.wav"])
    block.prepare(RATE, 512)
    response = run(block, drive())
    assert np.isfinite(response).all()
    assert response.std() > 0.1
