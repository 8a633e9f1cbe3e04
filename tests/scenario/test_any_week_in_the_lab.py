"""Any order of what is done in a lab leaves no model and no run that tells a false origin, and loses no recording."""

from pathlib import Path

import pytest

from tests.scenario.any_week import Week

LONG = 12
"""Steps of a week."""


@pytest.fixture(autouse=True)
def no_reports(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave out the reports, which are most of the time."""
    monkeypatch.setattr("vibractl.run_command.run_report", lambda *_: {})


def lived(folder: Path, seed: int, daemon_after: int | None = None) -> Week:
    """Live through a week, with a daemon after so many steps."""
    week = Week.begun(folder / f"lab-{seed}", seed)
    for step in range(LONG):
        try:
            week.do(week.daemon) if step == daemon_after else week.step()
        except AssertionError as fault:
            raise AssertionError(f"week {seed}: {fault}\n" + "\n".join(week.steps)) from None
    return week


@pytest.mark.slow
def test_a_week_of_any_steps(tmp_path: Path) -> None:
    lived(tmp_path, 2)


@pytest.mark.slow
@pytest.mark.deadline(0.3)
@pytest.mark.parametrize("seed", range(1000, 1300, 10))
def test_ten_weeks_of_any_steps(seed: int, tmp_path: Path) -> None:
    weeks = [lived(tmp_path, each, each % LONG) for each in range(seed, seed + 10)]
    assert sum(len(week.recorded) for week in weeks) > 50
    stops = [seconds for week in weeks for seconds in week.stops]
    assert stops
    assert max(stops) < 0.5
