"""Robot cells drawn by seed: within what is declared, physically sound, and the same wherever they are drawn."""

import numpy as np
import pytest

from firmware_sim.plants.robot import RobotPlant
from firmware_sim.plants.robot_arms import ARMS
from firmware_sim.plants.robot_joint_kernel import BACKLASH, MOTOR_SPEED, friction
from firmware_sim.plants.robot_joint_kernel import CELLS as ROWS_OF_STATE
from firmware_sim.plants.tooth_cut import ToothCutPlant
from firmware_sim.population import cells, cuts, robots
from firmware_sim.population.cell_blocks import Cut, Robot
from firmware_sim.population.cell_population import CELLS
from firmware_sim.population.cells import draw_cell
from firmware_sim.population.draw import Draw
from rigkit.config import load
from rigkit.named_code import named_block
from rigkit.toml_text import value_text
from stagectl.robot.config import CellConfig
from tests.firmware_sim.population.census import all_draws, checksum, fills, numbers, words
from tests.firmware_sim.tooth_runs import path

SEEDS = range(200)
RATE = 2_000.0


def draws() -> list[Draw]:
    """Return the cells of all seeds."""
    return all_draws(CELLS, len(SEEDS))


def test_every_family_and_every_kind_of_friction_is_drawn() -> None:
    assert {draw.family for draw in draws()} == set(cuts.FAMILIES)
    assert words(draws(), "friction") == set(robots.FRICTIONS)
    assert set(numbers(draws(), "teeth")) == {2, 3, 4}
    assert set(numbers(draws(), "delay of guided motion")) == {1, 2, 3, 4}


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [
        ("compliance about the axes, over its kind's", *robots.COMPLIANCE),
        ("compliance across the axes, over its kind's", *robots.COMPLIANCE),
        ("friction over its kind's", *robots.FRICTION),
        ("stribeck", *robots.STRIBECK),
        ("load friction", *robots.LOADED),
        ("cooling", *robots.COOLING),
        ("payload", *robots.PAYLOAD),
        ("gear error", *robots.GEAR_ERROR),
        ("filter of guided motion", *robots.FILTER),
        ("spindle", *cuts.SPINDLE),
        ("radial over tangential", *cuts.RADIAL),
        ("depth over the limit of chatter", *cuts.OVER_LIMIT),
        ("knots harder by", *cuts.KNOT),
        ("Kienzle's power", *cuts.POWER),
        ("full cut in steel", *cells.TOROID),
        ("tracker's noise", 20.0, 200.0),
        ("tracker's warp", 10.0, 150.0),
        ("force sensor's noise", *cells.FORCE_NOISE),
        ("force sensor's drift", *cells.DRIFT),
        ("force sensor's crosstalk", 0.1, 3.0),
    ],
)
def test_what_is_drawn_fills_its_range(name: str, low: float, high: float) -> None:
    assert fills(numbers(draws(), name), low, high)


def test_backlash_and_hardness_reach_from_nothing_to_their_most() -> None:
    backlash = max(RobotPlant(**draw_cell(seed, "linear").robot.arm).joints[BACKLASH].max() for seed in SEEDS[::10])
    assert 2e-4 < backlash <= 0.5e-3
    assert 0.1 < np.mean(numbers(draws(), "backlash, over 0.1 mrad") == 0.0) < 0.35
    assert np.all(numbers(draws(), "backlash, over 0.1 mrad") <= robots.BACKLASH[1])
    assert fills(numbers(draws(), "boards harder than the first by"), *cuts.HARDER)
    forces = numbers(draws(), "slot of 2 mm at 10 mm/s")
    assert cuts.FORCE[0] <= forces.min() < 3.0 < 30.0 < forces.max() <= cuts.FORCE[1] * 1.01


