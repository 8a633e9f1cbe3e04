"""Scales of a prior that are estimated from what was milled, and the caution with which the first pocket is."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from stagectl.planning.caution import LOSS, Caution
from stagectl.planning.exact import least_time
from stagectl.planning.milling import mill, total
from stagectl.planning.pocket import PocketFault, check, planner
from stagectl.planning.problem import Pocket, milling_types
from stagectl.planning.rate_belief import BELIEVED, Prior, RateBelief, shared_covariance
from stagectl.planning.rate_lots import Lot, read_lots, write_lots
from stagectl.planning.rate_scales import MOST_LOTS, Scales, estimated
from stagectl.planning.strips import Cut, costs
from stagectl.planning.uncertain import UncertainPlanner
from stagectl.planning.zigzag import ZigzagPlanner
from tests.stagectl.planning.pockets import EXAMPLE

POCKET = Pocket.from_dict(EXAMPLE)
STRIPS = [(Cut(way, k).name(2), Cut(way, k).side) for way in range(8) for k in (1, 2)]


def _lots(prior: Prior, count: int, seed: int) -> list[Lot]:
    """Draw lots of a prior, each strip milled three times."""
    rng = np.random.default_rng(seed)
    names, sides = (np.array(each) for each in zip(*STRIPS, strict=True))
    covariance, lots = shared_covariance(names, sides, prior), []
    for _ in range(count):
        lot = Lot()
        drawn = rng.multivariate_normal(np.zeros(len(STRIPS)), covariance, method="cholesky")
        for (name, side), each in zip(STRIPS, drawn, strict=True):
            for _ in range(3):
                lot.add(name, side, float(each + prior.noise * rng.normal()))
        lots.append(lot)
    return lots


def test_scales_are_found_again_in_lots_that_were_drawn_from_them() -> None:
    true = Prior(common=0.3, side=0.01, feed=0.2, type=0.1, own=0.05, noise=0.02, optimism=0.5)
    found = estimated(_lots(true, 40, 1), BELIEVED)
    for name in ("common", "feed", "type", "own"):
        assert getattr(found, name) == pytest.approx(getattr(true, name), rel=0.35), name
    assert found.noise == pytest.approx(true.noise, rel=0.1)
    assert found.side < 0.05
    assert found.optimism == BELIEVED.optimism


def test_nothing_milled_leaves_the_scales_as_they_were() -> None:
    assert estimated([Lot()], BELIEVED) is BELIEVED


def test_one_strip_says_little_of_scales() -> None:
    lot = Lot()
    lot.add("E3", "N", 0.1)
    found = estimated([lot], BELIEVED)
    for name in ("common", "side", "feed", "type", "own"):
        assert 0.5 < getattr(found, name) / getattr(BELIEVED, name) < 2.0


def test_a_file_keeps_lots_from_one_planner_to_the_next_each_its_own(tmp_path: Path) -> None:
    file = tmp_path / "prior.json"
    dear = replace(POCKET, true={"rate": {name: 1.3 * rate for name, rate in POCKET.rate.items()}})
    for _ in range(2):
        made = planner("uncertain", dear, prior=file)
        for _ in range(2):
            mill(dear, made)
    lots = read_lots(file)
    assert len(lots) == 2
    assert lots[0].sums["E3", "N"][1] / lots[0].sums["E3", "N"][0] == pytest.approx(np.log(1.3))
    assert json.loads(file.read_text())["scales"]["common"] > 1.5 * BELIEVED.common


def test_a_file_keeps_the_newest_lots(tmp_path: Path) -> None:
    file = tmp_path / "prior.json"
    write_lots(file, _lots(BELIEVED, MOST_LOTS, 2), BELIEVED)
    oldest = read_lots(file)[0]
    scales = Scales(BELIEVED, file)
    scales.take("E2", "N", 0.5)
    scales.keep()
    kept = read_lots(file)
    assert len(kept) == MOST_LOTS
    assert kept[-1].sums == {("E2", "N"): [1.0, 0.5, 0.25]}
    assert oldest not in kept


ROWS = (
    ["E3", "N", 1, 0.0], ["E4x", "N", 1, 0.0, 0.0], ["E3", "W", 1, 0.0, 0.0], ["E3", "", 1, 0.0, 0.0],
    ["E3", "N", 0, 0.0, 0.0], ["E3", "N", 1, 2.0, 1.0], ["E3", "N", 1, 0.0, -1.0], [3, "N", 1, 0.0, 0.0], 7,
    ["E3", "N", True, 0.0, 0.0, 0.0], {"E3": 1}, ["E3", "N", "1", 0.0, 0.0],
)  # fmt: skip


@pytest.mark.parametrize("row", ROWS, ids=str)
def test_a_file_that_holds_no_lots_is_refused_by_name(tmp_path: Path, row: object) -> None:
    file = tmp_path / "prior.json"
    file.write_text(json.dumps({"scales": {}, "lots": [[row]]}))
    with pytest.raises(ValueError, match=r"prior\.json: has .*, must be \[type, side, count >= 1"):
        planner("uncertain", POCKET, prior=file)
    file.write_text(json.dumps({"lots": []}))
    with pytest.raises(ValueError, match=r"prior\.json: has lots, must have scales, lots"):
        read_lots(file)


def test_a_planner_without_a_prior_refuses_its_file(tmp_path: Path) -> None:
    with pytest.raises(PocketFault, match="planner is 'exact', must be uncertain to keep a prior"):
        planner("exact", POCKET, prior=tmp_path / "prior.json")


def _off(seed: int) -> Pocket:
    """Return a pocket whose rates are off by 15 %."""
    rng = np.random.default_rng(seed)
    names = milling_types(3, "EW")
    believed = {name: (int(name[1]) / 3) ** 0.8 * rng.uniform(1.0, 1.6) for name in names}
    paid = {name: rate * float(np.exp(0.15 * rng.normal())) for name, rate in believed.items()}
    return Pocket(18, 18, 3, "EW", believed, t_acc=0.2, step=0.05, t_lift=1.0, v_lift=10.0, true={"rate": paid})


def test_the_first_pocket_is_seldom_slower_than_the_default_order_and_the_third_near_the_optimum(
    tmp_path: Path,
) -> None:
    worse, third = [], []
    for seed in range(20):
        pocket = _off(seed)
        plain = total(mill(pocket, ZigzagPlanner(pocket)))
        made = planner("uncertain", pocket, prior=tmp_path / f"{seed}.json")
        segments = [mill(pocket, made) for _ in range(3)]
        assert all(check(pocket, [each.in_path for each in one]).complete for one in segments)
        worse.append(total(segments[0]) / plain - 1.0)
        third.append(total(segments[2]) / least_time(pocket) - 1.0)
    assert np.mean(np.array(worse) <= LOSS) >= 0.9
    assert np.median(third) < 0.02


def test_a_loss_that_is_believed_to_be_likely_is_not_risked() -> None:
    gain = {name: rate * (0.97 if int(name[1]) < 3 else 1.0) for name, rate in _off(3).rate.items()}
    pocket = replace(_off(3), rate=gain)
    timid = Prior(0.0, 0.0, 0.0, 0.0, 3.0)
    made = UncertainPlanner(pocket, RateBelief(pocket, costs(pocket).rate, timid), Scales(timid))
    default = ZigzagPlanner(pocket)
    assert all(each.cut == default.choose(each.standing) for each in mill(pocket, made))


def test_a_strip_under_way_counts_in_what_is_chosen_ahead() -> None:
    pocket = _off(5)
    caution = Caution(pocket)
    for each in mill(pocket, planner("exact", pocket))[:-1]:
        assert list(caution._under_way(each.leaves())) == [(each.cut, each.standing)]  # noqa: SLF001
        caution.learn(each)
        assert list(caution._under_way(each.leaves())) == []  # noqa: SLF001


def test_of_few_lots_the_scales_are_not_known_and_caution_is_greater() -> None:
    deviations = [Caution(_off(3), lots).deviations for lots in (0, 1, 4, 30)]
    np.testing.assert_allclose(deviations, [1.645, 2.920, 2.015, 1.696], atol=1e-3)
