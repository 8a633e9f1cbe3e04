"""What a calibration may write: nothing that is there is written over, and nothing unfinished goes on as another."""

import json
from pathlib import Path

import h5py
import numpy as np
import pytest

from calibration.__main__ import main
from calibration.names import OutputError, raw_folder, refuse_inputs, refuse_taken
from calibration.output import Wish, output
from ctlblocks import recording
from ctlblocks.recording import Recording
from rigkit import config as rig_file
from rigkit.agreement import GOING_ON, DisagreementError
from rigkit.origin import RUN
from vibractl.config import RigConfig

SHORT = [
    "audio.isolated=false",
    "characterisation.records=3",
    "characterisation.period=1",
    "characterisation.run_in=0.3",
]


def rig(*overrides: str) -> RigConfig:
    """Return settings with some laid over them."""
    return rig_file.load(None, RigConfig, overrides)


def recorded(out: Path, *overrides: str, kind: str = "a calibration", finished: bool = True) -> bytes:
    """Leave what a calibration leaves; return the model's bytes."""
    writes = output(out, kind, rig(*overrides), Wish(), [out.with_suffix(".html")])
    with writes.begun():
        recording.write(writes.raw / "a.wav", Recording(("u",), ("V",), 100.0, np.zeros((3, 1), np.float32)))
    if finished:
        out.write_bytes(b"a model")
        out.with_suffix(".html").write_text("a page")
        writes.finish()
        return out.read_bytes()
    return b""


def test_a_finished_one_is_refused_with_its_ways_out(tmp_path: Path) -> None:
    recorded(tmp_path / "m.h5")
    with pytest.raises(OutputError, match=r"m.h5: was measured on 20.*finished; --again .* --recompute .*another name"):
        output(tmp_path / "m.h5", "a calibration", rig(), Wish())


def test_measured_again_the_old_one_is_kept_whole_under_its_date(tmp_path: Path) -> None:
    before = recorded(tmp_path / "m.h5")
    (tmp_path / "m-notes.txt").write_text("mine")
    writes = output(tmp_path / "m.h5", "a calibration", rig(), Wish(again=True), [tmp_path / "m.html"])
    with writes.begun():
        assert not (tmp_path / "m.h5").exists()
        recording.write(writes.raw / "a.wav", Recording(("u",), ("V",), 100.0, np.ones((3, 1), np.float32)))
    (kept,) = tmp_path.glob("m-2*.h5")
    assert kept.read_bytes() == before
    assert not recording.read(kept.with_suffix(".raw") / "a.wav").data.any()
    assert kept.with_suffix(".html").read_text() == "a page"
    assert (tmp_path / "m-notes.txt").read_text() == "mine"


def test_what_is_kept_twice_in_one_second_has_two_names(tmp_path: Path) -> None:
    for _ in range(3):
        recorded(tmp_path / "m.h5")
        with output(tmp_path / "m.h5", "a calibration", rig(), Wish(again=True), [tmp_path / "m.html"]).begun():
            pass
    assert len(list(tmp_path.glob("m-2*.h5"))) == 3


def test_computed_again_settings_and_date_are_those_of_the_recording(tmp_path: Path) -> None:
    recorded(tmp_path / "m.h5", "audio.input_full_scale=40.0")
    told = json.loads((tmp_path / "m.raw" / RUN).read_text())
    told["measured"] = "2020-01-02T03:04:05+00:00"
    (tmp_path / "m.raw" / RUN).write_text(json.dumps(told))
    writes = output(tmp_path / "m.h5", "a calibration", rig(), Wish(recompute=True))
    assert writes.is_recomputed
    assert writes.config.audio.input_full_scale == 40.0
    assert writes.provenance["date"] == "2020-01-02T03:04:05+00:00"
    assert writes.provenance["computed"] > "2026"
    assert writes.notes == ("computed again from the recordings of 2020-01-02T03:04:05+00:00, with their settings",)


def test_without_recordings_nothing_is_computed_again(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"--recompute: .*m.raw/ holds no recordings"):
        output(tmp_path / "m.h5", "a calibration", rig(), Wish(recompute=True))
    with pytest.raises(OutputError, match="one of them"):
        output(tmp_path / "m.h5", "a calibration", rig(), Wish(again=True, recompute=True))


def test_an_unfinished_one_goes_on_with_the_wiring_it_began_with_alone(tmp_path: Path) -> None:
    recorded(tmp_path / "m.h5", finished=False)
    assert output(tmp_path / "m.h5", "a calibration", rig(), Wish()).notes == ()
    wider = rig("audio.output_full_scale=20.0")
    with pytest.raises(DisagreementError, match=r"output_full_scale was 10.0, is 20.0; .*--accept audio.output_full"):
        output(tmp_path / "m.h5", "a calibration", wider, Wish())
    accepted = output(tmp_path / "m.h5", "a calibration", wider, Wish(accept=["audio.output_full_scale"]))
    assert accepted.origin.accepted == ("audio.output_full_scale",)
    patient = output(tmp_path / "m.h5", "a calibration", rig("audio.attempts=9"), Wish())
    assert len(patient.notes) == 1


def test_an_unfinished_one_does_not_go_on_as_another_kind(tmp_path: Path) -> None:
    recorded(tmp_path / "m.h5", finished=False)
    with pytest.raises(OutputError, match="is of a a calibration, this is a another"):
        output(tmp_path / "m.h5", "another", rig(), Wish())


