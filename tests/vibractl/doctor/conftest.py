"""Fixtures of the tests of the doctor."""

import pytest


@pytest.fixture
def brief(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the doctor listen to the silence for 3 s instead of 10, where neither noise nor clock is what is tested."""
    monkeypatch.setattr("vibractl.doctor.examination.SILENCE", 3.0)
