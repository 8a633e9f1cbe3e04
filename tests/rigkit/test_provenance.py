import re
from datetime import UTC, datetime

import numpy as np

from rigkit.provenance import now, software


def test_the_software_names_this_program_its_commit_and_the_libraries_with_their_versions() -> None:
    text = software()
    assert re.match(r"vibrostage \d+\.\d+\.\d+(\.dev\d+)?( \([0-9a-f]{12}\+?\))?, ", text), text
    assert f"numpy {np.__version__}" in text
    assert "Python 3." in text


def test_the_time_is_universal() -> None:
    assert abs((datetime.now(UTC) - datetime.fromisoformat(now())).total_seconds()) < 60
