"""Recordings of other software become the folder of a run, in which all commands work that have a sense there."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import scipy.io
import soundfile

from ctlblocks import recording
from rigkit.run_folder import read_events, read_quality
from tests.until import EVER
from tests.vibractl.foreign.lab_of_files import LabOfFiles
from tests.vibractl.foreign.lab_of_recordings import ACCELERATION, VOLTS, LabOfRecordings, recorded_shots
from tests.vibractl.linear_rig import RATE

LAST = "r1.wav"
KEYS = set(
    "shots objective_met_shot worst_line_db iae_ratio first_worst_line_db shots_over_limit full_level_shot "
    "loudest_line_db loudest_band_db shots_proven_over shots_hidden reidentifications "
    "identification_seconds floor_db floor_hz floor_explained_db".split()
)


def test_what_step_wrote_and_a_card_recorded_is_the_run_that_it_would_have_been(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    lab = LabOfFiles(tmp_path, monkeypatch, capsys)
    lab.begin()
    for shot in range(2):
        lab.play(shot)
        lab.step(shot)
    (lab.path / "2.wav").unlink()
    lab.run(2)
    pattern = ("--drive", "[0-9].wav", "--response", "heard-*.wav")
    lab.done("vibractl", "import", "--config", "rig.toml", *pattern, "--model", "model.h5", "--out", "IMPORTED")
    assert "no" not in [line.split()[1] for line in lab.done("vibractl", "replay", "IMPORTED").splitlines()[4:6]]
    for mine, its in zip(read_quality("IMPORTED"), read_quality("run"), strict=True):
        same = [key for key in its if key.startswith(("iae", "worst", "error", "overtone", "headroom", "verdict"))]
        assert len(same) > 15
        assert [mine[key] for key in same] == [its[key] for key in same]
    assert KEYS <= json.loads(Path("IMPORTED/summary.json").read_text()).keys()


@pytest.mark.slow
def test_without_a_model_what_needs_none_works_and_what_needs_one_says_so(recordings: LabOfRecordings) -> None:
    figures = recordings.imported("d?.wav", "r?.wav")
    assert figures.keys() == KEYS | {"warnings"}
    assert figures["shots"] == 2
    assert figures["identification_seconds"] is None
    recordings.done("vibractl", "report", "RUN", "--png", "figures")
    assert len(list(Path("figures").iterdir())) > 5
    recordings.done("vibractl", "export", "RUN", "--format", "csv", "--format", "mat")
    assert "model" not in scipy.io.loadmat("RUN/export/run.mat", simplify_cells=True)["run"]
    assert not Path("RUN/export/responses.csv").exists()
    for words in (("replay", "RUN"), ("library", "add", "RUN", "--library", "kept")):
        said = recordings.refused("vibractl", *words)
        assert "RUN/ was imported without a model, and this needs one: import it again with --model FILE" in said
    assert "2" in recordings.done("vibractl", "replay", "RUN", "--model", "model.h5", "--json", "-")
    said = recordings.call("vibractl", "run", "--resume", "RUN")
    assert said[0] == 2
    assert "RUN/ was played by other software and imported, so it is not resumed here" in said[1]


def test_with_a_model_it_is_kept_in_the_library_and_replayed(recordings: LabOfRecordings) -> None:
    recordings.imported("d?.wav", "r?.wav", "--model", "model.h5")
    recordings.done("vibractl", "library", "add", "RUN", "--library", "kept", "--name", "first")
    recordings.done("vibractl", "replay", "RUN", "--json", "replayed.json")
    replayed = json.loads(Path("replayed.json").read_text())
    assert replayed["differing"] == 2  # the law makes other drives of what was played, and that is no fault
    rows = read_quality("RUN")
    assert float(rows[1]["repeatability_db"]) < -40.0
    assert [row["purpose"] for row in rows] == ["imported", "imported"]


def table(file: Path, columns: np.ndarray, between: str, decimal: str, head: str) -> None:
    time = np.arange(len(columns)) / RATE
    with file.open("w", newline="") as out:
        out.write(between.join(["time", *head.split(",")]) + "\n")
        for row in np.column_stack((time, columns)):
            out.write(between.join(f"{value:.9g}".replace(".", decimal) for value in row) + "\n")


def written_as(lab: LabOfRecordings, kind: str, name: str, drive: np.ndarray, response: np.ndarray) -> str:
    """Write a shot as a file that holds both; return its name."""
    both = np.hstack((drive, response))
    names = ["drive_1", "drive_2", "response_1", "response_2"]
    if kind in ("csv", "tsv", "semicolon"):
        file = f"{name}.{'tsv' if kind == 'tsv' else 'csv'}"
        between, decimal = {"csv": (",", "."), "tsv": ("\t", "."), "semicolon": (";", ",")}[kind]
        units = ("V", "V", "m/s^2", "m/s^2")
        head = ",".join(f"{each} [{unit}]" for each, unit in zip(names, units, strict=True))
        table(lab.path / file, both, between, decimal, head)
    elif kind == "hdf5":
        file = f"{name}.h5"
        with h5py.File(lab.path / file, "w") as out:
            out.attrs["rate"] = RATE
            for each, column in zip(names, both.T, strict=True):
                out[each] = column
    else:
        file = f"{name}.mat"
        scipy.io.savemat(lab.path / file, {"fs": RATE, **dict(zip(names, both.T, strict=True))})
    return file


@pytest.mark.sample(2)
@pytest.mark.parametrize(
    ("kind", "form", "name"),
    [
        ("PCM_16", None, "wav"),
        ("PCM_24", None, "wav"),
        ("FLOAT", None, "wav"),
        ("FLOAT", "RF64", "wav"),
        ("PCM_24", None, "flac"),
    ],
)
def test_sounds_of_every_kind_give_the_same_figures(
    recordings: LabOfRecordings, kind: str, form: str | None, name: str
) -> None:
    drive, response = recorded_shots()[1]
    both = np.hstack((response / ACCELERATION, 0 * drive, drive / VOLTS))
    file = recordings.sound(f"both.{name}", 0.999 * both, kind, form)
    channels = "response_1=1,response_2=2,drive_1=5,drive_2=6"
    mine = recordings.imported(file, file, "--map", channels)
    assert mine["worst_line_db"] == pytest.approx(wanted(recordings)["worst_line_db"], abs=0.5)


@pytest.mark.sample(2)
@pytest.mark.parametrize("kind", ["csv", "tsv", "semicolon", "hdf5", "mat"])
def test_tables_and_arrays_give_the_same_figures(recordings: LabOfRecordings, kind: str) -> None:
    file = written_as(recordings, kind, "both", *recorded_shots()[1])
    mine = recordings.imported(file, file)
    assert mine["worst_line_db"] == pytest.approx(wanted(recordings)["worst_line_db"], abs=0.05)
    its = recording.read("ALONE/shots/0000.wav").data
    assert np.abs(recording.read("RUN/shots/0000.wav").data - its).max() < 1e-5


def wanted(lab: LabOfRecordings) -> dict[str, Any]:
    """Return the figures of the second shot, from two sounds."""
    lab.done(*lab.words("d1.wav", LAST, "--out", "ALONE"))
    figures: dict[str, Any] = json.loads((lab.path / "ALONE" / "summary.json").read_text())
    return figures


def test_scales_are_those_of_the_rig_file_or_what_is_said(recordings: LabOfRecordings) -> None:
    for name, factor in (("d0.wav", 2.0), ("r0.wav", 4.0)):
        data, _ = soundfile.read(name, always_2d=True)
        recordings.sound(f"other-{name}", factor * data)
    scales = ("--volts-per-full-scale", "5", "--mps2-per-full-scale", "100")
    recordings.imported("other-d0.wav", "other-r0.wav", "--model", "model.h5", *scales)
    drive, response = recorded_shots()[0]
    kept = recording.read("RUN/shots/0000.wav").data
    assert np.allclose(kept, np.hstack((drive, response)), atol=1e-5)
    said = recordings.import_refused("d0.wav", "r0.wav", "--volts-per-full-scale", "0")
    assert "--volts-per-full-scale is 0, must be > 0" in said


def test_shots_of_a_long_recording_are_found_and_shown_before_anything_is_written(recordings: LabOfRecordings) -> None:
    shots, gaps = recorded_shots(), (12_345, 40_000)
    parts = [np.vstack((np.zeros((gap, 2)), shot[0])) for gap, shot in zip(gaps, shots, strict=True)]
    drive = recordings.sound("drives.wav", np.vstack(parts) / VOLTS)
    parts = [np.vstack((np.zeros((gap, 2)), shot[1])) for gap, shot in zip(gaps, shots, strict=True)]
    response = recordings.sound("responses.wav", np.vstack(parts) / ACCELERATION)
    found = recordings.shown(drive, response)
    begins = [12_345 + 8_820, 12_345 + 70_560 + 40_000 + 8_820]
    assert [each["begins_s"] for each in found] == pytest.approx([at / RATE for at in begins], abs=2e-5)
    assert min(each["correlation"] for each in found) > 0.99
    said = recordings.done(*recordings.words(drive, response, "--out", "RUN"))
    assert "2 shots of chirp:40:90:1" in said
    assert len(read_quality("RUN")) == 2
    kept = [recording.read(f"RUN/shots/000{shot}.wav").data[:, 2:] for shot in range(2)]
    assert all(np.abs(mine - its[1]).max() < 2e-2 for mine, its in zip(kept, shots, strict=True))


def test_one_drive_is_found_wherever_it_was_played(recordings: LabOfRecordings) -> None:
    drive, response = recorded_shots()[0]
    long = np.vstack((np.zeros((5_000, 2)), response, np.zeros((9_000, 2)), response))
    file = recordings.sound("twice.wav", long / ACCELERATION)
    found = recordings.shown("d0.wav", file, "--model", "model.h5")
    begins = [13_820, 13_820 + 70_560 + 9_000]
    assert [RATE * each["begins_s"] for each in found] == pytest.approx(begins, abs=0.2)
    recordings.imported("d0.wav", file, "--model", "model.h5")
    assert all(np.abs(recording.read(f"RUN/shots/000{n}.wav").data[:, :2] - drive).max() < 1e-6 for n in range(2))


def test_files_go_by_numbers_and_unequal_counts_are_refused(recordings: LabOfRecordings) -> None:
    for name in ("d", "r"):
        Path(f"{name}1.wav").rename(f"{name}10.wav")
        Path(f"{name}0.wav").rename(f"{name}9.wav")
    recordings.imported("d*.wav", "r*.wav")
    told = [event["response"] for event in read_events("RUN") if event["event"] == "shot"]
    assert told == ["r9.wav", "r10.wav"]
    Path("d9.wav").unlink()
    said = recordings.refused(*recordings.words("d*.wav", "r*.wav", "--out", "OTHER"))
    assert "--drive d*.wav is 1 files and --response r*.wav 2, must be as many" in said
    said = recordings.refused(*recordings.words("x*.wav", "r*.wav", "--out", "OTHER"))
    assert "x*.wav: no file is called so" in said


def test_silence_tells_noise_from_what_is_emitted(recordings: LabOfRecordings) -> None:
    drive, response = recorded_shots()[0]
    time = np.arange(2 * len(response)) / RATE
    hum = np.repeat(0.5 * np.sin(2 * np.pi * 150.0 * time)[:, None], 2, axis=1)
    recordings.sound("hum.wav", hum / ACCELERATION)
    recordings.sound("r0.wav", (response + hum[: len(response)]) / ACCELERATION)
    recordings.imported("d0.wav", "r0.wav", "--silence", "hum.wav")
    events = read_events("RUN")
    assert min(next(each["over_the_limit_db"] for each in events if each["event"] == "silence")) > 5.0
    assert any("is as loud in silence" in each.get("text", "") for each in events)
    recordings.sound("short.wav", hum[:1_000])
    said = recordings.refused(*recordings.words("d0.wav", "r0.wav", "--silence", "short.wav", "--dry-run"))
    assert "short.wav: 1000 samples, must be at least 70560, a shot's" in said


KILLED = """
import os, signal, sys
from ctlblocks import recording
from vibractl.__main__ import main
whole = recording.write
def write(path, record):
    whole(path, record)
    os.kill(os.getpid(), signal.SIGKILL)
recording.write = write
sys.argv = ["vibractl", "import", *sys.argv[1:]]
main()
"""


@pytest.mark.slow
def test_killed_at_its_first_shot_it_leaves_no_run_and_is_made_by_the_same_command(recordings: LabOfRecordings) -> None:
    words = recordings.words("d?.wav", "r?.wav", "--out", "RUN")
    done = subprocess.run([sys.executable, "-c", KILLED, *words[2:]], check=False, timeout=EVER, capture_output=True)
    assert done.returncode < 0, done.stderr
    assert not Path("RUN").exists()
    assert any(each.name.startswith(".RUN.") for each in Path().iterdir())
    recordings.done(*words)
    assert not any(each.name.startswith(".RUN.") for each in Path().iterdir())
    assert len(read_quality("RUN")) == 2
