"""The thesis' pocket milled by a robot that nothing corrects: how far the cut bends it, and the forces.

    python -m benchmarks.milling_pocket [--robots 5] [--png docs/images/milling] [--write]

The same path in the air is taken off: what is left is what the cut does.  Mean over robots and blocks of seeds 1 on.
"""

import argparse
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from benchmarks.page_table import FLAG, put, table
from ctlblocks import Graph
from ctlblocks.block import Port
from ctlblocks.recording import Recording
from ctlblocks.replay import Record, Replay
from firmware_sim.guided_robot import GuidedRobot
from firmware_sim.milling_blocks import PocketCut
from firmware_sim.plants.cutting_force import MATERIALS
from rigkit.figure_style import COLOURS, styled
from stagectl.robot.config import CellConfig
from stagectl.robot.kinematics import forward
from stagectl.robot.pocket_config import Pocket
from stagectl.robot.port import arm_of
from stagectl.robot.tool_path import joints_at, ramped

RATE, EVERY = 2_000.0, 8
ROUNDS, SLOPE, LEAD, RAMP, AIR = (3e-3, 7e-3, 11e-3), 0.03, 0.5, 0.3, 1e-3
"""m, half sides; 1; s; s; m over the surface."""


def path(depth: float) -> np.ndarray:
    """Return where the tip is wanted at 250 samples/s, shape (N, 3), m: down a gentle ramp, and outwards."""
    square = np.array([(0, -1), (1, -1), (1, 1), (-1, 1), (-1, -1), (0, -1)], float)
    drop = AIR + depth
    times = int(np.ceil(drop / (SLOPE * 8 * ROUNDS[0])))
    corners = [np.vstack([ROUNDS[0] * square] * times), *(half * square for half in ROUNDS)]
    flat = np.vstack(corners)
    gone = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(flat, axis=0), axis=1))])
    high = np.maximum(AIR - SLOPE * gone, -depth)
    corner = np.column_stack([flat, high])
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(corner, axis=0), axis=1))])
    feed, seconds = Pocket().feed, float(way[-1]) / Pocket().feed
    time = np.arange(round((LEAD + seconds + RAMP + LEAD) * RATE / EVERY)) * EVERY / RATE
    gone = feed * ramped(time - LEAD, seconds, RAMP)
    return np.stack([np.interp(gone, way, each) for each in corner.T], axis=-1)


def run(cut: PocketCut, seed: int, wanted: np.ndarray) -> np.ndarray:
    """Run the path once: tip (m), force and force with teeth (N), shape (samples, 9)."""
    cell, home = CellConfig(), np.array(Pocket().home)
    arm = arm_of(cell).with_tool(cell.robot.tool)
    origin = forward(arm, home)[:3, 3]
    cut.origin = tuple(origin.tolist())
    angle = joints_at(arm, home, origin + wanted)
    names = tuple(f"joint_{n}" for n in range(1, 7))
    graph = Graph(RATE)
    graph.add("path", Replay(Recording(names, ("rad",) * 6, RATE / EVERY, angle), {"nominal": names}), EVERY)
    graph.add("robot", GuidedRobot(seed=seed, tool=cell.robot.tool, start=tuple(angle[0].tolist())))
    graph.add("cut", cut)
    record = Record((Port("tip", "m", 3), Port("force", "N", 3), Port("teeth", "N", 3)), len(angle) * EVERY)
    graph.add("record", record)
    graph.connect("path.nominal", "robot.reference")
    graph.connect("robot.position", "cut.tool")
    graph.connect("robot.give", "cut.give")
    for name in ("force", "moment"):
        graph.connect(f"cut.{name}", f"robot.{name}", delayed=True)
    for source, name in (("robot.position", "tip"), ("cut.force", "force"), ("cut.teeth_force", "teeth")):
        graph.connect(source, f"record.{name}")
    graph.prepare()
    for _ in range(len(angle) * EVERY):
        graph.tick()
    return record.recording().data


def air() -> PocketCut:
    """Return a block that is hardly there."""
    return PocketCut(length=1e-3, width=1e-3, thickness=1e-4, layer=1e-4)


def draw(depth: float, bent: np.ndarray, free: np.ndarray, cut: PocketCut, folder: Path) -> None:
    """Draw forces over time, the wall that is milled beside the nominal one, and the deflection of the tool."""
    folder.mkdir(parents=True, exist_ok=True)
    figure = Figure(figsize=(8.0, 6.4))
    top, left, right = figure.subplot_mosaic([["force", "force"], ["wall", "bend"]], height_ratios=(1, 1.3)).values()
    time = np.arange(len(bent)) / RATE
    for axis, name in enumerate("xyz"):
        top.plot(time, bent[:, 6 + axis], color=COLOURS[axis], linewidth=0.3, alpha=0.35)
        top.plot(time, bent[:, 3 + axis], color=COLOURS[axis], label=name)
    top.set(
        xlabel="time, s", ylabel="force on the tool, N", title=f"{1e3 * depth:g} mm deep; faint: force of each tooth"
    )
    top.legend(ncols=3)
    x, y, distance = cut.plant.section(0.5 * depth)
    left.contour(1e3 * x, 1e3 * y, distance, levels=[0.0], colors=COLOURS[0], linewidths=1.3)
    left.plot([-14, 14, 14, -14, -14], [-14, -14, 14, 14, -14], "k--", linewidth=0.8)
    left.set(
        aspect="equal",
        xlim=(-16, 16),
        ylim=(-16, 16),
        xlabel="x, mm",
        ylabel="y, mm",
        title="Milled wall (nominal 28 mm)",
    )
    bend = 1e6 * (bent - free)[:, :3]
    for axis, name in enumerate("xyz"):
        right.plot(time, bend[:, axis], color=COLOURS[axis], label=name)
    right.set(xlabel="time, s", ylabel="deflection of the tool, µm", title="Error beside the same path in air")
    right.legend(loc="lower left")
    figure.savefig(folder / "pocket.png", dpi=110)


def main() -> None:
    """Measure, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--robots", type=int, default=5)
    parser.add_argument("--png", type=Path)
    parser.add_argument(FLAG, action="store_true")
    chosen = parser.parse_args()
    rows = []
    for depth in (2e-3, 4e-3):
        wanted = path(depth)
        cutting = np.repeat(wanted[:, 2] < 0.0, EVERY)
        free = {seed: run(air(), seed, wanted) for seed in range(1, chosen.robots + 1)}
        for material in MATERIALS:
            found = []
            for seed, flown in free.items():
                cut = PocketCut(material=material, seed=seed)
                bent = run(cut, seed, wanted)
                if chosen.png and (material, depth, seed) == ("al7075", 2e-3, 1):
                    with styled():
                        draw(depth, bent, flown, cut, chosen.png)
                error = np.abs(bent - flown)[cutting, :3].mean(axis=0)
                found.append([*error, np.linalg.norm(error), np.linalg.norm(bent[cutting, 3:6], axis=1).mean()])
            *errors, force = np.mean(found, axis=0)
            each = [f"{1e6 * error:.0f}" for error in errors]
            spread = f"{1e6 * min(row[3] for row in found):.0f} to {1e6 * max(row[3] for row in found):.0f}"
            rows.append((f"`{material}`", f"{1e3 * depth:g}", *each, spread, f"{force:.0f}"))
    put(
        table(("material", "deep, mm", "x", "y", "z", "norm, µm", "of the robots", "force, N"), rows),
        "milling.md",
        "milling-pocket",
    )


if __name__ == "__main__":
    main()
