"""The simulated vibrator from WAV to WAV: as a run would record it, from rest or as it was left."""

from pathlib import Path

import numpy as np
import pytest
import soundfile

from tests.vibractl.foreign.lab_of_files import LabOfFiles


@pytest.fixture
def lab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> LabOfFiles:
    made = LabOfFiles(tmp_path, monkeypatch, capsys)
    made.begin()
    return made


def played(lab: LabOfFiles, *words: str) -> np.ndarray:
    lab.done("firmware-sim", "play", "0.wav", "--config", "rig.toml", "--out", "heard.wav", *words)
    data, rate = soundfile.read(lab.path / "heard.wav", always_2d=True)
    assert rate == 44_100
    return np.asarray(data)


def test_from_rest_the_same_vibrator_gives_the_same_bits_and_another_one_others(lab: LabOfFiles) -> None:
    first = played(lab)
    assert len(first) == len(lab.volts(0))
    assert np.array_equal(played(lab), first)
    assert not np.allclose(played(lab, "--seed", "3"), first, atol=1e-4)


def test_with_a_state_it_goes_on_as_it_was_left(lab: LabOfFiles) -> None:
    first = played(lab)
    assert np.array_equal(played(lab, "--state", "V.h5"), first)
    again = played(lab, "--state", "V.h5")
    assert not np.array_equal(again, first)
    assert np.allclose(again, first, atol=1e-3)


def test_a_plant_of_ones_own_is_played_on(lab: LabOfFiles) -> None:
    files = [str(lab.path / f"coil-{coil}.wav") for coil in (1, 2)]
    for coil, file in enumerate(files):
        taps = np.zeros((3, 2))
        taps[1, coil] = 0.5
        soundfile.write(file, taps, 44_100, "DOUBLE")
    (lab.path / "own.toml").write_text(
        f"[simulator]\nplant = 'impulse-response'\n[simulator.options]\nfiles = {files}\n"
    )
    lab.done("firmware-sim", "play", "0.wav", "--config", "own.toml", "--out", "heard.wav")
    data, _ = soundfile.read(lab.path / "heard.wav", always_2d=True)
    assert np.allclose(400.0 * data[1:], 0.5 * lab.volts(0)[:-1], atol=1e-6)


@pytest.mark.sample(3)
@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (("--out", "0.wav"), "--out 0.wav is DRIVE.wav's file, must be another"),
        (("--out", "heard.flac"), "heard.flac: suffix is '.flac', must be .wav"),
        (("--out", "heard.wav", "--set", "limits.peak=0.1"), "the drive is not played: drive "),
        (
            ("--out", "heard.wav", "--set", "audio.rate=48000"),
            "0.wav: 44100 samples/s, must be audio.rate, 48000: nothing is resampled in silence",
        ),
        (("--out", "heard.wav", "--state", "V.h5", "--seed", "3"), "V.h5: simulator.options was"),
        (("--out", "heard.wav", "--state", "model.h5"), "model.h5: format is 'vibrostage transfer matrix 1'"),
        (("--out", "heard.wav", "--plant", "no-such"), "simulator.plant is 'no-such', must be vibrator, "),
    ],
)
def test_what_cannot_be_played_is_refused(lab: LabOfFiles, words: tuple[str, ...], reason: str) -> None:
    played(lab, "--state", "V.h5")
    assert reason in lab.refused("firmware-sim", "play", "0.wav", "--config", "rig.toml", *words)
