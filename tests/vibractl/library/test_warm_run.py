"""A run, kept, and another one that starts from it: resumed, replayed, refused, from the command line as well."""

import json
import re
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest

from ctlblocks import recording
from rigkit.run_folder import read_events, read_quality
from tests.vibractl.library.entries import entry_for
from tests.vibractl.linear_rig import linear_config, linear_model
from tests.vibractl.test_session import drives, go_on, run
from vibractl.__main__ import main
from vibractl.figures.result import read_result
from vibractl.library.entry import Entry, EntryError, write_entry
from vibractl.library.of_run import entry_of
from vibractl.replay import replay
from vibractl.run_setup import START, create, setup_of, shot_files
from vibractl.session import Session
from vibractl.shot_file import split


@pytest.fixture(scope="module")
def cold(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Make a run of six shots, beside its model."""
    folder = tmp_path_factory.mktemp("cold")
    run(folder / "run", linear_model(folder), 6, "learning.law=kalman")
    return folder / "run"


def warm_run(path: Path, entry: Entry, shots: int, *overrides: str) -> None:
    folder, made = create(path, linear_config("learning.law=kalman", *overrides), linear_model(path.parent), entry)
    with folder:
        session = Session(folder, made)
        session.run(shots, lambda *_: None, lambda: False)
        session.summary()


def events(path: Path) -> list[str]:
    return [event["event"] for event in read_events(path) if event["event"].startswith("library")]


@pytest.mark.slow
def test_the_drive_kept_is_the_one_recorded(cold: Path) -> None:
    entry = entry_of(cold, 4, {"depth": "10"})
    made = setup_of(cold)
    recorded, _ = split(recording.read(shot_files(cold)[4]), made.config)
    kept = made.learner().rendered(entry.drive)
    assert kept.tobytes() == recorded[made.shot.window].astype(np.float32).tobytes()
    with h5py.File(cold / "shots" / "0004.h5") as file:
        np.testing.assert_array_equal(entry.error, file["error"][...])
    assert entry.about["shot"] == "4"
    assert entry.about["run"] == str(cold)
    assert entry.about["software"].startswith("vibrostage")
    assert entry.tags == {"depth": "10"}
    assert entry.variance.min() > 0


@pytest.mark.slow
def test_a_run_that_other_software_would_have_learned_otherwise_is_kept_as_it_was_played(
    cold: Path, tmp_path: Path
) -> None:
    copy = Path(shutil.copytree(cold, tmp_path / "copy"))
    settings = (copy / "config.toml").read_text()
    (copy / "config.toml").write_text(re.sub(r"gains( *)= \[0.5\]", r"gains\1= [0.2]", settings))
    entry, made = entry_of(copy, 4, {}), setup_of(copy)
    assert made.config.learning.gains == (0.2,)
    recorded, _ = split(recording.read(shot_files(copy)[4]), made.config)
    played = recorded[made.shot.window]
    assert np.linalg.norm(made.learner().rendered(entry.drive) - played) < 1e-3 * np.linalg.norm(played)
    with h5py.File(copy / "shots" / "0004.h5") as file:
        np.testing.assert_array_equal(entry.error, file["error"][...])


def test_without_a_number_the_last_shot_that_met_the_objective_is_kept_or_else_the_best(
    cold: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = read_quality(cold)
    verdicts = ["fail", "pass", "pass", "fail", "check", "fail"]
    for row, verdict in zip(rows, verdicts, strict=True):
        row["verdict"] = verdict
    monkeypatch.setattr("vibractl.library.of_run.read_quality", lambda _: rows)
    assert entry_of(cold, None, {}).about["shot"] == "2"
    for number, row in enumerate(rows):
        row.update(verdict="check" if number == 5 else "fail", error_db_1=str(-number), error_db_2="-20")
    assert entry_of(cold, None, {}).about["shot"] == "4"
    with pytest.raises(ValueError, match="shot 5 was emitted to check or to reidentify, must be one of 0 to 4"):
        entry_of(cold, 5, {})
    with pytest.raises(ValueError, match="shot 6 is not recorded"):
        entry_of(cold, 6, {})


def test_a_warm_run_checks_learns_and_replays_bit_for_bit_without_the_library(cold: Path, tmp_path: Path) -> None:
    warm_run(tmp_path / "warm", entry_of(cold, None, {}).named("tank"), 5)
    path = tmp_path / "warm"
    rows = read_quality(path)
    assert [row["purpose"] for row in rows] == ["check"] * 3 + ["learn"] * 2
    assert [row["verdict"] == "check" for row in rows] == [True, True, False, False, False]
    assert rows[0]["reason"] == "at -12 dB, to check a drive of the library"
    assert events(path) == ["library", "library_accepted"]
    assert all(each.identical for each in replay(path, setup_of(path)))
    figures = json.loads((path / "summary.json").read_text())
    assert 1 < min(figures["iae_ratio"]) <= max(figures["iae_ratio"]) < 2  # from the first whole shot on
    assert [end.number for end in read_result(path).ends] == [2, 4]
    assert entry_of(path, None, {}).about["shot"] == "4"


@pytest.mark.slow
@pytest.mark.sample(1)
@pytest.mark.parametrize("stopped", [1, 2, 3])
def test_a_run_that_stops_in_the_middle_of_the_check_goes_on_with_it(cold: Path, tmp_path: Path, stopped: int) -> None:
    """The simulated plant starts anew: one shot after the stop is all that can be equal."""
    entry = entry_of(cold, None, {})
    for name, shots in (("whole", stopped + 1), ("halves", stopped)):
        (tmp_path / name).mkdir()
        warm_run(tmp_path / name / "run", entry, shots)
    go_on(tmp_path / "halves" / "run", stopped + 1)
    assert drives(tmp_path / "halves" / "run") == drives(tmp_path / "whole" / "run")
    assert all(each.identical for each in replay(tmp_path / "halves" / "run", setup_of(tmp_path / "halves" / "run")))
    assert [int(row["shot"]) for row in read_quality(tmp_path / "halves" / "run")] == list(range(stopped + 1))


def test_a_drive_that_breaks_a_limit_is_refused_before_a_shot_and_the_run_starts_as_without_it(
    cold: Path, tmp_path: Path
) -> None:
    entry = entry_of(cold, None, {})
    peak = float(np.abs(setup_of(cold).learner().rendered(entry.drive)).max())
    loud = Entry(**{**vars(entry), "drive": 9.5 / peak * entry.drive})
    warm_run(tmp_path / "warm", loud, 1)
    assert events(tmp_path / "warm") == ["library", "library_refused"]
    assert "limits.peak is 9 V" in read_events(tmp_path / "warm")[1]["limit"]
    assert [row["purpose"] for row in read_quality(tmp_path / "warm")] == ["learn"]
    assert drives(tmp_path / "warm")[0] == drives(cold)[0]


def test_another_machine_refuses_it_and_the_run_goes_on_as_without_it(cold: Path, tmp_path: Path) -> None:
    warm_run(tmp_path / "warm", entry_of(cold, None, {}), 3, "simulator.options.nonlinearity=1.6")
    assert events(tmp_path / "warm") == ["library", "library_refused"]
    assert [row["purpose"] for row in read_quality(tmp_path / "warm")] == ["check", "learn", "learn"]
    assert drives(tmp_path / "warm")[1] == drives(cold)[0]


def test_what_lacks_its_entry_is_refused(cold: Path, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="learning.start is 'library', and no entry of the library is given"):
        create(tmp_path / "run", linear_config("learning.start=library"), linear_model(tmp_path))
    assert not (tmp_path / "run").exists()
    warm_run(tmp_path / "warm", entry_of(cold, None, {}), 1)
    (tmp_path / "warm" / START).unlink()
    with pytest.raises(EntryError, match=r"start\.h5: there is no such entry"):
        setup_of(tmp_path / "warm")


def test_an_entry_that_does_not_fit_makes_no_run(tmp_path: Path) -> None:
    entry = entry_for(linear_config("rig.name=other"))
    with pytest.raises(ValueError, match="library entry kept is of rig 'other', this rig is 'simulated-vibrator'"):
        create(tmp_path / "run", linear_config(), linear_model(tmp_path), entry)
    assert not (tmp_path / "run").exists()


def command(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr("sys.argv", ["vibractl", *words])
    return main()


def test_a_person_keeps_lists_shows_and_removes(
    cold: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    place = ("--library", str(tmp_path / "library"))
    assert command(monkeypatch, "library", "add", str(cold), "--tag", "depth=10", *place) == 0
    assert command(monkeypatch, "library", "add", str(cold), "--name", "tank", "--shot", "3", *place) == 0
    (tmp_path / "library" / "bad.h5").write_bytes(b"")
    capsys.readouterr()
    assert command(monkeypatch, "library", "list", "--json", "-", *place) == 0
    listed = json.loads(capsys.readouterr().out)["entries"]
    assert [entry["name"] for entry in listed] == ["bad", "run-5", "tank"]
    assert "not a readable entry" in listed[0]["fault"]
    assert listed[1]["tags"] == {"depth": "10"}
    assert command(monkeypatch, "library", "show", "tank", "--json", "-", *place) == 0
    assert json.loads(capsys.readouterr().out)["shot"] == "3"
    near = ("library", "nearest", "--reference", "chirp:40:90:1", "--tag", "depth=9", "--json", "-")
    assert command(monkeypatch, *near, *place) == 0
    found = json.loads(capsys.readouterr().out)
    assert {each["name"]: each["distance"] for each in found["entries"]} == {"run-5": 1.0, "tank": 1.0}
    for name in ("bad", "tank"):
        assert command(monkeypatch, "library", "remove", name, *place) == 0
    assert [file.name for file in (tmp_path / "library").iterdir()] == ["run-5.h5"]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("add", "RUN", "--name", "../tank"), "must be 1 to 80 letters, digits"),
        (("add", "RUN", "--name", "nearest"), "is what --warm calls the nearest"),
        (("add", "RUN", "--name", "kept"), "has an entry 'kept' already; --force replaces it"),
        (("add", "RUN", "--tag", "depth"), "tag 'depth' is not key=value"),
        (("add", "RUN", "--shot", "9"), "shot 9 is not recorded"),
        (("add", "/nowhere"), "config.toml"),
        (("show", "tank"), "has no entry 'tank'; it holds kept"),
        (("remove", "../kept"), "must be 1 to 80 letters, digits"),
        (("nearest", "--reference", "chirp:40"), "is not chirp"),
    ],
)
def test_bad_input_is_one_line_and_changes_nothing(
    cold: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    words: tuple[str, ...],
    told: str,
) -> None:
    (tmp_path / "library").mkdir()
    write_entry(tmp_path / "library" / "kept.h5", entry_for())
    before = (tmp_path / "library" / "kept.h5").read_bytes()
    asked = [str(cold) if word == "RUN" else word for word in words]
    assert command(monkeypatch, "library", *asked, "--library", str(tmp_path / "library")) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert told in line
    assert [(file.name, file.read_bytes()) for file in (tmp_path / "library").iterdir()] == [("kept.h5", before)]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--warm", "tank"), "has no entry 'tank'; it holds kept"),
        (("--warm", "../kept"), "must be 1 to 80 letters, digits"),
        (("--warm", "nearest", "--reference", "sine:24:1"), "has no entry that fits: kept: of reference chirp:40:90:1"),
        (("--warm", "nearest", "--tag", "depth"), "is not key=value"),
        (("--tag", "depth=1"), "they go with --warm"),
        (("--warm", "kept", "--resume", "run"), "has the run's own settings"),
        (
            ("--warm", "kept", "--set", "learning.check_levels=[-6,-12,0]"),
            "must rise from above -80 dB and end at 0 dB",
        ),
    ],
)
def test_a_warm_run_that_cannot_start_is_one_line_and_leaves_nothing(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    words: tuple[str, ...],
    told: str,
) -> None:
    (tmp_path / "library").mkdir()
    write_entry(tmp_path / "library" / "kept.h5", entry_for())
    start = ["run", "--model", str(linear_model(tmp_path)), "--out", str(tmp_path / "run"), "--set"]
    place = [] if "--tag" in words and "--warm" not in words else ["--library", str(tmp_path / "library")]
    reference = [] if "--reference" in words else ["--reference", "chirp:40:90:1"]
    assert command(monkeypatch, *start, "audio.isolated=false", *reference, *place, *words) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert told in line
    assert not (tmp_path / "run").exists()
