"""Fixtures of tests on recordings of other software."""

from pathlib import Path

import pytest

from tests.vibractl.foreign.lab_of_recordings import LabOfRecordings


@pytest.fixture
def recordings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> LabOfRecordings:
    """Return a folder with recordings of two shots."""
    return LabOfRecordings(tmp_path, monkeypatch, capsys)
