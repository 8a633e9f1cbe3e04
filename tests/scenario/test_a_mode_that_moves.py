"""A mode moves in mid-run: its band is found, reidentified while the reference goes on, and learned again."""

from typing import Any

import pytest

from benchmarks.direct import shots
from rigkit import config as rig_file
from tests.thesis.vibrator_runs import measured_model
from vibractl.config import RigConfig
from vibractl.model_file import read_model
from vibractl.quality import Marks
from vibractl.setup import setup
from vibractl.transfer_matrix import TransferMatrix

ONSET = 15
SHOT = 5.6
MOVES = (
    "simulator.options.moving_mode=545",
    "simulator.options.moving_widths=1.5",
    f"simulator.options.moving_at={ONSET * SHOT}",
    "simulator.options.moving_seconds=6",
)


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> TransferMatrix:
    return read_model(measured_model(tmp_path_factory.mktemp("model"), "characterisation.method=multisine"))


def watched(
    model: TransferMatrix, count: int, *overrides: str
) -> tuple[list[Marks], list[tuple[int, str, dict[str, Any]]]]:
    """Return the marks of a run under watch, and what was decided after which shot."""
    config = rig_file.load(None, RigConfig, ("watch.on=true", *overrides))
    marks, decisions = [], []
    for number, heard in enumerate(shots(setup(config, model), count)):
        marks.append(heard.marks)
        decisions += [(number, decision.event, decision.fields) for decision in heard.learner.algorithm.decisions]
    return marks, decisions


def worst(mark: Marks) -> float:
    return float(mark.worst_line_db.max())


@pytest.mark.slow
def test_it_is_caught_within_four_shots_and_two_more_a_band_restore_convergence(model: TransferMatrix) -> None:
    """The mode leaves one band and enters the next: both are reidentified, one after the other."""
    marks, decisions = watched(model, 28, *MOVES)
    kinds = [event for _, event, _ in decisions]
    bands = len(kinds) // 3
    assert 1 <= bands <= 2
    assert kinds == bands * ["divergence", "reidentify", "reidentified"], decisions
    assert ONSET <= decisions[0][0] <= ONSET + 4
    for band in range(bands):
        (found, _, _), _, (finished, _, gained) = decisions[3 * band : 3 * band + 3]
        assert finished == found + 2
        assert gained["contraction_after"] < 0.95 < 1.05 < gained["contraction_before"]
        before = worst(marks[found])
        for number in (found + 1, found + 2):  # the chirps add next to nothing to what the mode did
            assert worst(marks[number]) < before + 1.0
    assert worst(marks[-1]) < -6.0


@pytest.mark.slow
def test_with_the_drive_taken_away_as_the_text_says_it_is_not_restored(model: TransferMatrix) -> None:
    kept, _ = watched(model, 24, *MOVES)
    zeroed, _ = watched(model, 24, *MOVES, "watch.input=zeroed")
    assert worst(zeroed[-1]) > worst(kept[-1]) + 6.0


@pytest.mark.slow
def test_a_vibrator_that_keeps_its_modes_raises_no_alarm(model: TransferMatrix) -> None:
    _, decisions = watched(model, 30)
    assert decisions == []
