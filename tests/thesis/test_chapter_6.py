"""Sörnmo 2015, chapter 6, on the default simulated vibrator: the published results, with the thesis' own gains.

All of it is slow: half an hour of stepped sine is simulated for the model, and the thesis' law takes thirty shots.
"""

from pathlib import Path

import pytest

from tests.thesis.vibrator_runs import learned, measured_model, met, worst
from vibractl.quality_table import summary

pytestmark = pytest.mark.slow

NO_TAIL = "shot.tail=0.1"
"""The least there can be: what rings after the reference is not judged in the thesis.  With the default of 0.4 s one
line, at 212 Hz, stays 2 to 4 dB over the limit."""


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the model of the preloaded vibrator."""
    return measured_model(tmp_path_factory.mktemp("preloaded"))


@pytest.fixture(scope="module")
def mimo(model: Path, tmp_path_factory: pytest.TempPathFactory) -> list[dict[str, str]]:
    """Return the shots of a MIMO run of the 40-90 Hz chirp with (6.25)."""
    return learned(tmp_path_factory.mktemp("mimo") / "run", model, 61, NO_TAIL)


def test_mimo_meets_the_objective_by_shot_30(mimo: list[dict[str, str]]) -> None:
    """Page 135: both sides met by iteration 30."""
    shot = met(mimo)
    assert shot is not None
    assert shot <= 30


def test_mimo_brings_the_iae_down_fifty_times(mimo: list[dict[str, str]]) -> None:
    """Page 137: the IAE decreased by a factor of approximately 50 for both channels."""
    assert min(summary(mimo[:31])["iae_ratio"]) >= 50


def test_mimo_stays_flat_to_shot_60(mimo: list[dict[str, str]]) -> None:
    """Figure 6.17: kept around its minimum, it does not increase.  Drift is left, so a quarter more is allowed."""
    for side in ("iae_1", "iae_2"):
        lowest = min(float(row[side]) for row in mimo[:41])
        assert float(mimo[60][side]) < 1.25 * lowest
    assert worst(mimo, 60) <= 0


def test_siso_meets_the_objective_by_shot_30(model: Path, tmp_path: Path) -> None:
    """Page 134: the objective is achieved after 30 iterations."""
    shot = met(learned(tmp_path / "run", model, 31, "learning.side=1"))
    assert shot is not None
    assert shot <= 30


def test_a_sine_of_24_hz_meets_the_objective_by_shot_24_and_goes_10_db_below(model: Path, tmp_path: Path) -> None:
    """Page 132: four overtones 40 dB under the root after 24 iterations, and 10-15 dB more."""
    rows = learned(tmp_path / "run", model, 51, "learning.side=1", "reference.signal=sine:24:5")
    shot = met(rows)
    assert shot is not None
    assert shot <= 24
    assert worst(rows, 50) <= -10


def test_identification_without_preload_fails(tmp_path: Path) -> None:
    """Page 131: convergence could only be achieved with the preloaded estimate."""
    unloaded = measured_model(tmp_path, "characterisation.preload=0.0", "characterisation.passes=1")
    assert met(learned(tmp_path / "run", unloaded, 31)) is None


def test_decentralised_control_of_the_two_sides_fails(model: Path, tmp_path: Path) -> None:
    """Page 135: because of the cross couplings, decentralised ILC was ruled out."""
    rows = learned(tmp_path / "run", model, 31, "learning.structure=decentralised")
    assert met(rows) is None
    assert len(rows) < 31 or worst(rows, 30) > 10


def test_one_drive_for_both_sides_is_poor(model: Path, mimo: list[dict[str, str]], tmp_path: Path) -> None:
    """Page 135: with the same input to both sides, poor tracking performance was obtained."""
    rows = learned(tmp_path / "run", model, 31, "learning.structure=common")
    assert met(rows) is None
    for side in ("error_db_1", "error_db_2"):
        assert float(rows[-1][side]) > float(mimo[30][side]) + 15


def test_model_inverse_start_and_gain_one_half_meet_the_objective_within_12_shots(model: Path, tmp_path: Path) -> None:
    """Beyond the thesis: per-line regularisation, first drive from the inverse, K = 0.5."""
    shot = met(learned(tmp_path / "run", model, 16, NO_TAIL, "learning.start=inverse", "learning.gains=[0.5]"))
    assert shot is not None
    assert shot <= 12


@pytest.mark.timeout(1800)
def test_nine_of_ten_vibrators_meet_the_objective_within_12_shots(tmp_path: Path) -> None:
    """The same on ten seeds, each with a model of its own."""
    shots = {}
    for seed in range(1, 11):
        chosen = f"simulator.options.seed={seed}"
        (tmp_path / str(seed)).mkdir()
        own = measured_model(tmp_path / str(seed), chosen)
        faster = (NO_TAIL, "learning.start=inverse", "learning.gains=[0.5]", chosen)
        shots[seed] = met(learned(tmp_path / str(seed) / "run", own, 16, *faster))
    within = [seed for seed, shot in shots.items() if shot is not None and shot <= 12]
    assert len(within) >= 9, shots
