"""The page shows every verdict and the figures behind it."""

from pathlib import Path

import numpy as np
import pytest

from tests.vibractl.doctor.doctor_rig import SIDES, spoil, vibrating, wired
from vibractl.doctor.examination import CHECKS, examine
from vibractl.doctor.report import write_report


def test_every_verdict_is_on_the_page_with_its_figures(tmp_path: Path) -> None:
    found = examine(vibrating())
    write_report(tmp_path / "doctor.html", found)
    page = (tmp_path / "doctor.html").read_text(encoding="utf-8")
    assert all(check.capitalize() in page for check in CHECKS)
    assert "(warning)" in page
    assert "Hum: response" in page
    assert [title in page for title in ("Noise and hum", "<h2>Clock", "<h2>Channels")] == [True] * 3
    assert page.count("data:image/") == 3
    assert [file.name for file in tmp_path.iterdir()] == ["doctor.html"]


@pytest.mark.usefixtures("brief")
def test_what_could_not_be_measured_is_left_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    spoil(monkeypatch, lambda _, recorded: recorded[:, 2].fill(0.0))
    write_report(tmp_path / "cable.html", examine(wired(tmp_path, SIDES * [[1, 0], [1, 0]])))
    page = (tmp_path / "cable.html").read_text(encoding="utf-8")
    assert "<h2>Clock" not in page
    assert page.count("data:image/") == 2
    write_report(tmp_path / "card.html", examine(wired(tmp_path, np.eye(2), stream="firmware_sim.audio:Missing")))
    assert "data:image/" not in (tmp_path / "card.html").read_text(encoding="utf-8")
