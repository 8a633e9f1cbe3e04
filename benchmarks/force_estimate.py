"""Forces from motor torques: how near they come on simulated arms that mill, what a sample costs beside a QP solver.

    python -m benchmarks.force_estimate speed [--write]
    python -m benchmarks.force_estimate arms [--write]
    python -m benchmarks.force_estimate picture

`arms`: each of ten arms (seeds 1 to 10) is swept, its friction and gravity are fitted, and it mills a square of 22 mm,
2 mm deep at 10 mm/s, into aluminium; forces are estimated from angles and torques alone, and compared with those of
the cut, averaged over a turn of the tool.  Bounds are those of the default margin; beside them stands the box of the
forces that are as likely, which has none.
"""

import tempfile
from dataclasses import replace
from pathlib import Path
from time import thread_time

import daqp
import numpy as np
from scipy.signal import butter, sosfiltfilt

from benchmarks.page_table import DOCS, put, table, words
from calibration.guided_arm import arm_with_tool
from calibration.milling.sweep_session import sweep
from calibration.milling.torque_fit import friction_and_gravity
from ctlblocks import Graph, Port
from ctlblocks.clock import run_offline
from ctlblocks.recording import Recording
from ctlblocks.replay import Record, Replay
from firmware_sim.guided_robot import GuidedRobot
from firmware_sim.milling_blocks import PocketCut
from rigkit.config import load
from rigkit.experiment.runner import Conduct
from rigkit.run_folder import RunFolder
from stagectl.robot.config import CellConfig
from stagectl.robot.kinematics import forward
from stagectl.robot.learning_config import Margin
from stagectl.robot.milling.force_estimate import TIE_BREAKS, ForceEstimates, estimate_force
from stagectl.robot.milling.force_margin import packed_margin
from stagectl.robot.milling.force_model import ForceEstimate, ForceModel
from stagectl.robot.milling.force_plot import force_plot
from stagectl.robot.tool_path import joints_at, ramped
from tests.stagectl.robot.milling.force_cases import Cases, random_cases
from tests.stagectl.robot.milling.torque_models import ARM, wide_model

PICTURE = DOCS / "images" / "force-estimate" / "square.png"
ARMS = range(1, 11)
"""Seeds; the margin was chosen on the first five."""
RATE, SLOW = 2_000.0, 8
"""Samples/s of the plants; ticks between two samples of the robot."""
HALF, DEPTH, CLEAR, FEED, LEAD = 11e-3, 2e-3, 1e-3, 10e-3, 2.0
CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1], [1, -1]])
CUTOFF = 10.0
"""Hz, of the low-pass that learning looks through."""
CASES = 4_000
NO_MARGIN = Margin(noise=0.0, moment=0.0, inertia=0.0)


def milled(cell: CellConfig, seed: int, noise: float) -> dict[str, np.ndarray]:
    """Mill the square; return `motor_angle` (rad), `torque` (N m) and `force` (N) at 250 samples/s."""
    arm, home = arm_with_tool(cell), np.array(cell.pocket.home)
    place = np.column_stack([HALF * CORNERS, [CLEAR, *[-DEPTH] * 5]])
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(place, axis=0), axis=1))])
    seconds = length[-1] / FEED
    time = np.arange(round((seconds + 2 * LEAD) * RATE / SLOW)) * SLOW / RATE - LEAD
    way = FEED * ramped(time, seconds, 0.3)
    wanted = np.column_stack([np.interp(way, length, place[:, axis]) for axis in range(3)])
    top = forward(arm, home)[:3, 3]
    joints = joints_at(arm, home, top + wanted)
    names = tuple(f"joint_{joint + 1}" for joint in range(6))
    graph = Graph(RATE)
    graph.add("path", Replay(Recording(names, ("rad",) * 6, RATE / SLOW, joints), {"reference": names}), SLOW)
    graph.add("robot", GuidedRobot(seed=seed, start=tuple(joints[0]), noise=noise, tool=cell.robot.tool))
    graph.add("cut", PocketCut(seed=seed, origin=tuple(top)))
    kept = Record([Port("motor_angle", "rad", 6), Port("torque", "N m", 6), Port("force", "N", 3)], len(joints))
    graph.add("kept", kept, SLOW)
    graph.connect("path.reference", "robot.reference")
    graph.connect("robot.position", "cut.tool")
    graph.connect("robot.give", "cut.give")
    for name in ("force", "moment"):
        graph.connect(f"cut.{name}", f"robot.{name}", delayed=True)
    for name, source in (("motor_angle", "robot"), ("torque", "robot"), ("force", "cut")):
        graph.connect(f"{source}.{name}", f"kept.{name}")
    graph.prepare()
    run_offline(graph, len(joints) * SLOW)
    angle, torque, force = np.split(np.array(kept.recording().data, float), [6, 12], axis=1)
    return {"motor_angle": angle, "torque": torque, "force": force}


