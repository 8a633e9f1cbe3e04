"""`calibrate vibrator --from`: a model out of files that `run` takes, or one line that says why not."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest
import soundfile

from calibration.__main__ import main
from calibration.from_command import opened_pair
from tests.calibration.recorded_lab import BAND, heard, noise, truth
from tests.vibractl.linear_rig import RATE, linear_config
from vibractl.model_file import read_model
from vibractl.model_origin import model_for

SECONDS = 3.0


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("files")
    for n in range(2):
        drive = noise(n, SECONDS)
        soundfile.write(folder / f"d{n}.wav", drive / 10.0, RATE, "PCM_24")
        soundfile.write(folder / f"r{n}.wav", heard(drive, 0.3, n) / 400.0, RATE, "PCM_24")
    damaged(folder)
    return folder


@pytest.fixture
def folder(files: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Go where the files are; what is written goes here."""
    monkeypatch.chdir(files)
    return tmp_path


PAIRS = ("--from", "d0.wav", "r0.wav", "--from", "d1.wav", "r1.wav", "--set", BAND[0])


def calibrate(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr(sys, "argv", ["calibrate", "vibrator", *words])
    return main()


@pytest.mark.slow
def test_recordings_of_24_bits_give_a_model_that_a_run_takes(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    figures = "--json", str(folder / "m.json"), "--png", str(folder / "figures")
    assert calibrate(monkeypatch, *PAIRS, "--out", str(folder / "m.h5"), *figures) == 0
    said = capsys.readouterr()
    assert "good" in said.out
    assert "times real time" in said.err
    matrix, notes = model_for(folder / "m.h5", linear_config())
    assert not [note for note in notes if "accepted" in note]
    size = np.linalg.norm(truth(matrix.frequency), axis=(1, 2))
    off = np.linalg.norm(matrix.response - truth(matrix.frequency), axis=(1, 2)) / size
    assert np.median(off) < 0.03
    read = json.loads((folder / "m.json").read_text())
    assert (read["lines"], read["gaps"]) == (len(matrix.frequency), [])
    assert [each["name"] for each in read["records"]] == ["r0.wav", "r1.wav"]
    assert [each["word"] for each in read["bands"]] == ["good", "good"]
    assert "Transfer matrix" in (folder / "m.html").read_text()
    assert len(list((folder / "figures").iterdir())) == 2
    assert read_model(folder / "m.h5").provenance["recording"] == "r0.wav, r1.wav"
    written = (folder / "m.h5").read_bytes()
    assert calibrate(monkeypatch, *PAIRS, "--out", str(folder / "m.h5")) == 2
    assert "m.h5: is there already" in capsys.readouterr().err
    assert (folder / "m.h5").read_bytes() == written
    assert calibrate(monkeypatch, *PAIRS, "--out", str(folder / "m.h5"), "--again") == 0
    assert [each.read_bytes() for each in folder.glob("m-*.h5")] == [written]


def test_one_file_may_hold_drives_and_responses(folder: Path, files: Path) -> None:
    rig, pair = linear_config(), (files / "d0.wav", files / "r0.wav")
    drive, response = (soundfile.read(each)[0] for each in pair)
    both = folder / "both.wav"
    soundfile.write(both, np.hstack([response, drive * [1, -1]]), RATE, "PCM_24")
    given = {"drive_1": "3", "drive_2": "-4", "response_1": "1", "response_2": "2"}
    apart, together = opened_pair(*pair, rig, {}), opened_pair(both, both, rig, given)
    np.testing.assert_allclose(together.drive.whole().data, apart.drive.whole().data, atol=1e-5)
    np.testing.assert_allclose(together.response.whole().data, apart.response.whole().data, atol=1e-5)


def damaged(folder: Path) -> None:
    """Write files that cannot be taken."""
    drive, rate = soundfile.read(folder / "d0.wav")
    response = soundfile.read(folder / "r0.wav")[0]
    (folder / "cut.wav").write_bytes((folder / "r0.wav").read_bytes()[:-5_000])
    (folder / "empty.wav").write_bytes(b"")
    soundfile.write(folder / "mono.wav", response[:, 0], rate, "PCM_24")
    soundfile.write(
        folder / "nan.wav", np.where(np.arange(len(response))[:, None] == 777, np.nan, response), rate, "FLOAT"
    )
    soundfile.write(folder / "loud.wav", np.clip(50 * response, -1, 1), rate, "PCM_24")
    soundfile.write(folder / "slow.wav", response, 48_000, "PCM_24")
    soundfile.write(folder / "short.wav", response[: RATE // 2], rate, "PCM_24")
    soundfile.write(folder / "other.wav", np.roll(response[::-1], 4_321, axis=0), rate, "PCM_24")
    soundfile.write(folder / "still.wav", response * [1, 0], rate, "PCM_24")
    soundfile.write(folder / "same.wav", drive[:, :1] * [1, 1.2], rate, "PCM_24")


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (("--from", "d0.wav"), "--from has 1 drives and 0 responses, must be a pair each time"),
        (("--from", "d0.wav", "gone.wav"), "gone.wav: there is no such file"),
        ((*PAIRS, "--quiet"), "--quiet and --from are given, must be one of them"),
        ((*PAIRS, "--recompute"), "--recompute and --from are given, must be one of them"),
        (("--correct-clock",), "--correct-clock is given without --from"),
        (("--map", "drive_1=1"), "--map is given without --from"),
        ((*PAIRS, "--map", "drive_1=1"), "d0.wav: --map has drive_1, must have drive_1, drive_2"),
        ((*PAIRS, "--out", "m.txt"), "m.txt: the suffix is '.txt', must be '.h5'"),
        ((*PAIRS, "--set", "audio.rate=48000"), "d0.wav: 44100 samples/s, must be audio.rate, 48000"),
        (("--from", "d0.wav", "d0.wav", "--set", "audio.response_channels=[1]"), "d0.wav: 2 channels"),
        (("--from", "d0.wav", "cut.wav"), "cut.wav: "),
        (("--from", "d0.wav", "empty.wav"), "empty.wav: "),
        (("--from", "d0.wav", "mono.wav"), "mono.wav: 1 channels"),
        (("--from", "d0.wav", "nan.wav"), "nan.wav: channel 'channel_1', sample 777: nan, must be finite"),
        (("--from", "d0.wav", "loud.wav"), "loud.wav: response 1 is clipped at full scale, "),
        (("--from", "d0.wav", "slow.wav"), "slow.wav: 48000 samples/s, must be audio.rate, 44100"),
        (("--from", "d0.wav", "short.wav"), "short.wav: 22050 samples, d0.wav has 132300, must be nearly as many"),
        (("--from", "d0.wav", "other.wav"), "no model comes of this: 30 to 130 Hz: the responses do not follow the"),
        (("--from", "d0.wav", "still.wav"), "still.wav: response 2 never changes, must move"),
        (("--from", "same.wav", "r0.wav"), "no model comes of this: 30 to 130 Hz: the drives are correlated and not"),
    ],
)
def test_what_gives_no_model_is_one_line_and_writes_nothing(
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    words: tuple[str, ...],
    reason: str,
) -> None:
    there = sorted(Path().iterdir())
    out = () if "--out" in words else ("--out", str(folder / "m.h5"))
    assert calibrate(monkeypatch, *words, *out, "--set", BAND[0]) == 2
    error = [line for line in capsys.readouterr().err.splitlines() if not line.startswith("from recordings")]
    assert len(error) == 1
    assert reason in error[0]
    assert sorted(Path().iterdir()) == there
    assert not list(folder.iterdir())
