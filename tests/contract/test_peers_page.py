"""The page beside other programs belongs to what was measured; what is said of others has its source."""

import json
import re
from collections.abc import Callable

import numpy as np
import pytest

from benchmarks.page_table import DOCS
from benchmarks.peers import identification, ilc_laws, planners
from benchmarks.peers.__main__ import KEPT, PAGE
from benchmarks.peers.features import features
from benchmarks.peers.page import page
from stagectl.planning.exact import least_time
from tests.stagectl.planning.pockets import random_pocket


def test_the_page_is_the_one_that_the_kept_rows_give() -> None:
    """`python -m benchmarks.peers --write` writes it."""
    assert PAGE.read_text(encoding="utf-8") == page(json.loads(KEPT.read_text(encoding="utf-8")))


def test_each_statement_has_a_source_and_each_row_a_cell_for_every_system() -> None:
    for table in features():
        for row in table["rows"]:
            assert len(row["cells"]) == len(table["systems"]), row["feature"]
            for cell in filter(None, row["cells"]):
                said, link = cell
                assert said
                assert re.match(r"https?://\S+$", link) or (DOCS / link.partition("#")[0]).is_file(), link


def test_the_headline_rows_of_identification_are_found() -> None:
    rows = identification.rows()
    assert len(rows) == 10
    assert all(len(row) == len(identification.HEAD) for row in rows)
    assert any(float(row[1]) > float(row[2].split(": ")[1]) for row in rows)


@pytest.mark.parametrize("way", [planners.by_scipy, planners.by_integers])
@pytest.mark.parametrize("feeds", ["EW", "EWNS"])
def test_others_find_the_same_least_time(way: Callable[..., float], feeds: str) -> None:
    pocket = random_pocket(np.random.default_rng(5), 5, 4, 2, feeds, True)
    assert way(*planners.graph(pocket)) == pytest.approx(least_time(pocket), rel=1e-9)


def test_a_law_that_diverges_is_told_and_a_right_model_is_learned() -> None:
    drawn = ilc_laws.case(1)
    lost = ilc_laws.run(
        drawn, lambda drive, _: 100.0 * (drive + drawn.reference), drawn.reference, np.random.default_rng()
    )
    assert np.isinf(lost[-1])
    right = ilc_laws.Case(drawn.plant, drawn.plant, drawn.reference)
    errors = {
        name: ilc_laws.run(right, law, drive, np.random.default_rng(1)) for name, law, drive in ilc_laws.laws(right)
    }
    assert errors["norm-optimal, lifted, by 0.001"][-1] < 0.1
    assert errors["ours, `KalmanILC`"][-1] < 0.01
