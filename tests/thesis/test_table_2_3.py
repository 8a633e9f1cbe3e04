"""Table 2.3 on the simulated cell: the order of the setups, and what mid-ranging is for."""

from typing import Any

import pytest

from rigkit.experiment.runner import Conduct
from rigkit.experiment.succession import run_in_memory
from stagectl.experiments.toroid.experiment import Toroid
from stagectl.experiments.toroid.plan import SETUPS, loops_of, plan, stage_of
from stagectl.robot.config import CellConfig

pytestmark = [pytest.mark.slow, pytest.mark.timeout(1_200)]


@pytest.fixture(scope="module")
def rows() -> dict[str, dict[str, Any]]:
    stage = stage_of(None)
    loops = loops_of(stage)
    plans = [plan(setup, CellConfig(), stage, loops) for setup in SETUPS]
    reasons, records = run_in_memory(Toroid(plans).parts(), Conduct())
    return {row["setup"]: row for row in Toroid(plans, reasons).figures(records)["setups"]}


def test_the_circles_are_in_the_order_of_table_2_3(rows: dict[str, dict[str, Any]]) -> None:
    """255, 47 and 32 um [Sörnmo 2015, tab. 2.3]; the accuracy wanted is 50 um [sec. 2.7]."""
    error = {setup: row["circle_mae"] for setup, row in rows.items()}
    assert error["A"] > 3 * error["B"] > 3 * error["C"]
    assert error["C"] < 50e-6


def test_the_surface_of_c_is_no_worse_than_that_of_a(rows: dict[str, dict[str, Any]]) -> None:
    """7 um each [Sörnmo 2015, tab. 2.3]; what is shorter than 2.5 mm as well."""
    assert rows["C"]["surface_std"] <= rows["A"]["surface_std"]
    assert rows["C"]["roughness"] <= rows["A"]["roughness"]


def test_the_stage_meets_its_ends_without_mid_ranging_and_never_with_it(rows: dict[str, dict[str, Any]]) -> None:
    assert rows["C"]["seconds_at_end"] == 0.0
    assert rows["C"]["fault"] is None
    assert rows["C-fixed"]["seconds_at_end"] > 1.0
