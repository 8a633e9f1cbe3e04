"""Bounds and 95 % intervals of forces from motor torques on drawn robot cells: how wide they are, and what they hold.

    python -m benchmarks.force_intervals [FIRST COUNT] [--write]

Each cell (seeds 6200 to 6205, on which nothing was chosen) is swept, its friction and gravity are fitted, and it mills
a square of 22 mm, 2 mm deep at 10 mm/s, in its own material.  The true force is the mean over a sample, as torques are.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

from benchmarks.force_estimate import CLEAR, CORNERS, DEPTH, FEED, HALF, LEAD, RATE, SLOW, rms, smooth
from benchmarks.page_table import put, table
from calibration.guided_arm import arm_with_tool
from calibration.milling.sweep_session import sweep
from calibration.milling.torque_fit import friction_and_gravity
from ctlblocks import Graph, Port
from ctlblocks.clock import run_offline
from ctlblocks.recording import Recording
from ctlblocks.replay import Record, Replay
from firmware_sim.population.cell_population import CELLS
from rigkit.config import load
from rigkit.experiment.runner import Conduct
from rigkit.named_code import named_block
from rigkit.run_folder import RunFolder
from rigkit.toml_text import value_text
from stagectl.robot.config import CellConfig
from stagectl.robot.kinematics import forward
from stagectl.robot.milling.force_interval import force_intervals
from stagectl.robot.milling.force_model import ForceModel
from stagectl.robot.tool_path import joints_at, ramped

FIRST, COUNT = 6200, 6
LEAST = 1.0
"""N, of the force, from which on the tool is taken to cut."""
SCALES = (0.5, 2.0, 5.0)
"""Of a force sensor, over what there is."""


def drawn(seed: int) -> tuple[CellConfig, str]:
    """Return a drawn cell, and its family."""
    found = CELLS.draw(seed)
    return load(None, CellConfig, [f"{key}={value_text(value)}" for key, value in found.keys.items()]), found.family


def swept(cell: CellConfig) -> ForceModel:
    """Sweep the arm of a cell, and fit what a force model needs."""
    arm = arm_with_tool(cell)
    with tempfile.TemporaryDirectory() as place, RunFolder.create(Path(place) / "raw", "") as folder:
        recorded = sweep(cell, False, folder, lambda _: None, Conduct())
    friction, gravity, fit = friction_and_gravity(recorded, arm, cell.friction)
    return ForceModel(arm, gravity, friction, fit.inertia)


def milled(cell: CellConfig) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mill the square; return angles (rad), torques (N m) and the force's means (N) at 250 samples/s."""
    arm, home = arm_with_tool(cell), np.array(cell.pocket.home)
    place = np.column_stack([HALF * CORNERS, [CLEAR, *[-DEPTH] * 5]])
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(place, axis=0), axis=1))])
    time = np.arange(round((length[-1] / FEED + 2 * LEAD) * RATE / SLOW)) * SLOW / RATE - LEAD
    way = FEED * ramped(time, length[-1] / FEED, 0.3)
    top = forward(arm, home)[:3, 3]
    joints = joints_at(arm, home, top + np.column_stack([np.interp(way, length, place[:, n]) for n in range(3)]))
    names, options = tuple(f"joint_{joint + 1}" for joint in range(6)), cell.simulator.options
    own = {"start": tuple(joints[0].tolist()), "arm": cell.robot.arm, "tool": cell.robot.tool}
    graph = Graph(RATE)
    graph.add("path", Replay(Recording(names, ("rad",) * 6, RATE / SLOW, joints), {"reference": names}), SLOW)
    graph.add("robot", named_block(cell.plants.robot, options | own))
    graph.add("cut", named_block(cell.plants.pocket, cell.plants.pocket_options | {"origin": tuple(top.tolist())}))
    slow = Record([Port("motor_angle", "rad", 6), Port("torque", "N m", 6)], len(joints))
    quick = Record([Port("force", "N", 3)], len(joints) * SLOW)
    graph.add("slow", slow, SLOW)
    graph.add("quick", quick)
    for source, target in (("path.reference", "robot.reference"), ("robot.position", "cut.tool"),
                           ("robot.give", "cut.give"), ("robot.motor_angle", "slow.motor_angle"),
                           ("robot.torque", "slow.torque"), ("cut.force", "quick.force")):  # fmt: skip
        graph.connect(source, target)
    for name in ("force", "moment"):
        graph.connect(f"cut.{name}", f"robot.{name}", delayed=True)
    graph.prepare()
    run_offline(graph, len(joints) * SLOW)
    angle, torque = np.split(np.array(slow.recording().data, float), 2, axis=1)
    sums = np.concatenate([np.zeros((1, 3)), np.cumsum(np.array(quick.recording().data, float), axis=0)])
    ends = np.arange(len(angle)) * SLOW + 1
    return angle, torque, (sums[ends] - sums[np.maximum(ends - SLOW, 0)]) / SLOW


def row(seed: int) -> tuple[list[str], np.ndarray, np.ndarray]:
    """Return a line of the table; widths and coverages of both, (2, 3, 3); and whether scales would be noticed."""
    cell, family = drawn(seed)
    model, (angle, torque, true) = swept(cell), milled(cell)
    found = model.estimate(angle, torque, RATE / SLOW)
    likely = force_intervals(model, found, angle, torque, RATE / SLOW)
    here = (np.linalg.norm(true, axis=1) > LEAST) & np.isfinite(found.force).all(axis=1)
    cells, numbers = [str(seed), family, rms(true[here]), rms(found.force[here] - true[here])], []
    for low, high in ((found.low[here], found.high[here]), (likely.low[here], likely.high[here])):
        width = np.median(high - low, axis=0)
        held, slow = (((low <= each[here]) & (each[here] <= high)).mean(axis=0) for each in (true, smooth(true)))
        cells += [" / ".join(f"{each:.1f}" for each in width)]
        cells += [" / ".join(f"{100 * each:.1f}" for each in parts) for parts in (held, slow)]
        numbers.append([width, held, slow])
    seen = [np.mean(((low > scale * true[here]) | (high < scale * true[here])).any(axis=1)) for scale in SCALES]
    cells.append(" / ".join(f"{100 * each:.0f}" for each in seen))
    return cells, np.array(numbers), np.array(seen) > 0.5


def main() -> None:
    """Print the table of all cells, and their medians and means."""
    given = [int(each) for each in sys.argv[1:] if each.isdigit()]
    first, count = given if len(given) == 2 else (FIRST, COUNT)
    rows, numbers, seen = [], [], []
    for seed in range(first, first + count):
        cells, found, would = row(seed)
        rows.append(cells)
        numbers.append(found)
        seen.append(would)
        print(cells, flush=True)
    every = np.array(numbers)
    last = ["all", "", "", ""]
    for kind in range(2):
        last.append(" / ".join(f"{each:.1f}" for each in np.median(every[:, kind, 0], axis=0)))
        last += [" / ".join(f"{100 * each:.1f}" for each in every[:, kind, which].mean(axis=0)) for which in (1, 2)]
    rows.append([*last, " / ".join(f"{int(each)} of {count}" for each in np.sum(seen, axis=0))])
    head = ["cell", "cut", "force, N rms", "error, N rms", "bounds: width, N", "hold, %", "below 10 Hz, %",
            "95 % interval: width, N", "holds, %", "below 10 Hz, %",
            f"a sensor of scale {' / '.join(f'{each:g}' for each in SCALES)} is outside, %"]  # fmt: skip
    put(table(head, rows), "validation/forces.md", "intervals")


if __name__ == "__main__":
    main()