def swept(cell: CellConfig) -> ForceModel:
    """Sweep the simulated arm, and fit what a force model needs."""
    arm = arm_with_tool(cell)
    with tempfile.TemporaryDirectory() as place, RunFolder.create(Path(place) / "raw", "") as folder:
        recorded = sweep(cell, False, folder, lambda _: None, Conduct())
    friction, gravity, fit = friction_and_gravity(recorded, arm, cell.friction)
    print(f"fit on held-back motions {fit.fit.round(3)}, friction in its range {fit.inside.round(3)}", flush=True)
    print(f"inertia {fit.inertia.round(3)} kg m^2", flush=True)
    return ForceModel(arm, gravity, friction, fit.inertia)


def smooth(force: np.ndarray) -> np.ndarray:
    """Return forces as learning sees them: below 10 Hz, without phase."""
    return np.asarray(sosfiltfilt(butter(2, CUTOFF, fs=RATE / SLOW, output="sos"), force, axis=0))


def rms(signal: np.ndarray) -> str:
    return " / ".join(f"{each:.1f}" for each in np.sqrt(np.mean(signal**2, axis=0)))


def row(seed: int, noise: float, name: str, model: ForceModel, seen: dict[str, np.ndarray]) -> list[str]:
    """Return a line of the table: cutting only."""
    given, true = (seen["motor_angle"], seen["torque"], RATE / SLOW), seen["force"]
    found, likely = model.estimate(*given), replace(model, margin=NO_MARGIN).estimate(*given)
    cuts = np.linalg.norm(true, axis=1) > 1.0
    told = np.isfinite(found.force).all(axis=1)
    here = cuts & told
    untold = 100 * (cuts & ~told).sum() / cuts.sum()
    off = np.where(told[:, None], found.force - true, 0.0)
    return [
        str(seed), f"{noise:g}", name, rms(true[here]), rms(off[here]), rms(smooth(off)[here]),
        *hold(likely, true, here), *hold(found, true, here), hold(found, smooth(true), here)[1], f"{untold:.1f}",
    ]  # fmt: skip


def hold(found: ForceEstimates, true: np.ndarray, here: np.ndarray) -> tuple[str, str]:
    """Return the median width of a box (N), and in which part of the samples it holds the true force (%)."""
    inside = ((found.low <= true) & (true <= found.high)).all(axis=1)[here].mean()
    return " / ".join(
        f"{each:.1f}" for each in np.median((found.high - found.low)[here], axis=0)
    ), f"{100 * inside:.1f}"


def arms() -> None:
    """Print a row an arm and tie-break; the first arm without noise, too."""
    rows = []
    for seed, noise in [(1, 0.0), *((seed, 1.0) for seed in ARMS)]:
        cell = load(None, CellConfig, [f"simulator.options.seed={seed}", f"simulator.options.noise={noise}"])
        model, seen = swept(cell), milled(cell, seed, noise)
        for name in TIE_BREAKS:
            rows.append(row(seed, noise, name, replace(model, tie_break=name), seen))
            print(rows[-1], flush=True)
    head = [
        "arm", "noise", "tie-break", "force, N rms", "error, N rms", "below 10 Hz", "width as likely, N", "holds, %",
        "width of the bounds, N", "hold, %", "hold it below 10 Hz, %", "untold, %",
    ]  # fmt: skip
    put(table(head, rows), "validation/forces.md", "arms")


def picture() -> None:
    """Draw the first arm's estimates beside the cut's force."""
    cell = CellConfig()
    model, seen = swept(cell), milled(cell, cell.simulator.options.get("seed", 1), 1.0)
    found = model.estimate(seen["motor_angle"], seen["torque"], RATE / SLOW)
    time = np.arange(len(found.force)) * SLOW / RATE
    PICTURE.parent.mkdir(parents=True, exist_ok=True)
    force_plot(time, found, seen["force"]).savefig(PICTURE, dpi=100)


