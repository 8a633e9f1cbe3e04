"""A run on the simulated stage: it follows, is recorded, replays bit for bit, reports, and keeps faults."""

import json
import shutil
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from ctlblocks import recording
from ctlblocks.recording import Recording
from rigkit import config as rig_file
from rigkit.experiment import kept
from rigkit.experiment.kept import told
from rigkit.experiment.runner import STOPPED, Conduct
from rigkit.run_folder import read_events
from rigkit.stop import Stopped
from stagectl.commands.kinds_of_run import replayed, reported
from stagectl.config import StageConfig
from stagectl.experiments.piezo.cell import MADE, SEEN
from stagectl.experiments.piezo.experiment import STAGE_RUN
from stagectl.experiments.piezo.scenario import scenario_settings
from stagectl.models.model_file import read_model, write_model
from tests.rigkit.test_disk_space import leave
from tests.stagectl.experiments.piezo.simulated_models import write_models
from tests.stagectl.experiments.piezo.stage_runs import carried_out, new_run, recording_of, replay

QUICK = ["session.recording=wav", "session.lead=0.6", "outer.mistuning=0.0"]


def finished(folder: Path, *settings: str) -> Path:
    """Run with these settings; return the run's folder."""
    config = rig_file.load(None, StageConfig, [*QUICK, *settings])
    carried_out(folder / "run", config, write_models(folder))
    return folder / "run"


@cache
def held(folder: Path) -> Path:
    return finished(folder, "session.seconds=0.4")


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return held(tmp_path_factory.mktemp("held"))


def test_the_stage_holds_its_position_against_creep_and_noise(run: Path) -> None:
    figures = json.loads((run / "summary.json").read_text())
    assert figures["seconds"] == 0.4
    for axis in "xyz":
        assert figures["position_error"][axis]["mae"] < 0.2e-6
        assert figures["position_error"][axis]["within"] == 1.0


def test_everything_that_goes_in_and_out_is_recorded_with_names_and_units(run: Path) -> None:
    record = recording_of(run)
    assert record.names == tuple(f"{name}_{axis}" for name in ("wanted", *SEEN, *MADE) for axis in "xyz")
    assert record.units == ("m",) * 18 + ("V",) * 3
    assert len(record.data) == round(10_000 * (0.6 + 0.4 + 0.22))


def test_a_replay_makes_every_output_again_bit_for_bit(run: Path) -> None:
    done = replay(run)
    assert [each.channel for each in done] == [f"{name}_{axis}" for name in MADE for axis in "xyz"]
    assert all(each.identical and each.difference == 0.0 for each in done)


