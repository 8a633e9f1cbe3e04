"""Macro and micro manipulators drawn by seed: within what is declared, stable, and the same wherever they are drawn."""

import numpy as np
import pytest

from firmware_sim.plants.manipulator_pair import ManipulatorPairPlant
from firmware_sim.population import pairs
from firmware_sim.population.pair_block import Pair
from firmware_sim.population.pair_population import PAIRS
from firmware_sim.population.pairs import FAMILIES, draw_pair
from rigkit.config import load
from rigkit.toml_text import value_text
from stagectl.robot.config import CellConfig
from stagectl.robot.midranging.controllers import controller
from tests.firmware_sim.population.census import SEEDS, all_draws, checksum, fills, numbers


def test_every_family_and_order_is_drawn() -> None:
    assert {draw.family for draw in all_draws(PAIRS)} == set(FAMILIES)
    assert set(numbers(all_draws(PAIRS), "order of macro")) == {1, 2, 3, 4}
    assert set(numbers(all_draws(PAIRS), "its order")) == {1, 2}


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [
        ("filter of guided motion", *pairs.CORNER),
        ("fastest", 5.0, 100.0),
        ("mode of macro", *pairs.MODE),
        ("its damping", 2.0, 15.0),
        ("travel", 2.0, 25.0),
        ("inner gain", *pairs.INNER),
        ("mode of micro", *pairs.RINGING),
    ],
)
def test_what_is_drawn_fills_its_range(name: str, low: float, high: float) -> None:
    assert fills(numbers(all_draws(PAIRS), name), low, high)


def test_dead_time_and_noise_reach_from_nothing_to_their_most() -> None:
    for name, most in (("dead time", 40.0), ("noise of relative, fast, slow", 50.0)):
        found = numbers(all_draws(PAIRS), name)
        assert found.min() == 0.0
        assert 0.9 * most < found.max() <= most
        assert 0.05 < np.mean(found == 0.0) < 0.35


def test_both_loops_are_stable_and_come_to_their_references() -> None:
    for seed in SEEDS[::8]:
        pair = draw_pair(seed, PAIRS.family(seed)).plant
        step, found = np.full((3_500, 1), 1e-6), [np.zeros((3_500, 1)) for _ in range(5)]
        ManipulatorPairPlant(250.0, pair, disturbance=0.0).run(step, step, *found)
        ends = found[4][-250:, 0] / 1e-6
        assert np.abs(ends - 2.0).max() < 0.05, seed


def test_the_micro_manipulator_is_the_faster_one() -> None:
    times = numbers(all_draws(PAIRS), "time to 63 %, macro, micro").reshape(-1, 2)
    ratio = times[:, 0] / times[:, 1]
    assert ratio.min() > 2.0
    assert ratio.max() > 20.0


def test_a_run_to_all_limits_is_finite() -> None:
    for seed in range(40):
        rng = np.random.default_rng(seed)
        references, found = rng.uniform(-0.1, 0.1, (2, 1_000, 1)), [np.zeros((1_000, 1)) for _ in range(5)]
        pair = draw_pair(seed, PAIRS.family(seed)).plant
        ManipulatorPairPlant(250.0, pair, [(1.0, 1.5)], 5e-3, 2.0).run(*references, *found)
        assert all(np.isfinite(each).all() for each in found)
        assert np.abs(found[1]).max() < 2 * pair.micro.stop + 1e-3


def test_a_draw_is_the_same_wherever_it_is_made() -> None:
    assert checksum(all_draws(PAIRS)[:50]) == "b5b632320f8fd97e"


def test_a_seed_has_the_same_pair_each_time_and_families_differ() -> None:
    assert checksum([PAIRS.draw(11)]) == checksum([PAIRS.draw(11)])
    assert len({checksum([PAIRS.draw(11, family)]) for family in FAMILIES}) == len(FAMILIES)
    assert len({checksum([draw]) for draw in all_draws(PAIRS)}) == len(SEEDS)


@pytest.mark.parametrize("name", ["aimc", "mvpc", "mvpc-aw", "vpc"])
def test_every_rig_file_is_one_that_mid_ranging_takes(name: str) -> None:
    """Waves do not saturate, filters are stable: what a controller refuses it refuses as it is made."""
    for draw in all_draws(PAIRS)[:60]:
        config = load(None, CellConfig, [f"{key}={value_text(value)}" for key, value in draw.keys.items()])
        controller(name, config.midranging).prepare(config.midranging.pair.rate, 1)
        assert config.midranging.simulator.options == {"seed": draw.seed, "family": draw.family}


def test_its_noise_may_be_another() -> None:
    blocks = Pair(seed=4), Pair(seed=4, noise=1e-3)
    found = []
    for block in blocks:
        block.prepare(250.0, 500)
        outputs = [np.zeros((500, 1)) for _ in block.outputs]
        block.process(np.zeros((500, 1)), np.zeros((500, 1)), *outputs)
        found.append(outputs[0].std())
    assert found[1] == pytest.approx(1e-3, rel=0.1)
    assert found[0] < 1e-4