def test_friction_takes_work_whatever_the_joint_does() -> None:
    """Over any motion from rest the joints take energy: what presliding gives back it was given before."""
    rng = np.random.default_rng(1)
    for seed in SEEDS[::10]:
        joints = RobotPlant(**draw_cell(seed, "linear").robot.arm).joints
        state = np.zeros((ROWS_OF_STATE, 6))
        speeds = np.cumsum(rng.standard_normal((400, 6)), axis=0) * 3e-3 * rng.choice([0.02, 1.0])
        loads, work, least = 50.0 * rng.standard_normal(6), np.zeros(6), 0.0
        for speed in speeds:
            state[MOTOR_SPEED] = speed
            work += [1.25e-4 * speed[i] * friction(i, 1.25e-4, loads[i], joints, state)[0] for i in range(6)]
            least = min(least, float(work.min()))
        assert least > -1e-9, seed
        assert work.min() > 0.0, seed


def test_every_arm_comes_to_rest_where_it_is_sent() -> None:
    for seed in SEEDS[::20]:
        robot = Robot(seed=seed)
        robot.prepare(RATE, 4_000)
        home = np.deg2rad(ARMS["irb140"].home)
        step = 0.01 * np.minimum(np.arange(4_000) / 600, 1.0)[:, None]
        outputs = [np.zeros((4_000, port.width)) for port in robot.outputs]
        robot.process(home + step, np.zeros((4_000, 3)), np.zeros((4_000, 3)), *outputs)
        angle, position = outputs[2], outputs[4]
        assert all(np.isfinite(each).all() for each in outputs), seed
        assert np.abs(angle[-100:] - home - 0.01).max() < 2e-4, seed
        first, last = (np.ptp(position[part], axis=0).max() for part in (slice(1_400, 1_800), slice(-400, None)))
        assert last < max(0.5 * first, 2e-5), seed
        assert outputs[1].all(), seed


def cut_along(family: str, feed: tuple[float, float], piece: int = 1, hardness: float = 1.0) -> dict[str, np.ndarray]:
    """Return the outputs of a cell's cut on rails along a feed, m/s, for 0.5 s, by name."""
    made = Cut(cell=4, family=family, seed=piece, hardness=hardness, length=60e-3, width=30e-3)
    tool = path(feed, 0.5, cuts.DEPTH)
    made.prepare(RATE, len(tool))
    outputs = {port.name: np.zeros((len(tool), port.width)) for port in made.outputs}
    made.process(tool, np.zeros((len(tool), 9)), *outputs.values())
    return outputs


@pytest.mark.parametrize("family", cuts.FAMILIES)
def test_the_force_of_every_family_opposes_the_feed_and_is_the_one_declared(family: str) -> None:
    """In the middle of the piece; wood and boards differ from place to place."""
    declared = draw_cell(4, family).cut
    for feed in ((10e-3, 0.0), (0.0, -10e-3)):
        mean = cut_along(family, feed)["teeth_force"][300:].mean(axis=0)
        assert mean[:2] @ feed < 0.0
        reach = 0.1 if family in ("linear", "power", "teeth") else 0.9
        if family != "chatter":
            assert np.hypot(*mean[:2]) == pytest.approx(declared.force, rel=reach + 2 * cuts.SCATTER)


@pytest.mark.parametrize("family", cuts.FAMILIES)
def test_the_air_costs_nothing(family: str) -> None:
    made = Cut(cell=4, family=family, origin=(0.0, 0.0, -5e-3))
    made.prepare(RATE, 400)
    outputs = [np.ones((400, port.width)) for port in made.outputs]
    made.process(path((10e-3, 5e-3), 0.2), np.zeros((400, 9)), *outputs)
    assert not any(each.any() for each in outputs[:3])


def test_teeth_that_stand_out_show_once_a_turn() -> None:
    lines = {}
    for family in ("linear", "teeth"):
        force = cut_along(family, (10e-3, 0.0))["teeth_force"][400:, 0]
        turned = 2 * np.pi * draw_cell(4, family).cut.cut.spindle * np.arange(len(force)) / RATE
        wave = np.exp(-1j * turned) * np.hanning(len(force))
        lines[family] = abs((force - force.mean()) @ wave) * 4 / len(force) / abs(force.mean())
    assert lines["teeth"] > 0.2
    assert lines["linear"] < 0.02


