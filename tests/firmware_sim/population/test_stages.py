"""Stages drawn by seed: within what is declared, finite, and the same wherever they are drawn."""

import numpy as np
import pytest
from scipy import linalg, signal

from firmware_sim.plants.flexure_stage import FlexureStagePlant, Modes
from firmware_sim.population import stage_modes, stages
from firmware_sim.population.stage_population import STAGES
from firmware_sim.population.stages import FAMILIES, draw_stage
from firmware_sim.population.streams import Streams
from rigkit.config import load
from rigkit.toml_text import value_text
from stagectl.config import StageConfig
from tests.firmware_sim.population.census import SEEDS, all_draws, checksum, fills, numbers, words


@pytest.mark.slow
def test_every_family_and_every_kind_of_creep_and_structure_is_drawn() -> None:
    assert {draw.family for draw in all_draws(STAGES)} == set(FAMILIES)
    assert words(all_draws(STAGES), "creep") == set(stages.CREEPS)
    assert words(all_draws(STAGES), "structure") == set(stage_modes.STRUCTURES)


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [
        ("travel", 30.0, 500.0),
        ("lever", *stages.LEVER),
        ("gain from hysteresis", 5.0, 30.0),
        ("amplifier", *stages.AMPLIFIER),
        ("second lag", *stages.LAG),
        ("filters of gauge, plate, laser", *stages.FILTER),
        ("damping", 0.3, 5.0),
    ],
)
def test_what_is_drawn_fills_its_range(name: str, low: float, high: float) -> None:
    assert fills(numbers(all_draws(STAGES), name), low, high)


def test_modes_are_two_to_eight_an_axis_from_40_to_400_hz_and_some_are_near_pairs() -> None:
    counts, nearest = [], []
    for draw in all_draws(STAGES):
        for name in "xyz":
            modes = numbers([draw], f"modes of {name}")
            counts.append(len(modes))
            nearest.append(np.min(modes[1:] / modes[:-1]))
            assert modes.min() >= 40.0
            assert modes.max() <= 400.0
    assert set(counts) == set(range(2, 9))
    assert 0.3 < np.mean(np.array(nearest) < 1.05) < 0.8
    assert np.min(nearest) > 1.0


def unstable_zeros(modes: Modes, axis: int) -> int:
    """Count the zeros outside the unit circle at 10 kHz from a stack to its plate, but those that sampling makes."""
    own = np.flatnonzero(modes.extension[axis])
    omega, count = 2 * np.pi * modes.frequency[own], len(own)
    upper = np.hstack([np.zeros((count, count)), np.eye(count)])
    lower = np.hstack([-np.diag(omega**2), -np.diag(2 * modes.damping[own] * omega)])
    drive = np.concatenate([np.zeros(count), modes.stiffness[axis] * modes.extension[axis, own]])[:, None]
    seen = np.concatenate([modes.plate[axis, own], np.zeros(count)])[None]
    system = signal.cont2discrete((np.vstack([upper, lower]), drive, seen, np.zeros((1, 1))), 1e-4)[:4]
    whole = np.block([[system[0], system[1]], [system[2], system[3]]])
    zeros = linalg.eigvals(whole, np.diag([1.0] * 2 * count + [0.0]))  # of Rosenbrock's system matrix
    zeros = zeros[np.isfinite(zeros)]
    return int(np.sum((np.abs(zeros) > 1.0 + 1e-6) & (zeros.real > 0) & (np.abs(zeros) < 1e3)))


def test_paths_of_one_sense_have_no_zeros_outside_the_unit_circle_and_many_others_do() -> None:
    found: dict[str, list[int]] = {name: [] for name in stage_modes.STRUCTURES}
    for draw in all_draws(STAGES)[:100]:
        made = draw_stage(draw.seed, draw.family)
        found[made.structure].append(sum(unstable_zeros(made.plant.modes, axis) for axis in range(3)))
    assert max(found["collocated"]) == 0
    assert np.mean(np.array(found["non-collocated"] + found["mixed"]) > 0) > 0.5


@pytest.mark.parametrize("seeds", [range(0, 300, 12), range(1, 300, 12)])
def test_a_short_run_is_finite_and_goes_through_the_travel(seeds: range) -> None:
    up = 0.5 - 0.5 * np.cos(np.pi * np.arange(3_000) / 3_000)
    for seed in seeds:
        made = draw_stage(seed, STAGES.family(seed))
        noise = np.random.default_rng(seed).uniform(size=1_000)
        voltage = np.tile(np.concatenate([up, noise])[:, None] * made.plant.stacks[0].voltage[1], 3)
        force, base = np.full_like(voltage, 1.0), np.full_like(voltage, 1e-6)
        found = [np.empty_like(voltage) for _ in range(3)]
        FlexureStagePlant(10_000.0, made.plant).run(voltage, force, base, *found)
        assert all(np.isfinite(each).all() for each in found), seed
        gone = np.ptp(found[1][:3_000], axis=0) / made.travel
        assert gone.min() > 0.85, seed
        assert gone.max() < 1.6, seed


def test_a_draw_is_the_same_wherever_it_is_made() -> None:
    assert checksum(all_draws(STAGES)[:50]) == "a387ae7bc07c0b03"


def test_a_seed_has_the_same_stage_each_time_and_families_differ() -> None:
    assert checksum([STAGES.draw(11)]) == checksum([STAGES.draw(11)])
    assert len({checksum([STAGES.draw(11, family)]) for family in FAMILIES}) == len(FAMILIES)
    assert len({checksum([draw]) for draw in all_draws(STAGES)}) == len(SEEDS)


def test_a_property_more_redraws_none_of_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    """A property's stream is its own: one that takes more numbers changes itself alone."""
    before = {each.name: each.value for each in all_draws(STAGES)[7].quantities}
    plain = Streams.__call__

    def thirsty(self: Streams, name: str) -> np.random.Generator:
        made = plain(self, name)
        if name == "lags":
            made.uniform(size=3)
        return made

    monkeypatch.setattr(Streams, "__call__", thirsty)
    after = {each.name: each.value for each in STAGES.draw(7).quantities}
    assert {name for name in before if before[name] != after[name]} == {"amplifier", "second lag"}


def test_every_rig_file_is_one_that_stagectl_takes() -> None:
    for draw in all_draws(STAGES)[:40]:
        keys = [f"{key}={value_text(value)}" for key, value in draw.keys.items()]
        config = load(None, StageConfig, keys)
        assert config.simulator.options == {"seed": draw.seed, "family": draw.family}