def by_daqp(cases: Cases) -> tuple[float, np.ndarray]:
    """Return the seconds of a case by DAQP, set up and solved, and the objectives."""
    white = np.linalg.inv(np.linalg.cholesky(cases.covariance))
    free, found = np.full(3, 1e6), np.empty(len(cases.torque))
    none, spent = np.zeros((0, 9)), 0.0
    for n in range(len(found)):
        start = thread_time()
        matrix = np.hstack([-white @ cases.jacobian[n].T, white])
        target = white @ cases.torque[n]
        high, low = np.append(free, cases.friction[n, 1]), np.append(-free, cases.friction[n, 0])
        solution, *_ = daqp.solve(matrix.T @ matrix, -matrix.T @ target, none, high, low)
        spent += thread_time() - start
        found[n] = np.sum((matrix @ solution - target) ** 2)
    return spent / len(found), found


def in_batch(cases: Cases, tie_break: str) -> tuple[float, np.ndarray]:
    given = cases.torque, cases.jacobian, cases.friction, cases.covariance, tie_break, slack_of(cases)
    estimate_force(*given)
    start = thread_time()
    found = estimate_force(*given)
    return (thread_time() - start) / len(cases.torque), found.objective


def slack_of(cases: Cases) -> np.ndarray:
    """Return what the default margin is at rest, (samples, 6), N m."""
    return np.tile(packed_margin(Margin(), cases.covariance, np.zeros(6))[0], (len(cases.torque), 1))


def one_by_one(cases: Cases) -> float:
    slack, fixed = slack_of(cases), (cases.covariance, "centre")
    parts = [slice(n, n + 1) for n in range(500)]
    start = thread_time()
    for part in parts:
        estimate_force(cases.torque[part], cases.jacobian[part], cases.friction[part], *fixed, slack[part])
    return (thread_time() - start) / len(parts)


def as_block() -> float:
    """Return the seconds of a call of one sample, everything from angles on."""
    block = ForceEstimate(wide_model())
    block.prepare(RATE / SLOW, 1)
    told = [np.zeros((1, port.width)) for port in block.outputs]
    angle = 0.3 + 0.1 * np.sin(np.arange(1_000)[:, None] / 40 + np.arange(6))
    torque = block.model.gravity.torque(ARM, angle) + 3 * np.random.default_rng(1).normal(size=angle.shape)
    calls = [(angle[n : n + 1], torque[n : n + 1]) for n in range(1_000)]
    block.process(*calls[0], *told)
    start = thread_time()
    for call in calls:
        block.process(*call, *told)
    return (thread_time() - start) / len(calls)


def speed() -> None:
    """Print what a sample costs, the least of five runs each, all in one go."""
    rows = []
    for reach, what in ((1.0, "friction in its range"), (1.5, "mixed"), (4.0, "noise everywhere")):
        cases = random_cases(CASES, reach)
        peer, expected = min((by_daqp(cases) for _ in range(3)), key=lambda each: each[0])
        for tie_break in TIE_BREAKS:
            own, found = min((in_batch(cases, tie_break) for _ in range(5)), key=lambda each: each[0])
            worse, better = float((found - expected).max()), float((expected - found).max())
            rows.append([
                what, tie_break, f"{1e6 * own:.1f}", f"{1e6 * peer:.0f}", f"{peer / own:.1f}", f"{max(worse, 0.0):.1g}",
                f"{max(better, 0.0):.1g}",
            ])  # fmt: skip
    head = [
        "cases", "tie-break", "us a sample, in a batch", "DAQP, us", "times", "objective above DAQP's", "below it",
    ]  # fmt: skip
    put(table(head, rows), "validation/forces.md", "speed")
    single, whole = min(one_by_one(random_cases(CASES, 1.5)) for _ in range(5)), min(as_block() for _ in range(5))
    print(f"a single sample {1e6 * single:.0f} us; the Block, from angles to bounds, {1e6 * whole:.1f} us")


if __name__ == "__main__":
    {"speed": speed, "arms": arms, "picture": picture}[words()[0]]()
