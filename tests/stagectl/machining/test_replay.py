"""What was recorded of the cell makes all of its outputs again, bit for bit; and a touched recording does not."""

from pathlib import Path

import pytest

from ctlblocks import recording
from ctlblocks.recording import Recording
from stagectl.machining import session
from stagectl.machining.replay import replay_cell
from stagectl.machining.report import cell_report
from stagectl.machining.run import Conduct
from tests.stagectl.machining.short_cell import STAGE, short


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("cell") / "run"
    made = short("C"), short("B", "plants.tracker_options.blind=1.2")
    with session.create(path, session.Files(made[0].cell, STAGE)) as run:
        for each in made:
            session.run(run, each, Conduct(run.event))
    return path


def test_every_output_comes_out_again_bit_for_bit_also_of_a_run_that_was_held(folder: Path) -> None:
    done = list(replay_cell(folder))
    assert {each.recording for each in done} == {"C-cell", "C-stage", "B-cell"}
    assert len(done) == 2 * (3 + 3 + 3 + 6 + 6 + 1) + 9
    assert [each for each in done if not each.identical] == []


def test_a_recording_that_was_touched_says_so(folder: Path, tmp_path: Path) -> None:
    for file in folder.iterdir():
        if file.is_file() and not file.name.startswith("C-") and file.name != "events.jsonl":
            (tmp_path / file.name).write_bytes(file.read_bytes())
    events = [line for line in (folder / "events.jsonl").read_text().splitlines() if '"setup": "B"' in line]
    (tmp_path / "events.jsonl").write_text("\n".join(events) + "\n")
    record = recording.read(tmp_path / "B-tracker.wav")
    data = record.data.copy()
    data[2_300:, record.names.index("workpiece_2")] += 1e-6
    recording.write(tmp_path / "B-tracker.wav", Recording(record.names, record.units, record.rate, data))
    differing = {each.channel for each in replay_cell(tmp_path) if not each.identical}
    assert {"deviation_y", "correction_1"} <= differing
    assert "deviation_x" not in differing


def test_the_report_has_the_table_the_contours_and_the_travel(folder: Path, tmp_path: Path) -> None:
    rows = cell_report(folder, tmp_path)
    assert [row["setup"] for row in rows] == ["B", "C"]
    page = (folder / "report.html").read_text()
    for words in ("σ, circle", "at an end", "the tracker is blind for"):
        assert words in page
    drawn = sorted(file.name for file in tmp_path.iterdir())
    assert drawn == ["contour-1.png", "contour-2.png", "surface.png", "travel.png"]
    assert (folder / "summary.json").exists()


def test_another_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="is not the folder of a run of the cell"):
        list(replay_cell(tmp_path))
