"""The robot's controller over a block: what its commands mill, and what it feels of that."""

import numpy as np
import pytest

from firmware_sim.robot_cell import cell_controller, cell_cut
from firmware_sim.robot_controller import RobotController
from firmware_sim.robot_inverse import rigid_pose, toward
from stagectl.robot.config import CellConfig, Simulator
from stagectl.robot.toroid_config import Plants
from stagectl.wire.egm import pack_command
from stagectl.wire.robot import Command

QUIET = {"noise": 0.0, "seed": 2}
FEED, PERIOD = 10e-3, 0.004
START = np.array([-30e-3, 0.0, 5e-3])
"""m, beside the block, from the middle of its top."""


def cell(**options: object) -> CellConfig:
    return CellConfig(simulator=Simulator(options=QUIET), plants=Plants(pocket_options={"spread": 0.0, **options}))


def follow(controller: RobotController, config: CellConfig, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Send points (m, from the middle of the block's top), and return tips and wrenches."""
    home = np.array(config.pocket.home)
    over = rigid_pose(controller.plant, home)
    angle, tips, wrenches = home, [], []
    for n, point in enumerate(points):
        angle = toward(controller.plant, angle, np.concatenate([over[:3] + point, over[3:]]))
        controller.receive(pack_command(Command(1_000 + n, n * PERIOD, joint_angle=angle)))
        controller.advance()
        tips.append(controller.pose[0, :3] - over[:3])
        wrenches.append(controller.wrench[0].copy())
    return np.array(tips), np.array(wrenches)


def to_the_start(controller: RobotController, config: CellConfig) -> None:
    """Move there from home, joint by joint as one, slowly enough for guided motion."""
    home = np.array(config.pocket.home)
    over = rigid_pose(controller.plant, home)
    goal = toward(controller.plant, home, np.concatenate([over[:3] + START, over[3:]]))
    for n in range(400):
        share = min(1.0, n / 350)
        wanted = controller.plant.home + share * (goal - controller.plant.home)
        controller.receive(pack_command(Command(n, n * PERIOD, joint_angle=wanted)))
        controller.advance()


def slot() -> np.ndarray:
    down = np.linspace(START, [START[0], 0.0, -2e-3], 350)
    way = np.arange(1, round(15e-3 / FEED / PERIOD)) * FEED * PERIOD
    along = np.column_stack([START[0] + way, np.zeros_like(way), np.full_like(way, -2e-3)])
    return np.vstack([down, along])


def test_a_slot_pushes_the_tool_and_bends_the_arm() -> None:
    config = cell()
    milling, flying = cell_controller(config, cell_cut), cell_controller(config)
    for each in (milling, flying):
        to_the_start(each, config)
    (tips, wrenches), (free, nothing) = (follow(each, config, slot()) for each in (milling, flying))
    assert np.abs(nothing).max() == 0.0
    assert np.abs(wrenches[:350]).max() == 0.0
    np.testing.assert_allclose(tips[:350], free[:350], atol=2e-6)  # eight steps a cycle, or one
    force = wrenches[-60:, :3].mean(axis=0)
    np.testing.assert_allclose(force, [-36.2, 45.7, -5.3], rtol=0.08, atol=1.0)  # Altintas' slot
    bent = (tips - free)[-60:].mean(axis=0)
    assert 5e-6 < bent[1] / force[1] < 20e-6
    assert bent[0] < -5e-6 * 30


def test_a_wrong_option_of_the_block_is_refused_by_name() -> None:
    with pytest.raises(ValueError, match="plants.pocket_options.teeth is 0, must be a whole number 1 to 8"):
        cell_cut(cell(teeth=0))
    with pytest.raises(ValueError, match="plants.pocket_options: .*blades"):
        cell_cut(cell(blades=3))


def test_the_program_puts_another_block_under_the_tool_or_none() -> None:
    config = cell()
    controller = cell_controller(config, cell_cut)
    to_the_start(controller, config)
    follow(controller, config, slot())
    assert np.abs(controller.wrench).max() > 10.0
    assert controller.do("BLOCK 0") == "OK"
    controller.advance()
    assert np.abs(controller.wrench).max() == 0.0
    assert controller.do("BLOCK 1") == "OK"
    controller.advance()
    assert controller.do("BLOCK 2").startswith("ERROR 'BLOCK 2' is none of SOFT, CLAMP, BLOCK, RESET")
    assert cell_controller(config).do("BLOCK 1") == "ERROR there is no changer for blocks"


def test_an_arm_that_tilts_by_more_than_3_um_a_newton_mills_without_shaking() -> None:
    """Guards the exchange: arms 3 and 8 shook sample by sample, with peaks of kilonewtons."""
    config = cell()
    config.simulator.options["seed"] = 8
    milling = cell_controller(config, cell_cut)
    to_the_start(milling, config)
    force = follow(milling, config, slot())[1][-200:, :3]
    assert np.abs(force).max() < 100.0
    assert np.abs(np.diff(force, axis=0)).max() < 5.0
