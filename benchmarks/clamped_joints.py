"""Joints of 20 simulated arms found in a stiff clamp and in a soft one, by what `calibrate joints` does.

    python -m benchmarks.clamped_joints [--arms 20] [--poses]

Each arm (its seed counts from 1) shows joint (seed mod 6) + 1 in either clamp, 3 cycles, the whole procedure each time.
`--poses`: one arm, every joint in six poses, and the compliances across the joints from all of them.
"""

import argparse
import tempfile
from pathlib import Path

import numpy as np

from calibration.guided_arm import arm_with_tool
from calibration.joint_clamping import advice_table
from calibration.joint_clamping.full_stiffness import as_told
from calibration.joint_clamping.results import WAYS, Clamped, of_recording
from calibration.joint_clamping.session import Desk, measure, simulated_robot
from calibration.joint_clamping.several_poses import experiment, whole_arm
from rigkit.config import load
from rigkit.run_folder import RunFolder
from stagectl.robot.config import CellConfig
from stagectl.wire.robot import RATE

K_PLUS, K_MINUS, BACKLASH = range(3)
"""Rows of the simulated arm's truth."""
ACROSS = (16, 17)
STIFF = ("simulator.clamp=2e-10", "simulator.clamp_turn=2e-9", "simulator.options.orthogonal=0.0")
"""A hundredth of a bolted plate, and rigid bearings."""
SOFT = (
    "simulator.clamp=6e-7",
    "simulator.clamp_turn=6e-6",
    "clamping.compliance=6e-7",
    "clamping.compliance_turn=6e-6",
)
"""30 bolted plates, known, and bearings that give way."""

ROOMY = ("clamping.travel=[0.1, 0.1, 0.1, 0.1, 0.1, 0.1]",)
"""Poses far from the middle of the arm's reach let other motors yield far; the clamp is a bolted plate."""


def truth(cell: CellConfig) -> np.ndarray:
    """Return the simulated arm's own joints, rows as in `robot_joint_kernel`."""
    robot = simulated_robot(cell)
    robot.prepare(RATE, 1)
    return robot.plant.joints  # type: ignore[attr-defined,no-any-return]


def one_arm(seed: int, clamp: tuple[str, ...]) -> list[tuple[str, float, float, float]]:
    """Return by way: errors of both stiffnesses (1) and of the backlash (rad)."""
    joint = seed % 6
    cell = load(None, CellConfig, [f"simulator.options.seed={seed}", "clamping.cycles=3", *clamp])
    with tempfile.TemporaryDirectory() as place, RunFolder.create(Path(place) / "raw", "") as folder:
        recorded, way = measure(cell, (joint,), folder, Desk(lambda _: None))
    clamped = Clamped(arm_with_tool(cell), np.radians(cell.clamping.pose), cell.clamping.environment)
    result, real = of_recording(recorded[joint], way, joint, clamped), truth(cell)[:, joint]
    return [
        (
            way,
            model.k_plus.value / real[K_PLUS] - 1,
            model.k_minus.value / real[K_MINUS] - 1,
            model.backlash.value - real[BACKLASH],
        )
        for way, model in result.models.items()
    ]


def all_arms(arms: int) -> None:
    """Print a row for each clamp and way: worst and median of all stiffnesses, worst backlash."""
    for name, clamp in (("stiff", STIFF), ("soft", SOFT)):
        found: dict[str, list[tuple[float, float, float]]] = {way: [] for way in WAYS}
        for seed in range(1, arms + 1):
            for way, plus, minus, play in one_arm(seed, clamp):
                found[way].append((plus, minus, play))
                print(f"{name:6} {seed:3d} joint {seed % 6 + 1} {way:26} {100 * plus:7.2f} % {100 * minus:7.2f} % "
                      f"{1e3 * play:8.4f} mrad", flush=True)  # fmt: skip
        for way, rows in found.items():
            if rows:
                table = np.array(rows)
                stiff, play = table[:, :2].ravel(), table[:, 2]
                worst = stiff[np.abs(stiff).argmax()]
                print(f"{name:6} ALL {way:26} worst {100 * worst:7.2f} %, median {100 * np.median(stiff):7.2f} %, "
                      f"backlash {1e3 * np.abs(play).max():.4f} mrad", flush=True)  # fmt: skip


def several_poses(seed: int, count: int) -> None:
    """Print the compliances of one arm, found from all joints in several poses, over the true ones."""
    cell = load(None, CellConfig, [f"simulator.options.seed={seed}", "clamping.cycles=2", *ROOMY])
    arm, experiments = arm_with_tool(cell), []
    advised = advice_table.advice(cell, arm, range(arm.joints))
    poses = [np.degrees(each.pose) for each in advised[:: max(1, len(advised) // count)]][:count]
    for pose in poses:
        clamping = cell.clamping.model_copy(update={"pose": tuple(map(float, pose))})
        there = cell.model_copy(update={"clamping": clamping})
        with tempfile.TemporaryDirectory() as place, RunFolder.create(Path(place) / "raw", "") as folder:
            recorded, way = measure(there, range(6), folder, Desk(lambda _: None))
        clamped = Clamped(arm, np.radians(pose), cell.clamping.environment)
        for joint in range(6):
            result = of_recording(recorded[joint], way, joint, clamped)
            experiments.append(experiment(recorded[joint], result, clamped))
        print(f"pose {pose.round(0)} measured", flush=True)
    whole, real = whole_arm(arm, experiments), truth(cell)
    if isinstance(whole, str):
        print(whole)
        return
    own = 0.5 / real[K_PLUS] + 0.5 / real[K_MINUS]
    expected = as_told(arm, np.concatenate([own, real[list(ACROSS)].T.ravel()]))
    for joint in range(6):
        across = [
            "not told" if each is None else f"{each.value / each_true:.3f} +- {each.reach * each.error / each_true:.3f}"
            for each, each_true in zip(whole.tilting[joint], expected[6 + 2 * joint : 8 + 2 * joint], strict=True)
        ]
        print(
            f"joint {joint + 1}: found over true, own {whole.own[joint].value / expected[joint]:.3f}, across {across}"
        )
    print(f"misfit {100 * whole.misfit:.2f} %")


def main() -> None:
    """Read what is wanted, and measure it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--arms", type=int, default=20)
    parser.add_argument("--poses", action="store_true")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=6)
    chosen = parser.parse_args()
    if chosen.poses:
        several_poses(chosen.seed, chosen.count)
    else:
        all_arms(chosen.arms)


if __name__ == "__main__":
    main()
