"""The vibrator's procedures under the daemon."""

from pathlib import Path

import numpy as np
import pytest

from rigkit import config as rig_file
from rigkit.run_folder import read_events, read_quality
from rigkit.service.state import State
from tests.contract import monitoring
from tests.contract.monitoring import missing_of
from tests.rigkit.service.described import views_are_described
from tests.until import until
from tests.vibractl.daemon.bench import Lab
from vibractl.config import RigConfig
from vibractl.daemon import running
from vibractl.daemon.rig import Vibrator
from vibractl.replay import replay
from vibractl.run_setup import setup_of


@pytest.fixture(autouse=True)
def reports(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """Draw no reports, which takes seconds, but in the test that looks at one."""
    drawn: list[Path] = []
    if "reported" not in request.node.name:
        monkeypatch.setattr(running, "run_report", drawn.append)
    return drawn


def test_a_run_is_learned_shown_and_reported_and_the_rig_stays_armed(lab: Lab) -> None:
    lab.begin(run="one", shots=3)
    lab.ended()
    assert lab.state is State.ARMED, lab.control.machine.last.why
    assert len(read_quality(lab.data / "runs" / "one")) == 3
    assert (lab.data / "runs" / "one" / "report.html").is_file()
    assert [event["shot"] for event in lab.events("shot")] == [0, 1, 2]
    panels = lab.control.board
    assert views_are_described(lab.control)["panels"] == panels.revisions()
    assert set(panels.revisions()) == {"live", "convergence", "error", "certificate", "lines"} | {
        f"{which}_{side}" for which in ("spectrum", "first_spectrogram", "last_spectrogram") for side in (1, 2)
    }
    worst = [trace for trace in panels.panel("convergence")["traces"] if trace["role"] == "measured"]
    table = read_quality(lab.data / "runs" / "one")
    for side, trace in enumerate(worst, start=1):
        assert np.allclose(trace["y"], [float(row[f"worst_line_db_{side}"]) for row in table], atol=1e-4)
    largest = []
    for side in (1, 2):
        first, last, limit = panels.panel(f"spectrum_{side}")["traces"]
        for trace, row in ((first, table[0]), (last, table[-1])):
            over = trace["y"].max() - limit["y"][0]
            assert over == pytest.approx(float(row[f"worst_line_db_{side}"]), abs=1e-3)
        largest.append(over)
        assert panels.panel(f"first_spectrogram_{side}")["title"] == f"Response {side}, shot 0"
        assert panels.panel(f"last_spectrogram_{side}")["title"] == f"Response {side}, shot 2"
    rows = panels.panel("lines")["rows"]
    assert rows[0][2] == pytest.approx(max(largest), abs=0.06)
    assert [row[2] for row in rows] == sorted((row[2] for row in rows), reverse=True)


def test_gauges_tell_levels_against_the_limits_while_the_line_is_open(lab: Lab) -> None:
    assert [gauge.name for gauge in lab.rig.gauges()] == ["disk_free"]
    lab.begin(run="one", shots=1000)
    lab.until_shot(2)
    found = {gauge.name: gauge for gauge in lab.rig.gauges()}
    assert len(views_are_described(lab.control)["gauges"]) == len(found)
    assert missing_of(lab.control, monitoring.RIG, monitoring.VIBRATOR) == set()
    lab.control.stop("Ada", "")
    lab.ended()
    assert found["drive_peak_1"].high == RigConfig().limits.peak
    assert found["xruns"].value == 0
    assert found["worst_line"].value is not None
    assert abs(found["alignment"].value or 1.0) < 0.25


def test_a_stop_ends_a_run_that_can_be_resumed_bit_for_bit(lab: Lab) -> None:
    lab.begin(run="one", shots=1000)
    lab.until_shot(2)
    lab.control.stop("Ada", "smoke")
    assert lab.state is State.DISARMED
    lab.ended()
    recorded = len(read_quality(lab.data / "runs" / "one"))
    assert 2 <= recorded < 1000
    lab.begin(run="one", resume=True, shots=recorded + 1)
    lab.ended()
    assert lab.state is State.ARMED, lab.control.machine.last.why
    path = lab.data / "runs" / "one"
    assert len(read_quality(path)) == recorded + 1
    assert all(each.identical for each in replay(path, setup_of(path)))


def test_a_run_that_is_held_is_silent_and_goes_on_with_the_next_shot(lab: Lab) -> None:
    lab.begin(run="one", shots=1000)
    lab.until_shot(1)
    lab.control.hold(lab.key, "lunch")
    until(lambda: lab.events("held"))
    assert lab.state is State.HOLD
    drives = {gauge.name: gauge.value for gauge in lab.rig.gauges() if gauge.name.startswith("drive")}
    assert drives == {"drive_peak_1": 0.0, "drive_peak_2": 0.0}
    shots = lab.events("held")[0]["shot"]
    lab.control.resume(lab.key, "back")
    lab.until_shot(shots + 1)
    lab.control.abort(lab.key, "enough")
    lab.ended()
    assert lab.state is State.ARMED, lab.control.machine.last.why
    path = lab.data / "runs" / "one"
    assert [int(row["shot"]) for row in read_quality(path)] == list(range(len(read_quality(path))))
    assert len([event for event in read_events(path) if event["event"] == "started"]) == 2


def test_a_run_without_its_model_does_not_begin_leaves_no_folder_and_the_rig_stays_armed(lab: Lab) -> None:
    lab.begin(run="one", model="another.h5")
    lab.ended()
    assert lab.state is State.ARMED
    assert lab.control.machine.last.why.startswith("Learning run has not begun: ")
    assert "another.h5" in lab.control.machine.last.why
    assert not (lab.data / "runs" / "one").exists()


def test_a_reference_from_outside_the_data_folder_is_refused(lab: Lab) -> None:
    lab.begin(reference="../secret.wav")
    lab.ended()
    assert lab.state is State.ARMED
    assert "leads out of the data folder" in lab.control.machine.last.why


def test_a_reload_that_changes_nothing_does_nothing(lab: Lab) -> None:
    assert lab.control.reload(lab.key) == {"reach": "nothing", "keys": [], "done": ""}


def test_a_bad_rig_file_is_refused_by_its_key_and_the_old_one_stays(lab: Lab) -> None:
    before = lab.rig.config
    lab.file.write_text("[limits]\npeak = -1.0\n")
    with pytest.raises(ValueError, match=r"limits.peak is -1.0, must be > 0"):
        lab.control.reload(lab.key)
    assert lab.rig.config is before


@pytest.mark.slow
def test_more_shots_and_tighter_limits_reach_a_run_that_goes_on_and_what_it_learns_with_does_not(lab: Lab) -> None:
    lab.begin(run="one", shots=1000)
    lab.until_shot(1)
    assert not lab.rig.edits()
    lab.edit("session.shots=6", "limits.peak=8.0", "learning.gains=[0.25]")
    assert "limits.peak 9.0 -> 8.0" in lab.rig.edits()
    told = lab.control.reload(lab.key)
    assert not lab.rig.edits()
    assert told["reach"] == "devices"
    assert told["keys"] == ["learning.gains", "limits.peak", "session.shots"]
    lab.ended()
    path = lab.data / "runs" / "one"
    assert len(read_quality(path)) >= 6
    kept = setup_of(path).config
    assert (kept.limits.peak, kept.learning.gains) == (8.0, (0.5,))
    assert [event["event"] for event in read_events(path)].count("reloaded") == 1
    assert all(each.identical for each in replay(path, setup_of(path)))
    lab.begin(run="two", shots=1)
    lab.ended()
    assert setup_of(lab.data / "runs" / "two").config.learning.gains == (0.25,)


@pytest.mark.slow
def test_two_edits_that_wait_for_one_shot_are_both_taken(lab: Lab) -> None:
    lab.begin(run="one", shots=1000)
    lab.until_shot(1)
    lab.control.hold(lab.key, "")
    until(lambda: lab.events("held"))
    for edits in (("limits.peak=8.0",), ("limits.peak=8.0", "audio.attempts=7", "session.shots=6")):
        lab.edit(*edits)
        lab.control.reload(lab.key)
    lab.control.resume(lab.key, "")
    lab.ended()
    kept = setup_of(lab.data / "runs" / "one").config
    assert (kept.limits.peak, kept.audio.attempts) == (8.0, 7)


def test_a_limit_that_the_drive_breaks_after_a_reload_is_a_fault(lab: Lab) -> None:
    lab.begin(run="one", shots=1000)
    lab.until_shot(1)
    lab.edit("limits.peak=0.1")
    lab.control.reload(lab.key)
    lab.ended()
    assert lab.state is State.FAULT
    assert "limits.peak is 0.1 V" in lab.control.machine.last.why


def test_arming_does_not_import_what_opens_the_audio_interface(lab: Lab, monkeypatch: pytest.MonkeyPatch) -> None:
    (lab.data / "explodes.py").write_text("raise RuntimeError('imported')\n")
    monkeypatch.syspath_prepend(str(lab.data))
    lab.edit("audio.stream=explodes:Stream")
    started_anew(lab).arm()
    lab.edit("audio.stream=nowhere:Stream")
    with pytest.raises(ValueError, match="nowhere:Stream: there is no module nowhere on the Python path"):
        started_anew(lab).arm()


def started_anew(lab: Lab) -> Vibrator:
    """Return the rig of a daemon that is started with the rig file as it is now."""
    return Vibrator(lambda: rig_file.load(lab.file, RigConfig))


def test_over_the_network_nothing_is_imported_that_the_daemon_was_not_started_with(lab: Lab) -> None:
    lab.begin(run="one", shots=1)
    lab.ended()
    config = lab.data / "runs" / "one" / "config.toml"
    config.write_text(config.read_text().replace("firmware_sim.audio:Stream", "tests.rigkit.never_imported:Stream"))
    lab.begin(run="one", resume=True, shots=2)
    lab.ended()
    assert lab.state is State.ARMED
    why = lab.control.machine.last.why
    assert "audio.stream is 'tests.rigkit.never_imported:Stream', must be code that the daemon" in why
    lab.edit("simulator.plant=subprocess:Popen")
    with pytest.raises(ValueError, match="simulator.plant is 'subprocess:Popen', must be code that"):
        lab.control.reload(lab.key)
    assert lab.rig.config.simulator.plant != "subprocess:Popen"
