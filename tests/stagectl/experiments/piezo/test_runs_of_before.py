"""Folders as a version wrote them whose runs had no parts: they are replayed and reported as those of now."""

import json
from pathlib import Path

import pytest

from rigkit import config as rig_file
from rigkit.config import ConfigError
from rigkit.experiment.kept import EARLY
from rigkit.experiment.runner import STOPPED
from rigkit.origin import RUN
from rigkit.run_folder import CONFIG, EVENTS
from stagectl.commands.kinds_of_run import replayed, reported
from stagectl.config import StageConfig
from tests.stagectl.experiments.piezo.simulated_models import write_models
from tests.stagectl.experiments.piezo.stage_runs import carried_out, recording_of
from tests.stagectl.experiments.piezo.test_session import QUICK


def tell_as_before(path: Path) -> None:
    """Write the events of a run anew: they name its recording, and know no parts."""
    samples = len(recording_of(path).data)
    begun = {"time": "2026-01-01T00:00:00.000+00:00", "event": "started", "software": "vibrostage 0.1.0"}
    ended = {**begun, "event": "recorded", "recording": "recording", "samples": samples}
    (path / EVENTS).write_text("".join(f"{json.dumps(each)}\n" for each in (begun, ended)))


@pytest.mark.sample(1)
@pytest.mark.parametrize(("seconds", "looks"), [(5.0, 90), (0.4, 10_000)], ids=["stopped", "whole"])
def test_a_run_of_before_comes_out_bit_for_bit_and_is_reported(seconds: float, looks: int, tmp_path: Path) -> None:
    config = rig_file.load(None, StageConfig, [*QUICK, f"session.seconds={seconds}"])
    asked, path = iter(range(20_000)), tmp_path / "run"
    reasons, figures = carried_out(path, config, write_models(tmp_path), lambda: next(asked) > looks)
    assert reasons == ({} if seconds < 1 else {"": STOPPED})
    tell_as_before(path)
    again = list(replayed(path))
    assert len(again) == 9
    assert all(each.identical for each in again)
    figures.pop(EARLY, None)  # which was not told
    assert reported(path, None) == figures
    assert (path / "report.html").is_file()


def test_a_folder_of_another_program_is_named(tmp_path: Path) -> None:
    path = tmp_path / "run"
    carried_out(path, rig_file.load(None, StageConfig, [*QUICK, "session.seconds=0.4"]), write_models(tmp_path))
    origin = json.loads((path / RUN).read_text())
    (path / RUN).write_text(json.dumps(origin | {"kind": "vibrator run"}))
    with pytest.raises(ValueError, match="has kind 'vibrator run', must be one of stage run, "):
        reported(path, None)


def test_a_run_of_before_may_have_keys_that_are_gone_and_a_rig_file_may_not(tmp_path: Path) -> None:
    path = tmp_path / "run"
    config = rig_file.load(None, StageConfig, [*QUICK, "session.seconds=0.4"])
    _, figures = carried_out(path, config, write_models(tmp_path))
    text = (path / CONFIG).read_text()
    (path / CONFIG).write_text(text.replace("[laser]\n", '[laser]\nport = "serial:Serial"\noutput = 1\n'))
    assert reported(path, None) == figures
    with pytest.raises(ConfigError, match=r"laser\.(port|output)"):
        rig_file.load(path / CONFIG, StageConfig)
