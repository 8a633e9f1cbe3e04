"""The simulated robot against what mechanics says of it; its geometry here is written once more."""

import numpy as np
import pytest

from firmware_sim.plants.robot import STIFF_CLAMP, RobotPlant
from firmware_sim.plants.robot_arms import ARMS
from firmware_sim.plants.robot_geometry_kernel import GRAVITY, centres, masses, place, weights, whirls
from firmware_sim.plants.robot_joint_kernel import (
    ACROSS_X,
    ACROSS_Y,
    BACKLASH,
    CELLS,
    COULOMB,
    DRAG,
    LINK,
    MOTOR,
    MOTOR_SPEED,
    STIFF_MINUS,
    STIFF_PLUS,
    VISCOUS,
    WARMTH,
    friction,
    spring,
)
from tests.firmware_sim.robot_runs import held, run


def tool_point(angle: np.ndarray, tilt: np.ndarray, tool: float, arm: str) -> np.ndarray:
    """Return the tool's position by homogeneous matrices, each tilt a rotation about x and y before the joint's."""
    pose = np.eye(4)
    for (offset, d, a, alpha), q, (about_x, about_y) in zip(ARMS[arm].chain, angle, tilt, strict=True):
        turned = turn(0, about_x) @ turn(1, about_y) @ turn(2, np.deg2rad(offset) + q)
        pose = pose @ turned @ moved(a, 0, d) @ turn(0, np.deg2rad(alpha))
    return np.asarray((pose @ moved(0, 0, tool))[:3, 3])


def turn(axis: int, angle: float) -> np.ndarray:
    matrix, (i, j) = np.eye(4), ((1, 2), (2, 0), (0, 1))[axis]
    matrix[i, i] = matrix[j, j] = np.cos(angle)
    matrix[j, i] = np.sin(angle)
    matrix[i, j] = -np.sin(angle)
    return matrix


def moved(x: float, y: float, z: float) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def point_jacobian(angle: np.ndarray, tool: float, arm: str) -> np.ndarray:
    """Return by differences the tool's velocity over x, y and z rotation at each joint, shape (3, 6, 3)."""
    found, small = np.empty((3, 6, 3)), 1e-6
    for joint in range(6):
        for column in range(3):
            ends = []
            for sign in (1, -1):
                q, tilt = angle.copy(), np.zeros((6, 2))
                if column == 2:
                    q[joint] += sign * small
                else:
                    tilt[joint, column] += sign * small
                ends.append(tool_point(q, tilt, tool, arm))
            found[:, joint, column] = (ends[0] - ends[1]) / (2 * small)
    return found


def test_the_irb140_stands_where_its_makers_say() -> None:
    plant = RobotPlant(spread=0.0, tool=0.0, payload=0.0, compliance=0.1, orthogonal=0.0, backlash=0.0)
    plant.place(np.zeros(6))
    np.testing.assert_allclose(plant.frames[7, :, 3], [0.515, 0.0, 0.712], atol=2e-4)
    np.testing.assert_allclose(plant.frames[7, :, 2], [1.0, 0.0, 0.0], atol=1e-3)


@pytest.mark.parametrize("arm", sorted(ARMS))
@pytest.mark.parametrize("direction", range(3))
def test_a_force_moves_the_tool_by_compliance_times_force(arm: str, direction: int) -> None:
    """Within 1 %: the joints' springs and what is soft across them, by a Jacobian of this file's own."""
    plant = RobotPlant(arm=arm, seed=4, backlash=0.0, noise=0.0, orthogonal=5.0)
    plant.brake(True)
    size = 20.0 if arm == "irb140" else 400.0
    before = held(plant, np.zeros(6))
    force = size * np.eye(6)[direction]
    after = held(plant, force)
    levers = point_jacobian(before[2][-1], plant.tool, arm)
    sideways = 1 / plant.joints[STIFF_PLUS], 1 / plant.joints[STIFF_MINUS]
    wind_up = (before[0] - before[2] + after[0] - after[2])[-1]
    soft = np.stack([*plant.joints[[ACROSS_X, ACROSS_Y]], np.where(wind_up > 0, *sideways)], axis=1)
    expected = np.einsum("rjc,jc,sjc,s->r", levers, soft, levers, force[:3])
    np.testing.assert_allclose((after[3] - before[3])[-1, :3], expected, atol=0.01 * np.linalg.norm(expected))
    reported = plant.tool_compliance()[:3] @ force
    np.testing.assert_allclose(reported, expected, atol=0.01 * np.linalg.norm(expected))


