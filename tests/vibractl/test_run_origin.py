"""A run goes on, and a model is used, only with what it was made with, or with what a person has accepted by name."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ctlblocks import recording
from rigkit import config as rig_file
from rigkit.agreement import DisagreementError
from rigkit.run_folder import CONFIG, RunFolder, read_events
from tests.vibractl.linear_rig import linear_config, linear_matrix
from vibractl.__main__ import main
from vibractl.model_file import write_model
from vibractl.model_origin import model_for
from vibractl.run_setup import create, refuse_changed, refuse_other_wiring, resumed_setup, shot_files
from vibractl.session import Session
from vibractl.shot_file import split


def described_model(path: Path, *overrides: str) -> Path:
    """Write the linear rig's model, as measured with some settings."""
    matrix = linear_matrix()
    about = {**matrix.provenance, "config": rig_file.dump(linear_config(*overrides))}
    write_model(path, replace(matrix, provenance=about))
    return path


@pytest.fixture
def run(tmp_path: Path) -> Path:
    """Return the folder of a run of two shots."""
    folder, made = create(tmp_path / "run", linear_config(), described_model(tmp_path / "model.h5"))
    with folder:
        Session(folder, made).run(2, lambda *_: None, lambda: False)
    return tmp_path / "run"


def gone_on(path: Path, *accept: str) -> Session:
    """Take a run up again."""
    with RunFolder.open(path) as folder:
        return Session(folder, resumed_setup(folder, accept), accept=accept)


def other_machine(path: Path) -> None:
    """Put the model of another machine in the place of a run's."""
    matrix = linear_matrix()
    write_model(path / "model.h5", replace(matrix, response=matrix.response * 3 * np.exp(2j)))


def edited(path: Path, *overrides: str) -> None:
    """Edit the settings in a run's folder."""
    config = rig_file.load(path / CONFIG, type(linear_config()), overrides)
    (path / CONFIG).write_text(rig_file.dump(config))


def test_a_run_that_nobody_has_touched_goes_on_without_a_word(run: Path) -> None:
    assert gone_on(run).note == ""


def test_a_run_has_its_own_copies_of_the_plants_files(tmp_path: Path, files: list[str]) -> None:
    """So that it goes on where it was moved, and with what it began with."""
    plant = (f"simulator.options={{files={files!r}}}", "simulator.plant=impulse-response")
    rig = (*plant, "session.shots=1", "session.check=false")  # it is not the one that was calibrated
    folder, made = create(tmp_path / "run", linear_config(*rig), described_model(tmp_path / "model.h5"))
    with folder:
        Session(folder, made).run(1, lambda *_: None, lambda: False)
    for file in files:
        Path(file).unlink()
    moved = (tmp_path / "run").rename(tmp_path / "moved")
    with RunFolder.open(moved) as folder:
        session = Session(folder, resumed_setup(folder))
        assert session.note == ""
        session.run(2, lambda *_: None, lambda: False)
    assert len(shot_files(moved)) == 2
    (moved / "files" / "1" / "one.wav").write_bytes(b"another")
    with pytest.raises(DisagreementError, match=r"files/1/one.wav was "):
        gone_on(moved)


def test_with_another_machines_model_it_does_not_go_on(run: Path) -> None:
    other_machine(run)
    with pytest.raises(DisagreementError, match=r"has changed since the run began: model.h5 was .*--accept model.h5"):
        gone_on(run)


def test_a_model_that_was_accepted_still_has_to_give_the_drive_that_was_played(run: Path) -> None:
    other_machine(run)
    with pytest.raises(DisagreementError, match=r"shot 1: drive was .as recorded., is .*--accept drive"):
        gone_on(run, "model.h5")
    session = gone_on(run, "model.h5", "drive")
    assert session.done == 2
    assert "drive was" in session.note
    assert [event["keys"] for event in read_events(run) if event["event"] == "accepted"] == [["model.h5"]]


def test_a_run_that_is_accepted_goes_on_from_the_drive_that_was_played(run: Path) -> None:
    """With no gain the drive rebuilt is the first one, and the next one is the last that was played."""
    edited(run, "learning.gains=[0.0]")
    last, _ = split(recording.read(shot_files(run)[-1]), linear_config())
    session = gone_on(run, "learning.gains", "drive")
    assert np.linalg.norm(session.learner.drive - last) < 1e-3 * np.linalg.norm(last)
    first, _ = split(recording.read(shot_files(run)[0]), linear_config())
    assert np.linalg.norm(session.learner.drive - first) > 0.01 * np.linalg.norm(last)


