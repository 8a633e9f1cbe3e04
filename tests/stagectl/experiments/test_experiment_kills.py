"""Every experiment killed at a few random moments; `benchmarks/experiment_kills.py` does so at many."""

from pathlib import Path

import pytest

from stagectl.experiments.registry import EXPERIMENTS
from tests.stagectl.experiments.experiment_kills import COMMANDS, kills


@pytest.mark.slow
@pytest.mark.parametrize("kind", COMMANDS)
def test_whatever_was_recorded_before_a_kill_is_there_and_goes_on(kind: str, tmp_path: Path) -> None:
    found = list(kills(kind, tmp_path, 4, 7))
    assert len(found) == 4


def test_no_experiment_is_left_out() -> None:
    assert list(COMMANDS) == [each.name for each in EXPERIMENTS], "COMMANDS of experiment_kills.py: in this order"