def test_a_link_is_loose_by_its_backlash_where_nothing_loads_it() -> None:
    plant = RobotPlant(seed=2, noise=0.0)
    plant.brake(True)
    width = plant.joints[BACKLASH, 0]
    angles = []
    for sign in (1.0, -1.0):
        link = held(plant, sign * np.array([0, 0.01, 0, 0, 0, 0]), 20.0)[2][-1, 0]
        lever = plant.frames[7, 0, 3]
        angles.append(link - sign * 0.01 * lever / plant.joints[STIFF_PLUS, 0])
    assert angles[0] - angles[1] == pytest.approx(width, rel=0.01)


@pytest.mark.parametrize("arm", sorted(ARMS))
def test_the_lowest_mode_is_between_10_and_30_hertz(arm: str) -> None:
    """Over arms and over postures: motors held, gears engaged."""
    rng = np.random.default_rng(1)
    for seed in range(20):
        plant = RobotPlant(arm=arm, seed=seed, backlash=0.0)
        plant.place(plant.home + rng.uniform(-0.35, 0.35, 6))
        plant.brake(True)
        held(plant, np.array([0.0, 10.0, 0.0, 1.0, 1.0, 1.0]), 0.02)
        assert 10.0 < plant.natural_frequencies()[0] < 30.0


def test_a_blow_rings_at_a_natural_frequency() -> None:
    plant = RobotPlant(spread=0.0, backlash=0.0, noise=0.0, rate=1_000.0)
    plant.brake(True)
    wrench = np.zeros((4_000, 6))
    wrench[10:12, 1] = 500.0
    link = run(plant, np.tile(plant.home, (4_000, 1)), wrench)[2][20:, 0]
    lines = np.abs(np.fft.rfft((link - link.mean()) * np.hanning(len(link)), 2**16))
    rung = np.argmax(lines) * 1_000.0 / 2**16
    assert np.abs(plant.natural_frequencies() / rung - 1).min() < 0.02


def test_an_arm_that_is_left_alone_loses_energy() -> None:
    """Motion, gears and height together, motors held, in a swing of centimetres: never more, in the end much less."""
    plant = RobotPlant(seed=5, noise=0.0, compliance=3.0)
    plant.brake(True)
    wrench = np.zeros((1, 6))
    wrench[0, :3] = 30.0, 200.0, -100.0
    for _ in range(20):
        run(plant, plant.home[None], wrench)
    totals = []
    for _ in range(500):
        run(plant, plant.home[None])
        totals.append(total_energy(plant))
    rises = np.diff(totals) / (totals[0] - totals[-1])
    assert rises.max() < 2e-3
    assert totals[0] - totals[-1] > 0.5


def total_energy(plant: RobotPlant) -> float:
    frames, centre, links = np.zeros((8, 3, 4)), np.zeros((7, 3)), plant.links
    link, motor = plant.state[2], plant.state[0]
    place(link, np.zeros((6, 2)), links, plant.tool, frames)
    centres(frames, links, centre)
    height = GRAVITY * links[:, 7] @ centre[:, 2]
    stored = 0.0
    for joint in range(6):
        torque, slope = spring(joint, motor[joint] - link[joint], plant.joints)
        stored += torque**2 / (2 * slope) if slope else 0.0
    return float(plant.energy() + height + stored)


