"""A run of mid-ranging in its folder: reported and replayed from there alone, killed at any moment, or of long ago."""

import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from ctlblocks.recording import Recording, read, write
from rigkit import config as rig_file
from rigkit.experiment.again import replayed
from rigkit.experiment.kept import reported
from rigkit.run_folder import read_events
from stagectl.application import PROGRAM
from stagectl.experiments.midranging.read_back import MIDRANGING
from stagectl.experiments.midranging.schedule import without_lead
from stagectl.robot.config import CellConfig
from tests.until import until


def _run(*arguments: str) -> None:
    PROGRAM.only(arguments[0])(list(arguments), standalone_mode=False)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("runs") / "run"
    _run("midrange", "--scenario", "thesis-2", "--out", str(path), "--set", "midranging.session.lead=6")
    return path


def test_it_says_what_it_is_and_what_was_asked_for(run: Path) -> None:
    told = json.loads((run / "run.json").read_text())
    assert told["kind"] == "mid-ranging run"
    assert told["designed"]["controller"] == "aimc"
    assert told["designed"]["axes"][""]["options"] == {"gains": [[8.0, 1.5], [16.0, 0.6]]}


def test_every_output_is_made_again_bit_for_bit(run: Path) -> None:
    again = list(replayed(run, MIDRANGING))
    assert {"fast_reference", "slow_reference", "share", "fast_model_1"} <= {each.channel for each in again}
    assert all(each.identical for each in again)


def test_a_replay_tells_what_was_altered(run: Path, tmp_path: Path) -> None:
    copy = _copied(run, tmp_path)
    kept = read(copy / "recording.wav")
    data = kept.data.copy()
    data[2000, kept.names.index("relative")] += 1e-9
    write(copy / "recording.wav", Recording(kept.names, kept.units, kept.rate, data, kept.provenance))
    with pytest.raises(SystemExit) as ended:
        PROGRAM.only("replay")(["replay", str(copy)])
    assert ended.value.code == 1


