"""A run that begins faint, to its end."""

import json
from pathlib import Path

import pytest

from rigkit.run_folder import read_events, read_quality
from tests.vibractl.linear_rig import linear_model
from tests.vibractl.test_session import FAINT, run


@pytest.mark.slow
def test_a_run_that_begins_faint_comes_to_its_full_level_with_no_line_over_the_limit(tmp_path: Path) -> None:
    run(tmp_path / "whole", linear_model(tmp_path), 18, *FAINT)
    rows = read_quality(tmp_path / "whole")
    assert [row["verdict"] for row in rows[:6]] == ["rise"] * 6
    figures = json.loads((tmp_path / "whole" / "summary.json").read_text())
    assert figures["full_level_shot"] == figures["objective_met_shot"]
    assert 6 <= figures["full_level_shot"] <= 17
    assert figures["loudest_line_db"] <= 0
    assert figures["shots_proven_over"] == 0
    assert figures["loudest_band_db"] < figures["loudest_line_db"]
    risen = [event for event in read_events(tmp_path / "whole") if event["event"] == "level"]
    assert [event["to"] for event in risen] == sorted(event["to"] for event in risen)
    assert risen[-1]["to"] == 1.0