def test_friction_takes_energy_over_any_cycle() -> None:
    plant = RobotPlant(seed=1)
    joints, state, step = plant.joints, np.zeros((CELLS, 6)), 1e-4
    time = np.arange(20_000) * step
    for frequency, size in ((1.0, 1e-5), (1.0, 1e-2), (7.0, 1e-3)):
        speed = size * 2 * np.pi * frequency * np.cos(2 * np.pi * frequency * time)
        work = 0.0
        for value in speed:
            state[1, 0] = value
            work += friction(0, step, 0.0, joints, state)[0] * value * step
        assert work > 0.0


def sliding(
    plant: RobotPlant, speed: float, load: float, warmth: float = 0.0, seconds: float = 0.5
) -> tuple[float, float]:
    """Return joint 1's friction, N m, after it has slid for so long at a speed, rad/s, and its warmth then."""
    state, step, torque = np.zeros((CELLS, 6)), 1e-3, 0.0
    state[MOTOR_SPEED, 0], state[WARMTH, 0] = speed, warmth
    for _ in range(round(seconds / step)):
        torque = friction(0, step, load, plant.joints, state)[0]
    return float(torque), float(state[WARMTH, 0])


def test_sliding_friction_is_stribecks_and_grows_with_load() -> None:
    plant = RobotPlant(stiction=1.6, stribeck=0.05, load_friction=0.03)
    coulomb, viscous = plant.joints[COULOMB, 0], plant.joints[VISCOUS, 0]
    for speed, load in ((0.01, 0.0), (0.05, -80.0), (1.0, 200.0)):
        level = coulomb * (1 + 0.6 * np.exp(-((speed / 0.05) ** 2))) * (1 + 0.03 * abs(load) / coulomb)
        assert sliding(plant, speed, load)[0] == pytest.approx(level + viscous * speed, rel=1e-3)


def test_friction_warms_a_joint_and_a_warm_one_turns_more_easily() -> None:
    plant = RobotPlant(cold=1.5, heating=0.5, cooling=600.0)
    coulomb, viscous = plant.joints[COULOMB, 0], plant.joints[VISCOUS, 0]
    for warmth in (0.0, 2.0):
        expected = coulomb + viscous * (1 + 1.5 * np.exp(-warmth))
        assert sliding(plant, 1.0, 0.0, warmth)[0] == pytest.approx(expected, rel=1e-2)
    torque, warmed = sliding(plant, 1.0, 0.0, 1.0, 2.0)
    assert warmed - 1.0 == pytest.approx(2.0 * (0.5e-3 * torque - 1.0 / 600.0), rel=1e-2)
    assert RobotPlant(warmth=3.0).state[WARMTH].tolist() == [3.0] * 6