def test_a_replay_tells_what_other_settings_would_have_made(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = tmp_path / "found.json"
    _run("replay", str(run), "--set", "midranging.learning.gate=6", "--json", str(found))
    assert json.loads(found.read_text())["differing"] > 0
    assert "they do not react to what is changed" in capsys.readouterr().err
    with pytest.raises(ValueError, match="gate is -1, must be >= 0"):
        _run("replay", str(run), "--set", "midranging.learning.gate=-1")


def test_the_report_is_made_again_with_the_same_figures(run: Path, tmp_path: Path) -> None:
    copy = _copied(run, tmp_path)
    before = json.loads((copy / "summary.json").read_text())
    (copy / "report.html").unlink()
    _run("report", str(copy), "--json", str(tmp_path / "again.json"), "--png", str(tmp_path / "png"))
    assert json.loads((tmp_path / "again.json").read_text()) == before
    assert (copy / "report.html").is_file()
    assert (tmp_path / "png/models.png").is_file()


def test_a_run_of_version_0_1_0_is_reported_and_says_why_it_is_not_replayed(run: Path, tmp_path: Path) -> None:
    """Then a run was a CSV file an axis, from the reference's first sample on, and said in it what it was."""
    copy = _copied(run, tmp_path)
    cell = rig_file.load(copy / "config.toml", CellConfig)
    kept = without_lead(read(copy / "recording.wav"), cell.midranging)
    about = {
        "controller": "aimc",
        "scenario": "thesis-2",
        "time": "2026-11-01T00:00:00Z",
        "software": "vibrostage 0.1.0",
    }
    write(copy / "recording.csv", Recording(kept.names, kept.units, kept.rate, kept.data, about))
    (copy / "recording.wav").unlink()
    told = json.loads((copy / "run.json").read_text())
    del told["designed"]
    (copy / "run.json").write_text(json.dumps(told))
    found = reported(copy, MIDRANGING)
    before = json.loads((copy / "summary.json").read_text())
    assert json.loads(json.dumps(found)) == before
    with pytest.raises(ValueError, match="estimation phase, .* is not in it"):
        list(replayed(copy, MIDRANGING))


def test_a_run_of_adaptive_control_by_an_earlier_law_is_reported_and_not_replayed(run: Path, tmp_path: Path) -> None:
    copy = _copied(run, tmp_path)
    told = json.loads((copy / "run.json").read_text())
    del told["designed"]["law"]
    (copy / "run.json").write_text(json.dumps(told))
    assert json.loads(json.dumps(reported(copy, MIDRANGING))) == json.loads((copy / "summary.json").read_text())
    with pytest.raises(ValueError, match="as it was before models had dead times"):
        list(replayed(copy, MIDRANGING))
    told["designed"]["controller"] = "mvpc"
    (copy / "run.json").write_text(json.dumps(told))
    assert list(replayed(copy, MIDRANGING))  # another controller, whose law is what it was: made again


def test_where_valve_position_control_takes_over_events_figures_and_report_say_so(tmp_path: Path) -> None:
    """Neither model explains all of a noise that nobody has told the controller of."""
    path = tmp_path / "run"
    told = ("learning.noise=1e-9", "estimating.accuracy=1e-12", "estimating.acceptable=1e-12",
            "simulator.options.noise=5e-5", "session.lead=8")  # fmt: skip
    _run("midrange", "--scenario", "thesis-2", "--out", str(path), *(f"--set=midranging.{each}" for each in told))
    (event,) = [each for each in read_events(path) if each["event"] == "taken over"]
    assert "accurate enough" in event["reason"]
    found = json.loads((path / "summary.json").read_text())
    assert found["taken_over_at"] == 0.0
    assert found["control_over_limit"] < 1.2
    assert "Valve position control took over" in (path / "report.html").read_text()
    assert "Shaded" in (path / "report.html").read_text()
    assert all(each.identical for each in replayed(path, MIDRANGING))


@pytest.mark.parametrize("share", [0.4, pytest.param(0.8, marks=pytest.mark.slow)])
def test_what_was_recorded_before_a_kill_is_reported_and_replayed(tmp_path: Path, share: float) -> None:
    path = tmp_path / "run"
    command = [sys.executable, "-m", "stagectl", "midrange", "--scenario", "thesis-2", "--out", str(path), "--set",
               "midranging.session.lead=6"]  # fmt: skip
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    growing, frame = path / "recording.part.wav", 8 * 15
    try:
        until(lambda: growing.exists() and growing.stat().st_size > share * 30 * 250 * frame)
    finally:
        process.send_signal(signal.SIGKILL)
        process.communicate()
    found = reported(path, MIDRANGING)
    assert 0.5 * share * 30 - 6 < found["seconds"] < 24
    assert found["ended_early"] == {"": "killed"}
    assert "Ended early" in (path / "report.html").read_text()
    again = list(replayed(path, MIDRANGING))
    assert again
    assert all(each.identical for each in again)
    assert [each["event"] for each in read_events(path)] == ["started"]


def _copied(run: Path, place: Path) -> Path:
    copy = place / "copy"
    copy.mkdir()
    for file in run.iterdir():
        if file.is_file():
            (copy / file.name).write_bytes(file.read_bytes())
    return copy


def test_a_replay_straight_after_a_kill_needs_no_report_first(run: Path, tmp_path: Path) -> None:
    copy = _copied(run, tmp_path)
    (copy / "recording.wav").rename(copy / "recording.part.wav")
    events = (copy / "events.jsonl").read_text().splitlines(keepends=True)
    (copy / "events.jsonl").write_text("".join(line for line in events if '"ended"' not in line))
    assert all(each.identical for each in replayed(copy, MIDRANGING))
    assert (copy / "recording.wav").is_file()
