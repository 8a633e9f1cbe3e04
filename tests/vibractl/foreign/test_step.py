"""A learning step by step over files is the learning of a run, and takes no recording that is not its own."""

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


def altered(lab: LabOfFiles, name: str, change: object) -> None:
    """Write a recorded sound again, changed."""
    data, rate = soundfile.read(lab.path / name, always_2d=True)
    assert callable(change)
    soundfile.write(lab.path / name, change(data), rate, "DOUBLE")


@pytest.mark.parametrize("shots", [4, pytest.param(10, marks=pytest.mark.slow)])
def test_steps_and_plays_give_the_drives_of_a_run_bit_for_bit(lab: LabOfFiles, shots: int) -> None:
    for shot in range(shots - 1):
        lab.play(shot)
        lab.step(shot)
    wanted = lab.run(shots)
    assert all(np.array_equal(lab.volts(shot), drive) for shot, drive in enumerate(wanted))
    assert not np.array_equal(wanted[0], wanted[-1])


def test_a_drive_that_was_lost_is_written_again(lab: LabOfFiles) -> None:
    lab.play(0)
    lab.step(0)
    whole = lab.volts(1)
    (lab.path / "1.wav").unlink()
    assert "the drive of shot 1" in lab.done("vibractl", "step", "--state", "S.h5", "--out", "1.wav")
    assert np.array_equal(lab.volts(1), whole)  # the files differ: their header has the second of writing


def test_killed_before_the_state_is_written_the_same_step_gives_the_same_drive(
    lab: LabOfFiles, monkeypatch: pytest.MonkeyPatch
) -> None:
    lab.play(0)
    words = ("vibractl", "step", *lab.recorded(0), "--state", "S.h5", "--out", "1.wav")
    with monkeypatch.context() as patched:
        patched.setattr("vibractl.foreign.step_state.StepState.write", _killed)
        assert lab.call(*words)[0] == 130
    half = lab.volts(1)
    lab.step(0)
    assert np.array_equal(lab.volts(1), half)


def _killed(*_: object) -> None:
    raise KeyboardInterrupt


@pytest.mark.slow
def test_a_recording_longer_than_the_shot_is_cut_where_the_drive_is_found(lab: LabOfFiles) -> None:
    lab.play(0)
    late = np.zeros((1234, 2))
    for name in ("0.wav", "heard-0.wav"):
        altered(lab, name, lambda data: np.vstack((late, data, late)))
    lab.step(0)
    assert np.array_equal(lab.volts(1), lab.run(2)[1])


def test_the_same_recording_twice_is_refused(lab: LabOfFiles) -> None:
    lab.play(0)
    lab.step(0)
    said = lab.refused(
        "vibractl", "step", "--drive", "1.wav", "--response", "heard-0.wav", "--state", "S.h5", "--out", "2.wav"
    )
    assert "heard-0.wav: was learned from before, as shot 0" in said


@pytest.mark.sample(4)
@pytest.mark.parametrize(
    ("name", "change", "reason"),
    [
        ("0.wav", lambda data: data[::-1], "0.wav: is not the drive that was to be played: correlation"),
        ("0.wav", lambda data: -data, "0.wav: drive 1 is inverted"),
        ("0.wav", lambda data: data[:-1], r"0.wav: 70559 samples, must be at least 70560, the shot's"),
        ("0.wav", lambda data: data[:, :1], "0.wav: 1 channels (channel_1), must be 2, one for each drive"),
        ("heard-0.wav", lambda data: data[:-1], "heard-0.wav: 70559 samples, must be at least 70560"),
        ("heard-0.wav", lambda data: np.clip(50 * data, -1, 1), "heard-0.wav: clipped at full scale, response"),
        ("heard-0.wav", lambda data: data * [1, 0], "heard-0.wav: a sensor that does not move: response 2"),
        ("heard-0.wav", lambda data: data * np.nan, "heard-0.wav: channel 'channel_1', sample 0: nan, must be finite"),
        ("heard-0.wav", lambda data: np.roll(data, 20_000, axis=0), "it is most like it +0.45"),
        (
            "heard-0.wav",
            lambda data: 1e-3 * np.random.default_rng(1).standard_normal(data.shape),
            "heard-0.wav: does not belong to this drive: correlation 0.0",
        ),
    ],
)
def test_what_is_not_this_shot_is_refused_by_its_file(lab: LabOfFiles, name: str, change: object, reason: str) -> None:
    lab.play(0)
    altered(lab, name, change)
    assert reason in lab.refused("vibractl", "step", *lab.recorded(0), "--state", "S.h5", "--out", "1.wav")


