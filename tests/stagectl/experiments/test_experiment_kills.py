"""Every experiment killed at a few random moments; `benchmarks/experiment_kills.py` does so at many."""

from pathlib import Path

import pytest

from tests.stagectl.experiments.experiment_kills import COMMANDS, kills


@pytest.mark.slow
@pytest.mark.parametrize("kind", COMMANDS)
def test_whatever_was_recorded_before_a_kill_is_there_and_goes_on(kind: str, tmp_path: Path) -> None:
    found = list(kills(kind, tmp_path, 4, 7))
    assert len(found) == 4
