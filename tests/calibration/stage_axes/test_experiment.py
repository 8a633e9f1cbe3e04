"""What is recorded of an axis: how loud, and what happens where the plate leaves its travel."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest

from calibration.experiment import RawFolder, refuse_to_emit
from calibration.stage_axes.bench import ExcitationError
from calibration.stage_axes.experiment import Experiment, record
from rigkit import config as rig_file
from stagectl.config import StageConfig
from stagectl.stage.piezo_pid import Pid

QUICK = ("stage.rate=2000", "characterisation.band=[2, 50]", "characterisation.seconds=2", "characterisation.settle=1")
GAIN = 0.04, 1e-6
"""Of an extension, and of a plate that hardly feels it, m/V."""


@dataclass
class Bending:
    """A stage whose plate goes further than in proportion, and rests away from its middle."""

    further: float = 0.0
    """1/m."""
    rest: float = 0.0
    """m, from the middle of the travel."""
    records: bool = False
    axis: int = 0
    loop: Pid | None = None
    config: StageConfig = field(default_factory=lambda: rig_file.load(None, StageConfig, list(QUICK)))
    played: list[float] = field(default_factory=list)

    def emit(self, drive: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        if self.records:
            return refuse_to_emit(drive)
        self.played.append(float(np.abs(drive).max()))
        middle = sum(self.config.limits.travel) / 2
        straight = GAIN[0] * drive * 50e-6
        heard = np.zeros((len(drive), 9))
        heard[:, :1] = 20e-6 + GAIN[1] * drive * 0.1
        heard[:, 3:4] = middle + self.rest + straight * (1 + self.further * np.abs(straight))
        return drive + self.config.limits.rest_voltage, heard


def recorded(bench: Bending, folder: Path) -> Experiment:
    with RawFolder(folder) as raw:
        return record(bench, raw)


def excursion(found: Experiment) -> float:
    return float(np.abs(found.learned[0].position[:, 0]).max())


@pytest.mark.parametrize("further", [0.0, 5e3])
def test_the_plate_moves_by_what_is_asked_for(tmp_path: Path, further: float) -> None:
    bench = Bending(further)
    found = recorded(bench, tmp_path)
    assert excursion(found) == pytest.approx(bench.config.characterisation.excursion, rel=0.15)
    assert len(bench.played) == 6, "scout, approach, up, down, fresh, and above the band"


def test_a_plate_that_rests_near_an_end_moves_no_further_than_there_is_room(tmp_path: Path) -> None:
    config = Bending().config
    low, high = config.limits.travel
    rest = 0.5 * (high - low) - 0.5 * config.characterisation.excursion
    found = recorded(Bending(rest=rest), tmp_path)
    assert excursion(found) < 0.5 * config.characterisation.excursion


def test_a_plate_that_leaves_its_travel_is_told_of_and_excited_again_more_weakly(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bench = Breaking()
    found = recorded(bench, tmp_path)
    assert "x-open-chirp: the plate went from" in capsys.readouterr().err
    assert bench.played[-4] == pytest.approx(0.6 * bench.played[-5], rel=0.02), "of the first that was too much"
    again = recorded(Breaking(records=True), tmp_path)
    assert again.amplitude == found.amplitude
    assert again.fingerprints == found.fingerprints
    np.testing.assert_array_equal(again.fresh.position, found.fresh.position)


def test_a_simulated_stage_that_its_guard_shuts_is_excited_more_weakly_as_well(tmp_path: Path) -> None:
    found = recorded(Breaking(shuts=True), tmp_path)
    again = recorded(Breaking(records=True), tmp_path)
    assert again.fingerprints == found.fingerprints


def test_a_plate_that_sticks_until_it_breaks_away_is_approached_more_faintly(tmp_path: Path) -> None:
    bench = Levered(scouted=0.25, loud=4.0)
    found = recorded(bench, tmp_path)
    excited = bench.config.characterisation.excursion
    assert 0.5 * excited < excursion(found) < 1.5 * excited
    assert sorted(path.name for path in tmp_path.glob("*approach*.json")) == [
        "x-open-approach.json",
        "x-open-approach2.json",
    ]
    assert recorded(Levered(records=True, scouted=0.25, loud=4.0), tmp_path).fingerprints == found.fingerprints


def test_a_scout_that_is_too_loud_is_played_more_faintly(tmp_path: Path) -> None:
    lively = Levered()
    found = recorded(lively, tmp_path)
    assert excursion(found) == pytest.approx(lively.config.characterisation.excursion, rel=0.2)
    assert (tmp_path / "x-open-scout2.json").is_file()
    assert recorded(Levered(records=True), tmp_path).fingerprints == found.fingerprints


def test_one_that_leaves_it_however_weak_the_drive_is_says_what_to_lower(tmp_path: Path) -> None:
    with pytest.raises(ExcitationError, match=r"must stay within limits\.travel, .* lower characterisation\.excursion"):
        recorded(Breaking(breaks=0.05), tmp_path)


@dataclass
class Breaking(Bending):
    """One that lets go above a part of the drive that was foreseen."""

    breaks: float = 0.9
    shuts: bool = False

    def emit(self, drive: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        emitted, heard = super().emit(drive)
        loud = len(self.played) > 3 or not self.played
        foreseen = self.config.characterisation.excursion / (GAIN[0] * 50e-6)
        if loud and np.abs(drive).max() > self.breaks * foreseen:
            if self.shuts:
                raise ExcitationError("axis x: the guard shut the stage: extension 1 is out of its range")
            heard[len(heard) // 2, 3] = 2 * self.config.limits.travel[1]
        return emitted, heard


@dataclass
class Levered(Bending):
    """One that moves so many times as far, with a scout and with more."""

    scouted: float = 30.0
    loud: float = 30.0

    def emit(self, drive: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        emitted, heard = super().emit(drive)
        middle = sum(self.config.limits.travel) / 2
        is_scout = np.abs(drive).max() <= self.config.characterisation.scout
        heard[:, 3] = middle + (self.scouted if is_scout else self.loud) * (heard[:, 3] - middle)
        return emitted, heard