def test_another_rate_is_refused(lab: LabOfFiles) -> None:
    lab.play(0)
    data, _ = soundfile.read(lab.path / "heard-0.wav", always_2d=True)
    soundfile.write(lab.path / "heard-0.wav", data, 48_000, "DOUBLE")
    said = lab.refused("vibractl", "step", *lab.recorded(0), "--state", "S.h5", "--out", "1.wav")
    assert "heard-0.wav: 48000 samples/s, must be audio.rate, 44100" in said


def test_other_settings_model_or_reference_than_it_began_with_are_refused_until_accepted(lab: LabOfFiles) -> None:
    lab.play(0)
    words = ("vibractl", "step", *lab.recorded(0), "--state", "S.h5", "--out", "1.wav")
    said = lab.refused(*words, "--reference", "chirp:40:80:1")
    assert 'S.h5 began otherwise: reference.signal was "chirp:40:90:1", is "chirp:40:80:1"' in said
    said = lab.refused(*words, "--config", "rig.toml", "--set", "audio.input_full_scale=200.0")
    assert "audio.input_full_scale was 400.0, is 200.0" in said
    (lab.path / "other.h5").write_bytes(b"another")
    assert "model.h5 was" in lab.refused(*words, "--model", "other.h5")
    assert "accepted" in lab.done(*words, "--model", "other.h5", "--accept", "model.h5")


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (("--drive", "0.wav"), "--drive and --response go together"),
        (("--drive", "0.wav", "--response", "0.wav", "--bits", "12"), "--bits is 12, must be 16, 24, 32, 64"),
        (("--drive", "1.wav", "--response", "0.wav"), "--out 1.wav is --drive's file, must be another"),
        (("--drive", "gone.wav", "--response", "0.wav"), "gone.wav: there is no such file"),
        (("--state", "0.wav"), "0.wav: is no HDF5 file, or a damaged one"),
        (("--state", "model.h5"), "model.h5: format is 'vibrostage transfer matrix 1', must be"),
        (
            ("--state", "T.h5", "--drive", "0.wav", "--response", "0.wav"),
            "T.h5: there is no such state yet; begin with",
        ),
    ],
)
def test_a_call_that_cannot_be_is_refused(lab: LabOfFiles, words: tuple[str, ...], reason: str) -> None:
    assert reason in lab.refused("vibractl", "step", "--state", "S.h5", "--out", "1.wav", *words)


def test_a_first_drive_beyond_the_limits_is_not_written_or_fitted(lab: LabOfFiles) -> None:
    (lab.path / "S.h5").unlink()
    begin = ("--config", "rig.toml", "--model", "model.h5", "--state", "S.h5", "--out", "1.wav")
    said = lab.refused("vibractl", "step", *begin, "--set", "limits.peak=0.5")
    assert "the first drive is refused: drive " in said
    assert "limits.peak is 0.5 V; it needs " in said
    fitted = lab.done("vibractl", "step", *begin, "--set", "limits.peak=0.5", "--fit-amplitude")
    assert "reference.amplitude is " in fitted
    assert np.abs(lab.volts(1)).max() == pytest.approx(0.25, rel=0.01)
    again = lab.refused("vibractl", "step", "--state", "S.h5", "--out", "2.wav", "--fit-amplitude")
    assert "S.h5 has begun: its reference cannot change" in again


def test_a_next_drive_beyond_the_limits_is_not_written(lab: LabOfFiles, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("vibractl.foreign.stepping.too_loud", lambda *_: "drive 1 asks for 9.5 V")
    lab.play(0)
    said = lab.refused("vibractl", "step", *lab.recorded(0), "--state", "S.h5", "--out", "1.wav")
    assert "the next drive is not written: drive 1 asks for 9.5 V" in said


def test_fewer_bits_are_near_enough_to_learn_from(lab: LabOfFiles) -> None:
    words = ("--state", "S.h5", "--out", "0.wav", "--bits", "24")
    lab.done("vibractl", "step", *words)
    assert soundfile.info(lab.path / "0.wav").subtype == "PCM_24"
    lab.play(0)
    lab.step(0)
    assert np.abs(lab.volts(1) - lab.run(2)[1]).max() < 1e-4