def test_where_something_is_missing_a_finished_one_goes_on(tmp_path: Path) -> None:
    recorded(tmp_path / "m.h5")
    assert output(tmp_path / "m.h5", "a calibration", rig(), Wish(), is_whole=False).origin.finished == ""


def test_a_model_without_its_recordings_is_nobodys_to_write_over(tmp_path: Path) -> None:
    (tmp_path / "m.h5").write_bytes(b"bought")
    with pytest.raises(OutputError, match=r"m.h5: is there already, without its recordings"):
        output(tmp_path / "m.h5", "a calibration", rig(), Wish())
    with pytest.raises(OutputError, match="--again"):
        refuse_taken([tmp_path / "m.h5"], again=False)
    refuse_taken([tmp_path / "m.h5"], again=True)
    assert [path.read_bytes() for path in tmp_path.glob("m-*.h5")] == [b"bought"]


def test_where_nothing_was_recorded_no_folder_stays(tmp_path: Path) -> None:
    with output(tmp_path / "m.h5", "a calibration", rig(), Wish()).begun():
        assert raw_folder(tmp_path / "m.h5").is_dir()
    assert list(tmp_path.iterdir()) == []


def test_what_is_read_is_not_written(tmp_path: Path) -> None:
    (tmp_path / "link.toml").symlink_to(tmp_path / "stage.toml")
    with pytest.raises(OutputError, match=r"stage.toml: would be written, and was given to be read"):
        refuse_inputs([tmp_path / "stage.toml"], [None, tmp_path / "link.toml"])


def test_each_part_keeps_to_its_own_settings(tmp_path: Path) -> None:
    writes = output(tmp_path / "m.h5", "a calibration", rig(), Wish())
    with writes.begun():
        part = writes.part("pose-1", rig("limits.peak=3.0"), [], GOING_ON)
        assert writes.part("pose-1", rig("limits.peak=3.0"), [], GOING_ON) == part
        with pytest.raises(DisagreementError, match="limits.peak was 3.0, is 4.0"):
            writes.part("pose-1", rig("limits.peak=4.0"), [], GOING_ON)


def calibrated(monkeypatch: pytest.MonkeyPatch, out: Path, *arguments: str) -> int:
    """Call `calibrate vibrator` with short signals."""
    settings = [part for text in SHORT for part in ("--set", text)]
    monkeypatch.setattr("sys.argv", ["calibrate", "vibrator", "--out", str(out), *settings, *arguments])
    return main()


@pytest.mark.slow
def test_a_vibrator_whose_sensor_was_turned_round_is_measured_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "model.h5"
    turned = ("--set", "simulator.options.seed=4")
    assert calibrated(monkeypatch, out) == 0
    before = out.read_bytes()
    capsys.readouterr()
    assert calibrated(monkeypatch, out, *turned) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "is finished; --again measures again" in line
    assert out.read_bytes() == before
    assert calibrated(monkeypatch, out, *turned, "--recompute") == 0
    assert "with their settings" in capsys.readouterr().err
    with h5py.File(out) as file:
        assert "seed" not in str(file.attrs["provenance.config"])
        assert file.attrs["provenance.date"] == json.loads((out.with_suffix(".raw") / RUN).read_text())["measured"]
    assert calibrated(monkeypatch, out, *turned, "--again") == 0
    with h5py.File(out) as file:
        assert "seed = 4" in str(file.attrs["provenance.config"])
    (kept,) = tmp_path.glob("model-2*.h5")
    with h5py.File(kept) as file:
        assert "seed" not in str(file.attrs["provenance.config"])


def test_a_recording_under_another_full_scale_is_not_mixed_in(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "model.h5"
    assert calibrated(monkeypatch, out) == 0
    out.unlink()
    out.with_suffix(".html").unlink()
    told = json.loads((out.with_suffix(".raw") / RUN).read_text())
    (out.with_suffix(".raw") / RUN).write_text(json.dumps(told | {"finished": ""}))
    capsys.readouterr()
    assert calibrated(monkeypatch, out, "--set", "audio.output_full_scale=20.0") == 2
    assert "audio.output_full_scale was 10.0, is 20.0" in capsys.readouterr().err
    assert calibrated(monkeypatch, out) == 0


def test_an_unfinished_one_does_not_go_on_with_another_content_of_a_plants_file(tmp_path: Path) -> None:
    response = tmp_path / "one.wav"
    response.write_bytes(b"one")
    plant = ("simulator.plant=impulse-response", f'simulator.options.files=["{response}"]')
    recorded(tmp_path / "m.h5", *plant, finished=False)
    assert output(tmp_path / "m.h5", "a calibration", rig(*plant), Wish()).notes == ()
    response.write_bytes(b"two")
    with pytest.raises(DisagreementError, match=r"files, its content, was .*--accept simulator.options.files$"):
        output(tmp_path / "m.h5", "a calibration", rig(*plant), Wish())
    accepted = Wish(accept=["simulator.options.files"])
    writes = output(tmp_path / "m.h5", "a calibration", rig(*plant), accepted)
    assert writes.origin.accepted == ("simulator.options.files",)
    with writes.begun():
        pass
    assert output(tmp_path / "m.h5", "a calibration", rig(*plant), Wish()).provenance["parts"] != "{}"