def test_a_replay_designs_nothing(run: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The loops are those that were used, whatever another SciPy would make of the models."""

    def fail(*_: object, **__: object) -> None:
        raise AssertionError("a design is looked for")

    monkeypatch.setattr("stagectl.experiments.piezo.setup.design", fail)
    assert all(each.identical for each in replayed(run))
    with pytest.raises(AssertionError, match="a design is looked for"):
        list(replayed(run, ["inner.bandwidth=[100.0]"]))


def test_other_settings_tell_what_would_have_been_made_of_the_sensors(run: Path) -> None:
    done = list(replayed(run, ["inner.bandwidth=[100.0]"]))
    assert {each.channel for each in done if not each.identical} >= {"voltage_x", "voltage_y", "voltage_z"}
    with pytest.raises(ValueError, match=r"limits\.ramps? "):
        list(replayed(run, ["limits.ramps=1"]))


def test_a_folder_of_before_is_designed_anew(run: Path, tmp_path: Path) -> None:
    path = tmp_path / "run"
    shutil.copytree(run, path)
    origin = json.loads((path / "run.json").read_text())
    del origin["designed"]
    (path / "run.json").write_text(json.dumps(origin))
    assert all(each.identical for each in replayed(path))


def test_a_replay_of_a_recording_that_was_touched_says_so(run: Path, tmp_path: Path) -> None:
    """One position, changed by its last bit."""
    for file in run.iterdir():
        if file.is_file():
            (tmp_path / file.name).write_bytes(file.read_bytes())
    record = recording.read(run / "recording.wav")
    data = record.data.copy()
    at = record.names.index("position_y")
    data[8_000, at] = np.nextafter(data[8_000, at], 1.0)
    recording.write(tmp_path / "recording.wav", Recording(record.names, record.units, record.rate, data))
    differing = {each.channel for each in replay(tmp_path) if not each.identical}
    assert differing == {"extension_reference_y", "voltage_y"}


def test_the_report_shows_tracking_errors_spectra_drives_and_loops(run: Path, tmp_path: Path) -> None:
    reported(run, tmp_path)
    page = (run / "report.html").read_text()
    for words in ("MAE of x", "Within ±5 µm, z", "Ms, mistuned", "Drives"):
        assert words in page
    drawn = sorted(file.name for file in tmp_path.iterdir())
    assert drawn == ["drives.png", "error.png", "loops.png", "spectra.png", "tracking-1.png", "tracking-2.png"]


def test_a_reference_from_a_file_is_followed(tmp_path: Path) -> None:
    time = np.arange(400) / 1_000.0
    data = 225e-6 + 20e-6 * np.column_stack([np.sin(2 * np.pi * 3 * time)] * 3)
    file = tmp_path / "reference.csv"
    recording.write(file, Recording(("x", "y", "z"), ("m",) * 3, 1_000.0, data))
    path = finished(tmp_path, "session.seconds=0.4", f"reference.signal={file}")
    record = recording_of(path)
    part = slice(6_000, 10_000)
    wanted = record.select(["wanted_y"]).data[part, 0]
    np.testing.assert_allclose(wanted[::10], data[:, 1], atol=1e-12)
    assert np.abs(wanted - record.select(["position_y"]).data[part, 0]).max() < 2e-6
    assert (path / "reference.csv").exists()


def test_a_reference_outside_the_travel_is_refused_before_anything_is_written(tmp_path: Path) -> None:
    file = tmp_path / "reference.csv"
    recording.write(file, Recording(("x", "y", "z"), ("m",) * 3, 1_000.0, np.full((10, 3), 5e-4)))
    with pytest.raises(ValueError, match=r"0.0005 to 0.0005 m, must be within limits.travel 2e-05 to 0.00043 m"):
        finished(tmp_path, f"reference.signal={file}")
    assert not (tmp_path / "run").exists()


def test_a_run_for_which_there_is_no_room_is_refused_before_anything_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    leave(200e6, monkeypatch)
    config, models = rig_file.load(None, StageConfig, [*QUICK, "session.seconds=100"]), write_models(tmp_path)
    with pytest.raises(OSError, match="the recordings may take 169.* MB, 200 MB are free"):
        new_run(tmp_path / "run", config, models)
    assert not (tmp_path / "run").exists()


def test_a_sensor_that_cannot_be_ends_the_run_at_rest_with_the_reason_kept(tmp_path: Path) -> None:
    """The range of the check is set so that the stage leaves it."""
    with pytest.raises(ValueError, match="is out of its range"):
        finished(tmp_path, "session.seconds=0.4", "sensors.position=[-1e-5, 2.2e-4]")
    path = tmp_path / "run"
    assert "is out of its range" in told(path, "ended")[""]["reason"]
    record = recording_of(path)
    voltage = record.select([f"voltage_{axis}" for axis in "xyz"]).data
    np.testing.assert_array_equal(voltage[-1], 500.0)
    assert all(each.identical for each in replay(path))


@pytest.mark.slow
def test_a_milling_run_compares_with_the_uncompensated_one(tmp_path: Path) -> None:
    """Short, as its beginning: what the cut does to the robot is taken off the tool by the stage."""
    base = rig_file.load(None, StageConfig, ["session.seconds=5"])
    settings = scenario_settings("milling-z", base.session)
    settings = [text.replace("seconds = 5.0", "seconds = 5.0, line_amplitude = 0.0") for text in settings]
    path = finished(tmp_path, *settings, "session.seconds=2.0")
    figures = json.loads((path / "summary.json").read_text())
    assert figures["improvement"]["z"] > 20
    assert figures["tool_error"]["z"]["peak"] < 5e-6
    assert all(each.identical for each in replay(path))


@pytest.mark.slow
def test_a_milling_run_is_prefiltered_by_what_the_uncompensated_one_has_shown(tmp_path: Path) -> None:
    cut = scenario_settings("milling-z", rig_file.load(None, StageConfig, ["session.seconds=5"]).session)
    settings = (*cut, "session.seconds=4.2", "simulator.surroundings_options.seconds=5.0")
    learned, plain = tmp_path / "learned", tmp_path / "plain"
    for folder in (learned, plain):
        folder.mkdir()
    path = finished(learned, *settings)
    found = json.loads((path / "summary.json").read_text())
    assert (path / "prefilter.json").is_file()
    assert found["prefilter"]["z"]["left"] < found["prefilter"]["z"]["without"]
    assert all(each.identical for each in replay(path))
    again = finished(plain, *settings, "session.compare=false", f"deflection.prefilter={path / 'prefilter.json'}")
    assert not (again / "prefilter.json").exists()
    assert all(each.identical for each in replay(again))
    config = rig_file.load(None, StageConfig, [*QUICK, *settings, f"deflection.prefilter={path / 'prefilter.json'}"])
    slower = config.model_copy(update={"outer": config.outer.model_copy(update={"max_sensitivity": 1.3})})
    with pytest.raises(ValueError, match=r"prefilter.json: the prefilter of . belongs to another loop"):
        new_run(tmp_path / "other", slower, write_models(plain))
    assert not (tmp_path / "other").exists()
    kept = [folder / "recording.wav" for folder in (path, again)]
    np.testing.assert_array_equal(*(recording.read(file).data for file in kept))


def test_a_run_too_short_to_learn_from_says_so_and_goes_on(tmp_path: Path) -> None:
    cut = scenario_settings("milling-z", rig_file.load(None, StageConfig, ["session.seconds=5"]).session)
    path = finished(tmp_path, *cut, "session.seconds=0.5")
    notes = [event["text"] for event in read_events(path) if event["event"] == "note"]
    assert notes == ["no prefilter: the disturbance has 0.72 s, must have 4 s or more"]
    assert "prefilter" not in json.loads((path / "summary.json").read_text())


def test_nothing_is_learned_of_a_stage_that_nobody_has_heard(tmp_path: Path) -> None:
    """Models of before say nothing of it: where they miss a resonance, a prefilter could make the plate swing."""
    cut = scenario_settings("milling-z", rig_file.load(None, StageConfig, ["session.seconds=5"]).session)
    files = write_models(tmp_path)
    for file in files:
        write_model(file, read_model(file))
    config = rig_file.load(None, StageConfig, [*QUICK, *cut, "session.seconds=0.5"])
    carried_out(tmp_path / "run", config, files)
    notes = [event["text"] for event in read_events(tmp_path / "run") if event["event"] == "note"]
    assert notes == ["no prefilter: the model of x does not hold the measured response of the stage: calibrate again"]


def test_a_scenario_that_is_unknown_or_too_short_is_refused() -> None:
    short = rig_file.load(None, StageConfig, ["session.seconds=2"]).session
    with pytest.raises(ValueError, match="must be one of milling-x, milling-y, milling-z"):
        scenario_settings("milling-w", short)
    with pytest.raises(ValueError, match="session.seconds is 2 s, must be 5 to 120 s"):
        scenario_settings("milling-x", short)


def test_models_that_are_missing_or_of_another_rate_are_refused(tmp_path: Path) -> None:
    files = write_models(tmp_path)
    config = StageConfig()
    with pytest.raises(ValueError, match="there are 2 model files, must be one for each of the axes x, y, z"):
        new_run(tmp_path / "run", config, files[:2])
    other = config.model_copy(update={"stage": config.stage.model_copy(update={"rate": 5_000.0})})
    with pytest.raises(ValueError, match="10000 samples/s, must be 5000"):
        new_run(tmp_path / "run", other, files)


def test_a_run_that_is_stopped_comes_to_rest_and_replays(tmp_path: Path) -> None:
    config = rig_file.load(None, StageConfig, [*QUICK, "session.seconds=5"])
    asked = iter(range(100))
    with pytest.raises(Stopped, match="nothing of the run proper is recorded; what is recorded is in"):
        carried_out(tmp_path / "run", config, write_models(tmp_path), lambda: next(asked) > 30)
    record = recording_of(tmp_path / "run")
    assert 2_500 < len(record.data) < 7_000
    np.testing.assert_array_equal(record.select(["voltage_x"]).data[-1], 500.0)
    assert all(each.identical for each in replay(tmp_path / "run"))


def test_a_run_that_is_stopped_while_its_reference_is_held_replays(tmp_path: Path) -> None:
    """Held for longer than was left of it: the timeline of what is made again must be longer by that."""
    config = rig_file.load(None, StageConfig, [*QUICK, "session.seconds=0.6"])
    folder, run = new_run(tmp_path / "run", config, write_models(tmp_path))
    asked = iter(range(10_000))
    with folder:
        conduct = Conduct(lambda: next(asked) > 300, held=lambda: True)
        reasons, _ = kept.run(folder, STAGE_RUN, run, conduct)
    assert reasons == {"": STOPPED}
    assert {"held"} <= {event["event"] for event in read_events(tmp_path / "run")}
    assert len(recording_of(tmp_path / "run").data) > run.made.timeline.total
    assert all(each.identical for each in replay(tmp_path / "run"))
