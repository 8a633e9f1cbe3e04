"""A vibrator under the daemon's authority, and away with it after the test."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.vibractl.daemon.bench import Lab, lab_in


@pytest.fixture
def lab(tmp_path: Path) -> Iterator[Lab]:
    """Return a vibrator that has been calibrated."""
    made = lab_in(tmp_path)
    yield made
    made.control.close(60)
    made.control.journal.close()
