"""One recording is judged as the shot of a run is, wherever the reference lies in it."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import soundfile
from scipy.signal import chirp

from tests.vibractl.foreign.lab_of_files import LabOfFiles
from vibractl.judging import Judging

REFERENCE = ("--config", "rig.toml", "--reference", "chirp:40:90:1")


@pytest.fixture
def lab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> LabOfFiles:
    made = LabOfFiles(tmp_path, monkeypatch, capsys)
    made.begin()
    made.play(0)
    return made


def verdict(lab: LabOfFiles, name: str = "heard-0.wav", *words: str) -> dict[str, Any]:
    lab.done("vibractl", "judge", name, *REFERENCE, "--json", "judged.json", *words)
    found: dict[str, Any] = json.loads((lab.path / "judged.json").read_text())
    return found


def written(lab: LabOfFiles, name: str, data: np.ndarray) -> str:
    soundfile.write(lab.path / name, data, 44_100, "DOUBLE")
    return name


def heard(lab: LabOfFiles) -> np.ndarray:
    return np.asarray(soundfile.read(lab.path / "heard-0.wav", always_2d=True)[0])


def test_it_says_of_a_shot_what_a_run_says_of_it(lab: LabOfFiles) -> None:
    found = verdict(lab)
    lab.step(0)
    said = json.loads(
        lab.done("vibractl", "step", "--state", "S.h5", "--out", "1.wav", "--json", "-").split("1.wav:")[0]
    )
    assert said["shot"] == 1
    lab.run(1)
    row = dict(zip(*(line.split(",") for line in _rows(lab)), strict=True))
    worst = max(float(row[f"worst_line_db_{side}"]) for side in (1, 2))
    assert found["margin_db"] == pytest.approx(-worst, abs=0.05)
    assert found["met"] == (row["verdict"] == "pass")
    assert found["iae"][0] == pytest.approx(float(row["iae_1"]), rel=0.05)
    assert found["begins_s"] == pytest.approx(0.2, abs=1e-3)


def _rows(lab: LabOfFiles) -> list[str]:
    head, row = (lab.path / "run" / "qc.csv").read_text().splitlines()[:2]
    before, _, rest = row.partition('"')
    return [head, f"{before}{rest.partition(chr(34))[2]}" if rest else row]


def test_where_it_lies_in_the_recording_does_not_matter(lab: LabOfFiles) -> None:
    before = verdict(lab)
    noise = 1e-7 * np.random.default_rng(1).standard_normal((30_000, 2))
    found = verdict(lab, written(lab, "long.wav", np.vstack((noise, heard(lab), noise[:7_000]))))
    assert found["begins_s"] == pytest.approx(before["begins_s"] + 30_000 / 44_100, abs=1e-6)
    assert found["margin_db"] == pytest.approx(before["margin_db"], abs=0.01)


def test_the_reference_itself_meets_every_objective_and_an_inverted_side_is_said(lab: LabOfFiles) -> None:
    signal = Judging.of(lab.config).reference.signal / 400.0
    found = verdict(lab, written(lab, "exact.wav", np.pad(signal, ((9_000, 20_000), (0, 0)))))
    assert found["met"]
    assert found["margin_db"] > 100.0
    said = lab.done("vibractl", "judge", written(lab, "turned.wav", signal * [1, -1]), *REFERENCE)
    assert "response 2 is inverted" in said


def test_hum_that_is_there_in_silence_is_told_from_what_is_emitted(lab: LabOfFiles) -> None:
    signal = np.pad(Judging.of(lab.config).reference.signal / 400.0, ((9_000, 20_000), (0, 0)))
    time = np.arange(3 * len(signal)) / 44_100
    hum = np.repeat(2e-3 * np.sin(2 * np.pi * 150.0 * time)[:, None], 2, axis=1)
    written(lab, "hum.wav", hum)
    found = verdict(lab, written(lab, "with.wav", signal + hum[: len(signal)]), "--silence", "hum.wav")
    assert not found["met"]
    assert found["worst_hz"] == pytest.approx(150.0, abs=1.0)
    assert found["worst_is_silence"]
    assert found["silence_margin_db"][0] == pytest.approx(found["margin_db"], abs=1.0)
    quiet = verdict(
        lab, written(lab, "with.wav", signal + hum[: len(signal)]), "--silence", written(lab, "q.wav", 0.01 * hum)
    )
    assert not quiet["worst_is_silence"]


def test_channels_are_named_by_a_map(lab: LabOfFiles) -> None:
    found = verdict(lab)
    data = heard(lab)
    mixed = written(lab, "mixed.wav", np.stack([data[:, 1], np.zeros(len(data)), -data[:, 0]], axis=1))
    assert verdict(lab, mixed, "--map", "response_1=-3,response_2=1") == found
    said = lab.refused("vibractl", "judge", mixed, *REFERENCE, "--map", "response_1=3,response_2=4")
    assert "mixed.wav: no channel '4'; there are 1 channel_1" in said


def test_the_picture_is_drawn(lab: LabOfFiles) -> None:
    verdict(lab, "heard-0.wav", "--report", "judged.html", "--png", "figures")
    assert "data:image/" in (lab.path / "judged.html").read_text()
    assert [each.name for each in (lab.path / "figures").iterdir()] == ["spectrum-and-spectrogram.png"]


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (
            lambda data: np.random.default_rng(1).standard_normal(data.shape) / 100,
            "does not hold the reference: correlation 0.0",
        ),
        (lambda data: 0 * data, "bad.wav: silent, must hold a response"),
        (lambda data: data[:40_000], "bad.wav: 40000 samples, must be at least 44100, the reference's"),
        (lambda data: data[:, :1], "bad.wav: 1 channels (channel_1), must be 2, one for each response"),
        (lambda data: data[:, :1], "named response_1, response_2; --map response_1=CHANNEL,... says which they are"),
        (lambda data: np.where(np.arange(len(data))[:, None] == 100, np.inf, data), "sample 100: inf, must be finite"),
    ],
)
def test_what_cannot_be_judged_is_refused(lab: LabOfFiles, change: Any, reason: str) -> None:
    written(lab, "bad.wav", change(heard(lab)))
    assert reason in lab.refused("vibractl", "judge", "bad.wav", *REFERENCE)


def test_a_recording_of_the_reference_alone_is_judged(lab: LabOfFiles) -> None:
    whole = verdict(lab)
    begin = round(whole["begins_s"] * 44_100)
    cut = verdict(lab, written(lab, "cut.wav", heard(lab)[begin : begin + 44_100 + 5]))
    assert cut["begins_s"] == pytest.approx(whole["begins_s"] - begin / 44_100, abs=1e-4)
    assert cut["iae"] == pytest.approx(whole["iae"], rel=0.1)


def test_a_sweep_that_begins_as_a_cosine_is_told(lab: LabOfFiles) -> None:
    wide = ("--config", "rig.toml", "--reference", "chirp:20:600:1")
    sweep = chirp(np.arange(44_100) / 44_100, 20.0, 1.0, 600.0)
    said = lab.refused("vibractl", "judge", written(lab, "cosine.wav", 0.1 * np.c_[sweep, sweep]), *wide)
    assert "does not hold the reference: correlation 0." in said
    assert "with each of its tones a quarter of a period off: chirp:F0:F1:SECONDS begins as a sine" in said


def test_a_silence_shorter_than_a_shot_is_refused(lab: LabOfFiles) -> None:
    written(lab, "s.wav", heard(lab)[:1000])
    said = lab.refused("vibractl", "judge", "heard-0.wav", *REFERENCE, "--silence", "s.wav")
    assert "s.wav: 1000 samples, must be at least 70560, a shot's" in said