def geometry(plant: RobotPlant, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    frames, centre = np.zeros((8, 3, 4)), np.zeros((7, 3))
    place(angle, np.zeros((6, 2)), plant.links, plant.tool, frames)
    centres(frames, plant.links, centre)
    return frames, centre


def test_gravity_is_the_slope_of_height_and_coriolis_follows_from_the_mass_matrix() -> None:
    plant, rng, small = RobotPlant(seed=7), np.random.default_rng(2), 1e-5
    angle, speed = plant.home + rng.uniform(-0.5, 0.5, 6), rng.uniform(-1, 1, 6)

    def mass_at(q: np.ndarray) -> np.ndarray:
        mass = np.zeros((6, 6))
        masses(*geometry(plant, q), plant.links, mass)
        return mass

    def height_at(q: np.ndarray) -> float:
        return float(GRAVITY * plant.links[:, 7] @ geometry(plant, q)[1][:, 2])

    steps = small * np.eye(6)
    slopes = np.array([(mass_at(angle + s) - mass_at(angle - s)) / (2 * small) for s in steps])
    weight, whirl = np.zeros((6, 3)), np.zeros(6)
    weights(*geometry(plant, angle), plant.links, weight)
    whirls(*geometry(plant, angle), plant.links, speed, whirl)
    falls = [-(height_at(angle + s) - height_at(angle - s)) / (2 * small) for s in steps]
    np.testing.assert_allclose(weight[:, 2], falls, atol=1e-5)
    turning = np.einsum("kij,k,j->i", slopes, speed, speed) - 0.5 * np.einsum("kij,i,j->k", slopes, speed, speed)
    np.testing.assert_allclose(whirl, turning, atol=1e-6)
    assert np.linalg.eigvalsh(mass_at(angle)).min() > 0


def test_frames_do_not_matter_and_seeds_do() -> None:
    reference = RobotPlant().home + 0.01 * np.random.default_rng(1).standard_normal((64, 6)).cumsum(0) / 8
    whole = run(RobotPlant(seed=3), reference)
    plant = RobotPlant(seed=3)
    parts = [run(plant, reference[start : start + 16]) for start in range(0, 64, 16)]
    for one, pieces in zip(whole, zip(*parts, strict=True), strict=True):
        assert one.tobytes() == np.concatenate(pieces).tobytes()
    assert run(RobotPlant(seed=4), reference)[0].tobytes() != whole[0].tobytes()


def test_what_cannot_be_is_refused_by_name() -> None:
    with pytest.raises(ValueError, match=r"simulator.options.arm is 'puma', must be 'irb140' or 'kuka'"):
        RobotPlant(arm="puma")
    with pytest.raises(ValueError, match=r"rate is 300.0 samples/s, must be 50 to 8000"):
        RobotPlant(rate=300.0)
    plant = RobotPlant()
    with pytest.raises(ValueError, match="softness"):
        plant.soften(np.full(6, np.nan))
    with pytest.raises(ValueError, match="compliance"):
        plant.clamp(-STIFF_CLAMP)


@pytest.mark.parametrize("share", [0.0, 0.4])
def test_a_link_with_friction_of_its_own_is_dragged_behind_by_the_backlash_and_what_that_winds_up(share: float) -> None:
    """To and fro at one speed along joint 1, which carries no weight: from turning to turning, in motion."""
    plant = RobotPlant(seed=4, backlash=3.0, noise=0.0, link_friction=share)
    at = np.arange(round(6.0 * plant.rate)) / plant.rate
    reference = np.tile(plant.home, (len(at), 1))
    reference[:, 0] += 0.03 * (1.0 - np.abs(at % 4.0 / 2.0 - 1.0))
    ahead = np.empty(len(at))
    for n, each in enumerate(reference):
        run(plant, each[None, :])
        ahead[n] = plant.state[MOTOR, 0] - plant.state[LINK, 0]
    forth, back = ahead[(at > 5.0) & (at < 5.8)], ahead[(at > 3.0) & (at < 3.8)]
    joint = plant.joints[:, 0]
    wound = joint[DRAG] / joint[STIFF_PLUS] + joint[DRAG] / joint[STIFF_MINUS]
    assert (joint[DRAG] > 0.0) == (share > 0.0)
    if share:
        assert forth.mean() - back.mean() == pytest.approx(joint[BACKLASH] + wound, rel=0.02)
        assert max(np.ptp(forth), np.ptp(back)) < 0.05 * joint[BACKLASH]
    else:
        assert np.ptp(np.concatenate([forth, back])) > 0.5 * joint[BACKLASH]  # it swings within, held by nothing


def test_friction_of_the_link_is_taken_from_that_of_the_motor() -> None:
    whole, parted = (RobotPlant(seed=4, link_friction=share).joints for share in (0.0, 0.3))
    np.testing.assert_allclose(parted[DRAG] + parted[COULOMB], whole[COULOMB])
    np.testing.assert_allclose(parted[DRAG], 0.3 * whole[COULOMB])
