"""The folder of a run: never overwritten, held by one process, resumable after a kill at any moment."""

import json
import subprocess
import sys
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from ctlblocks import recording
from rigkit import run_folder
from rigkit.growing_wav import Channels, GrowingWav
from rigkit.lock import FolderInUseError
from rigkit.run_folder import RunFolder, make_whole, read_events, read_quality
from tests.until import EVER


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "runs" / "first"


def test_a_new_folder_holds_its_configuration_and_a_place_for_shots_once_there_are_some(path: Path) -> None:
    with RunFolder.create(path, "[rig]\n") as folder:
        assert (path / "config.toml").read_text() == "[rig]\n"
        assert not (path / "shots").exists()
        assert folder.shot(7) == path / "shots" / "0007.wav"
        assert (path / "shots").is_dir()


def test_a_folder_with_content_is_refused_and_left_as_it_was(path: Path) -> None:
    path.mkdir(parents=True)
    (path / "thesis.txt").write_text("years of work")
    with pytest.raises(FolderInUseError, match=r"first/ is in use: it holds thesis\.txt; choose another folder$"):
        RunFolder.create(path, "")
    assert [entry.name for entry in path.iterdir()] == ["thesis.txt"]


def test_a_run_is_not_started_where_one_has_been(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    RunFolder.create(path, "").close()
    unrecorded = r"it holds a run of which nothing is recorded \(config.toml\); delete it, or choose another folder$"
    with pytest.raises(FolderInUseError, match=unrecorded):
        RunFolder.create(path, "")
    (path / "cell.csv").write_text("a record")
    with pytest.raises(
        FolderInUseError, match=r"a run \(cell.csv, config.toml\); `report` shows it, or choose another"
    ):
        RunFolder.create(path, "")
    assert (path / "cell.csv").read_text() == "a record"
    monkeypatch.setattr(run_folder, "holder", lambda _: 4711)
    with pytest.raises(FolderInUseError, match="first/ is in use by process 4711; choose another folder$"):
        RunFolder.create(path, "")


def test_a_file_is_no_folder_for_a_run(path: Path) -> None:
    path.parent.mkdir()
    path.write_text("x")
    with pytest.raises(FolderInUseError, match="is a file, must be a folder to make"):
        RunFolder.create(path, "")


def test_an_empty_folder_is_taken(path: Path) -> None:
    path.mkdir(parents=True)
    RunFolder.create(path, "").close()


def test_only_one_process_at_a_time_works_in_a_folder(path: Path) -> None:
    with RunFolder.create(path, ""), pytest.raises(FolderInUseError, match="is in use by process"):
        RunFolder.open(path)
    RunFolder.open(path).close()


def test_a_folder_without_a_configuration_cannot_be_taken_up(path: Path) -> None:
    path.mkdir(parents=True)
    with pytest.raises(ValueError, match=r"first/ is not the folder of a run: it has no config\.toml"):
        RunFolder.open(path)
    assert list(path.iterdir()) == []


def test_what_a_kill_left_is_swept_up_when_the_folder_is_opened(path: Path) -> None:
    RunFolder.create(path, "").close()
    (path / "shots").mkdir()
    (path / "shots" / ".0003.0a1b2c3d.tmp.wav").write_bytes(b"half")
    (path / "events.jsonl").write_bytes(b'{"time": "now", "event": "shot"}\n{"eve')
    (path / "qc.csv").write_bytes(b"shot,iae\n0,1.5\n1,0.")
    assert read_events(path) == [{"time": "now", "event": "shot"}]
    assert read_quality(path) == [{"shot": "0", "iae": "1.5"}]
    with RunFolder.open(path) as folder:
        folder.quality({"shot": 1, "iae": 0.75})
    assert list((path / "shots").iterdir()) == []
    assert (path / "events.jsonl").read_bytes() == b'{"time": "now", "event": "shot"}\n'
    assert (path / "qc.csv").read_text() == "shot,iae\n0,1.5\n1,0.75\n"


def test_a_folder_that_cannot_be_filled_is_taken_away(path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="absent"), RunFolder.filled(path, "") as folder:
        folder.take_in(path.parent / "absent.h5", "model.h5")
    assert not path.exists()
    assert not path.parent.exists()
    path.parent.mkdir()
    (path.parent / "there.h5").write_bytes(b"model")
    with RunFolder.filled(path, "") as folder:
        folder.take_in(path.parent / "there.h5", "model.h5")
    with pytest.raises(FolderInUseError, match="is in use by process"):
        RunFolder.open(path)
    folder.close()
    assert (path / "model.h5").read_bytes() == b"model"


def test_a_run_of_which_nothing_has_come_leaves_what_was_there_before(path: Path) -> None:
    def refuse(folder: Path, name: str = "") -> None:
        with RunFolder.create(folder, "[rig]\n") as run:
            run.take_in(source, "model.h5")
            if name:
                run.event(name, {})
            raise ValueError("no such plant")

    (path.parent / "empty").mkdir(parents=True)
    source = path.parent / "given.h5"
    source.write_text("a model")
    before = sorted(path.parent.rglob("*"))
    for folder in (path, path / "a" / "b", path.parent / "empty"):
        with pytest.raises(ValueError, match="no such plant"):
            refuse(folder)
        assert sorted(path.parent.rglob("*")) == before
    with pytest.raises(ValueError, match="no such plant"):
        refuse(path, "started")
    assert [event["event"] for event in read_events(path)] == ["started"]


def test_a_run_that_was_there_before_stays_whatever_comes_of_it(path: Path) -> None:
    RunFolder.create(path, "[rig]\n").close()
    with pytest.raises(ValueError, match="no such plant"), RunFolder.open(path):
        raise ValueError("no such plant")
    assert (path / "config.toml").is_file()


def test_a_recording_that_grew_when_its_run_was_killed_is_made_whole(path: Path) -> None:
    with RunFolder.create(path, ""):
        file = GrowingWav(path / "recording.wav", Channels(("a",), ("V",), 10_000.0, {}))
        file.append(np.ones((100, 1)))
        with pytest.raises(ValueError, match="is in use by process"):
            make_whole(path)
    make_whole(path)
    assert (recording.read(path / "recording.wav").data == np.ones((100, 1))).all()
    assert [entry.name for entry in path.glob("rec*")] == ["recording.wav"]


def test_an_event_carries_the_time_in_utc_its_kind_and_its_fields(path: Path) -> None:
    with RunFolder.create(path, "") as folder:
        folder.event("discarded", {"shot": np.int64(3), "reason": "xrun", "delay": float("nan")})
    (event,) = read_events(path)
    time = datetime.fromisoformat(event.pop("time"))
    assert abs((datetime.now(UTC) - time).total_seconds()) < 60
    assert event == {"event": "discarded", "shot": 3, "reason": "xrun", "delay": None}


def test_an_event_cannot_hide_its_own_time(path: Path) -> None:
    with RunFolder.create(path, "") as folder, pytest.raises(ValueError, match="a field is called time"):
        folder.event("shot", {"time": 3})


@pytest.mark.parametrize(
    ("line", "says"),
    [
        (b"nonsense", "not JSON"),
        (b"[" * 200_000, "nested more than 12 deep"),
        (b'{"event": "\xff"}', "byte 0xff in line 2 is not UTF-8"),
        (b'{"time": "now"}', "line 2 is no event"),
        (b"[]", "line 2: is a list, must be an object"),
    ],
    ids=range(5),
)
def test_a_line_that_is_no_event_is_named(line: bytes, says: str, path: Path) -> None:
    RunFolder.create(path, "").close()
    (path / "events.jsonl").write_bytes(b'{"time": "now", "event": "shot"}\n' + line + b"\n")
    with pytest.raises(ValueError, match=r"events\.jsonl: .*line 2") as fault:
        read_events(path)
    assert says in str(fault.value)


def test_quality_rows_stand_under_one_header_and_keep_every_bit(path: Path) -> None:
    with RunFolder.create(path, "") as folder:
        folder.quality({"shot": 0, "iae, m/s^2": 0.1 + 0.2})
        folder.quality({"shot": 1, "iae, m/s^2": np.float64(1e-30)})
    assert (path / "qc.csv").read_text().splitlines()[0] == 'shot,"iae, m/s^2"'
    assert [float(row["iae, m/s^2"]) for row in read_quality(path)] == [0.1 + 0.2, 1e-30]


def test_a_row_with_other_columns_is_refused(path: Path) -> None:
    with RunFolder.create(path, "") as folder:
        folder.quality({"shot": 0, "iae": 1.0})
        with pytest.raises(ValueError, match=r"qc\.csv: the columns are shot,iae, but the row has shot,thd"):
            folder.quality({"shot": 1, "thd": 1.0})
    assert len(read_quality(path)) == 1


def test_the_summary_is_json_and_replaced_whole(path: Path) -> None:
    with RunFolder.create(path, "") as folder:
        folder.summarise({"shots": 1, "iae_ratio": np.array([1.0, 2.0])})
        folder.summarise({"shots": 2, "objective_met_shot": None})
    assert json.loads((path / "summary.json").read_text()) == {"shots": 2, "objective_met_shot": None}


def test_a_library_writes_a_file_through_a_temporary_name(path: Path) -> None:
    with RunFolder.create(path, "") as folder:
        with folder.replacing("model.h5") as temporary:
            temporary.write_bytes(b"model")
            assert not (path / "model.h5").exists()
        folder.write("report.html", "page")
    assert (path / "model.h5").read_bytes() == b"model"
    assert (path / "report.html").read_text() == "page"


@pytest.mark.parametrize(("kind", "fewest_kills"), [("steps", 80), ("random", 50)])
def test_a_run_killed_at_any_moment_is_taken_up_and_ends_the_same(kind: str, fewest_kills: int, path: Path) -> None:
    command = [sys.executable, "-m", "tests.rigkit.killed_run", kind, str(path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=EVER, check=False)
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) >= fewest_kills


BUILDING = """
import os, signal, sys
from rigkit.run_folder import RunFolder
with RunFolder.built(sys.argv[1], "[rig]") as folder:
    folder.event("imported", {})
    os.kill(os.getpid(), signal.SIGKILL)
"""


def test_a_folder_that_is_built_is_there_whole_or_not_at_all(path: Path) -> None:
    with RunFolder.built(path, "[rig]\n") as folder:
        folder.event("imported", {"shot": 0})
        assert not path.exists()
    assert (path / "config.toml").read_text() == "[rig]\n"
    assert read_events(path)[0]["event"] == "imported"
    assert [each.name for each in path.parent.iterdir()] == ["first"]
    with pytest.raises(FolderInUseError, match="is in use: it holds"), RunFolder.built(path, ""):
        pass


def test_one_that_fails_leaves_nothing(path: Path) -> None:
    with pytest.raises(ValueError, match="a field is called time"), RunFolder.built(path, "") as folder:
        folder.event("imported", {"time": 0})
    assert not path.parent.exists()


def test_what_a_kill_has_left_goes_when_it_is_built_again(path: Path) -> None:
    done = subprocess.run([sys.executable, "-c", BUILDING, str(path)], check=False, timeout=EVER)
    assert done.returncode < 0
    assert not path.exists()
    assert len(list(path.parent.iterdir())) == 1
    path.mkdir()
    with RunFolder.built(path, "[rig]\n"):
        pass
    assert [each.name for each in path.parent.iterdir()] == ["first"]
