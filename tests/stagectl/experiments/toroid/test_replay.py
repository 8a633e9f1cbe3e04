"""What was recorded of the cell makes all of its outputs again, bit for bit; and a touched recording does not."""

import json
from pathlib import Path

import pytest

from ctlblocks import recording
from ctlblocks.recording import Recording
from rigkit.experiment.again import replayed
from rigkit.experiment.kept import create, reported, run
from rigkit.experiment.runner import STOPPED, Conduct
from rigkit.run_folder import read_events
from stagectl.experiments.toroid.experiment import Toroid
from stagectl.experiments.toroid.read_back import TOROID, Files
from tests.stagectl.experiments.toroid.short_cell import STAGE, short


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("cell") / "run"
    plans = [short("B", "plants.tracker_options.blind=1.2"), short("C")]
    made = Toroid(plans)
    with create(path, TOROID, plans[0].cell, made, Files(STAGE).take_into) as kept:
        reasons, _ = run(kept, TOROID, made, Conduct())
    assert list(reasons) == ["B"]
    return path


def test_every_output_comes_out_again_bit_for_bit_also_of_a_run_that_was_held(folder: Path) -> None:
    done = list(replayed(folder, TOROID))
    assert {each.recording for each in done} == {"C-cell", "C-stage", "B-cell"}
    assert len(done) == 2 * (3 + 3 + 3 + 6 + 6 + 1) + 9
    assert [each for each in done if not each.identical] == []


def test_a_replay_designs_nothing(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The stage's loops are those that were used, whatever another SciPy would make of the models."""

    def fail(*_: object, **__: object) -> None:
        raise AssertionError("a design is looked for")

    for name in ("design", "loops_of"):
        monkeypatch.setattr(f"stagectl.experiments.toroid.plan.{name}", fail)
    monkeypatch.setattr("stagectl.experiments.toroid.read_back.loops_of", fail)
    assert all(each.identical for each in replayed(folder, TOROID))


def test_a_setup_that_was_stopped_by_its_user_is_replayed_into_its_hold(tmp_path: Path) -> None:
    plan = short("B")
    made, asked = Toroid([plan]), 0

    def stopped() -> bool:
        nonlocal asked
        asked += 1
        return asked > 30

    with create(tmp_path / "run", TOROID, plan.cell, made, Files(STAGE).take_into) as kept:
        reasons, found = run(kept, TOROID, made, Conduct(stopped))
    assert reasons == {"B": STOPPED}
    assert found["setups"][0]["fault"] == STOPPED
    assert read_events(tmp_path / "run")[-1]["held_at"] < found["setups"][0]["seconds"] * 10_000
    assert all(each.identical for each in replayed(tmp_path / "run", TOROID))


def test_a_recording_that_was_touched_says_so(folder: Path, tmp_path: Path) -> None:
    copied(folder, tmp_path, "B")
    record = recording.read(tmp_path / "B-tracker.wav")
    data = record.data.copy()
    data[2_300:, record.names.index("workpiece_2")] += 1e-6
    recording.write(tmp_path / "B-tracker.wav", Recording(record.names, record.units, record.rate, data))
    differing = {each.channel for each in replayed(tmp_path, TOROID) if not each.identical}
    assert {"deviation_y", "correction_1"} <= differing
    assert "deviation_x" not in differing


def test_a_folder_of_version_0_1_0_is_reported_and_replayed(folder: Path, tmp_path: Path) -> None:
    """Then cell and surface were CSV files, events had a setup, and the loops were designed again."""
    copied(folder, tmp_path, "")
    for file in [*tmp_path.glob("?-cell.wav"), *tmp_path.glob("?-surface.wav")]:
        recording.write(file.with_suffix(".csv"), recording.read(file))
        file.unlink()
    lines = [json.loads(line) for line in (tmp_path / "events.jsonl").read_text().splitlines()]
    fresh = ("ticks", "held_at")
    older = [{"setup" if key == "part" else key: line[key] for key in line if key not in fresh} for line in lines]
    (tmp_path / "events.jsonl").write_text("".join(f"{json.dumps(line)}\n" for line in older))
    told = json.loads((tmp_path / "run.json").read_text())
    del told["designed"]
    (tmp_path / "run.json").write_text(json.dumps(told))
    rows = reported(tmp_path, TOROID)["setups"]
    assert json.loads(json.dumps(rows)) == json.loads((folder / "summary.json").read_text())["setups"]
    assert all(each.identical for each in replayed(tmp_path, TOROID))


def copied(folder: Path, place: Path, setup: str) -> None:
    """Copy a run, or one setup of it."""
    for file in folder.iterdir():
        if file.is_file() and (not file.name.startswith(("B-", "C-")) or file.name.startswith(setup)):
            (place / file.name).write_bytes(file.read_bytes())
    events = (folder / "events.jsonl").read_text().splitlines()
    kept = [line for line in events if not setup or f'"part": "{setup}"' in line]
    (place / "events.jsonl").write_text("".join(f"{line}\n" for line in kept))


def test_the_report_has_the_table_the_contours_and_the_travel(folder: Path, tmp_path: Path) -> None:
    rows = reported(folder, TOROID, tmp_path)["setups"]
    assert [row["setup"] for row in rows] == ["B", "C"]
    page = (folder / "report.html").read_text()
    for words in ("σ, circle", "at an end", "the tracker is blind for"):
        assert words in page
    drawn = sorted(file.name for file in tmp_path.iterdir())
    assert drawn == ["contour-1.png", "contour-2.png", "surface.png", "travel.png"]
    assert (folder / "summary.json").exists()


def test_another_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="is not the folder of a run of the cell"):
        list(replayed(tmp_path, TOROID))


def test_a_run_of_before_orientations_were_kept_is_replayed_without(tmp_path: Path) -> None:
    plan = short("B", "feedback.orientation=0")
    made = Toroid([plan])
    with create(tmp_path / "run", TOROID, plan.cell, made, Files(STAGE).take_into) as kept:
        run(kept, TOROID, made, Conduct())
    config = tmp_path / "run" / "config.toml"
    lines = config.read_text(encoding="utf-8").splitlines(keepends=True)
    config.write_text("".join(line for line in lines if not line.startswith("orientation ")))
    assert all(each.identical for each in replayed(tmp_path / "run", TOROID))
    told = replayed(tmp_path / "run", TOROID, ["feedback.orientation=1"])
    assert not all(each.identical for each in told)