@pytest.mark.slow
def test_without_a_record_of_its_beginning_the_drive_tells(run: Path) -> None:
    other_machine(run)
    (run / "run.json").unlink()
    with pytest.raises(DisagreementError, match="drive was"):
        gone_on(run)


@pytest.mark.sample(2)
@pytest.mark.parametrize(
    "override",
    ["audio.input_full_scale=200.0", "limits.peak=5.0", "learning.band=[20.0,640.0]", "simulator.options.seed=4"],
)
def test_settings_that_were_edited_since_are_refused_by_key_and_value(run: Path, override: str) -> None:
    key = override.partition("=")[0]
    edited(run, override)
    with pytest.raises(DisagreementError, match=rf"{key} was .*, is .*--accept {key}"):
        gone_on(run)
    with pytest.raises(DisagreementError, match=key):
        refuse_changed(run)
    assert len(shot_files(run)) == 2


def test_more_patience_is_said_and_does_no_harm(run: Path) -> None:
    edited(run, "audio.attempts=7", "characterisation.probe=0.2")
    assert gone_on(run).note.splitlines() == [
        f"{run}/ has changed since the run began: audio.attempts was 3, is 7",
    ]


def test_the_rig_may_not_have_been_wired_anew_before_its_run_goes_on(run: Path) -> None:
    refuse_other_wiring(run, linear_config("limits.peak=3.0"), [])
    with pytest.raises(DisagreementError, match="audio.output_full_scale was 10.0, is 20.0"):
        refuse_other_wiring(run, linear_config("audio.output_full_scale=20.0"), [])


@pytest.mark.parametrize(
    "override",
    [
        "audio.drive_channels=[2,1]",
        "audio.input_full_scale=4000.0",
        "audio.rate=48000",
        "audio.alignment=marker",
        "rig.name=other",
    ],
)
def test_a_model_of_another_wiring_is_refused_and_can_be_accepted(tmp_path: Path, override: str) -> None:
    key, model = override.partition("=")[0], described_model(tmp_path / "model.h5")
    with pytest.raises(DisagreementError, match=rf"wired otherwise: {key} was .*--accept {key}"):
        model_for(model, linear_config(override))
    with pytest.raises(DisagreementError, match=key):
        create(tmp_path / "run", linear_config(override), model)
    assert not (tmp_path / "run").exists()
    assert model_for(model, linear_config(override), [key])[1]


def test_a_model_of_another_simulated_machine_is_used_and_it_is_said(tmp_path: Path) -> None:
    model = described_model(tmp_path / "model.h5", "simulator.options.seed=1")
    _, notes = model_for(model, linear_config("simulator.options.seed=2"))
    assert notes == [
        f"{model} was measured on another simulated machine: simulator.options.seed was 1, is 2",
    ]


@pytest.mark.slow
def test_at_the_shell_a_refusal_is_one_line_and_what_is_accepted_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    model = described_model(tmp_path / "model.h5", "audio.input_full_scale=40.0")
    settings = [f"--set={name}" for name in ("audio.isolated=false", "simulator.options.nonlinearity=0.0")]
    command = ["vibractl", "run", "--model", str(model), "--out", str(tmp_path / "run"), "--shots", "1", *settings]
    command += ["--reference", "chirp:40:90:1"]
    monkeypatch.setattr("sys.argv", command)
    assert main() == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "audio.input_full_scale was 40.0, is 400.0" in line
    monkeypatch.setattr("sys.argv", [*command, "--accept", "audio.input_full_scale"])
    assert main() == 0
    assert "accepted" in capsys.readouterr().err
    monkeypatch.setattr("sys.argv", ["vibractl", "run", "--resume", str(tmp_path / "run"), "--shots", "2"])
    assert main() == 0


@pytest.mark.slow
@pytest.mark.parametrize("shots", ["0", "-1"])
def test_a_run_goes_on_for_one_shot_at_least(
    run: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], shots: str
) -> None:
    monkeypatch.setattr("sys.argv", ["vibractl", "run", "--resume", str(run), "--shots", shots])
    assert main() == 2
    assert "--shots" in capsys.readouterr().err
    assert len(shot_files(run)) == 2