def ringing(seed: int, share: float) -> float:
    """Return the part of a drawn tool's ringing that does not come again with the teeth, at `share` of its limit."""
    drawn = draw_cell(seed, "chatter").cut
    piece, samples = drawn.piece(1, 1.0), 2_000
    plant = ToothCutPlant(RATE, piece)
    tool = path((10e-3, 0.0), samples / RATE, share * cuts.DEPTH / drawn.over_limit)
    outputs, rings = [np.zeros((1, width)) for width in (3, 3, 3, 1, 1)], np.zeros((samples, 2))
    for n in range(samples):
        plant.run(tool[n : n + 1], np.zeros((1, 9)), *outputs)
        rings[n] = plant.ringing
    last = rings[samples // 2 :]
    time = np.arange(len(last)) / RATE
    turns = 2 * np.pi * piece.spindle * np.arange(13)[:, None] * time
    periodic = np.vstack([np.cos(turns), np.sin(turns[1:])]).T
    rest = last - periodic @ np.linalg.lstsq(periodic, last, rcond=None)[0]
    return float(np.sqrt((rest**2).mean() / (last**2).mean()))


@pytest.mark.slow
def test_drawn_tools_chatter_beyond_their_limit_and_not_well_below() -> None:
    """The limit of Altintas and Budak is a mean over half a turn: of two teeth it may be too low by half."""
    beyond = []
    for seed in range(8):
        assert ringing(seed, 0.8) < 0.05, seed
        beyond.append(ringing(seed, 1.4) > 0.2)
    assert sum(beyond) >= 7


def test_every_rig_file_is_one_that_stagectl_takes_and_all_of_its_plants_can_be_built() -> None:
    for draw in draws()[:6]:
        config = load(None, CellConfig, [f"{key}={value_text(value)}" for key, value in draw.keys.items()])
        plants, options = config.plants, config.simulator.options
        assert options == {"seed": draw.seed, "family": draw.family}
        for name, given in (
            (plants.robot, options | plants.robot_options),
            (config.simulator.clamped, options),
            (plants.pocket, plants.pocket_options),
            (config.feed_plants.cut, config.feed_plants.cut_options),
            (plants.tracker, plants.tracker_options),
            (plants.force_sensor, plants.force_sensor_options),
            (plants.cut, plants.cut_options),
        ):
            named_block(name, given)


def test_robot_and_sensors_are_those_of_the_seed_whatever_is_cut() -> None:
    first, *others = (draw_cell(7, family) for family in cuts.FAMILIES)
    assert all((each.robot, each.tracker, each.sensor) == (first.robot, first.tracker, first.sensor) for each in others)
    assert len({each.cut.cut for each in (first, *others)}) == len(cuts.FAMILIES)


def test_pieces_differ_and_a_harder_one_pushes_as_much_more() -> None:
    one, other = (cut_along("oak", (10e-3, 0.0), piece=piece)["force"] for piece in (1, 2))
    assert np.abs(one - other).max() > 0.1
    harder = cut_along("oak", (10e-3, 0.0), hardness=2.0)["force"]
    np.testing.assert_allclose(harder, 2.0 * one, rtol=1e-9, atol=1e-9)


def test_a_robot_may_be_softer_than_it_is_drawn() -> None:
    compliances = [Robot(seed=3, compliance=each).compliance for each in (1.0, 2.0)]
    assert compliances[1] == pytest.approx(2.0 * compliances[0])


def test_a_draw_is_the_same_wherever_it_is_made() -> None:
    assert checksum(draws()[:50]) == "9cb70491f4430e88"


def test_a_seed_has_the_same_cell_each_time() -> None:
    assert checksum([CELLS.draw(11)]) == checksum([CELLS.draw(11)])
    assert len({checksum([draw]) for draw in draws()}) == len(SEEDS)
    first, again = (cut_along("chatter", (10e-3, 0.0)) for _ in range(2))
    assert all(np.array_equal(first[name], again[name]) for name in first)
