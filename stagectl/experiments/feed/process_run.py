"""The simulation of Sörnmo 2015, fig. 7.5: force control against a process whose kappa and beta change with time."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from calibration.state_space.model import InnovationModel
from ctlblocks import Graph, Port
from ctlblocks.recording import Recording
from ctlblocks.replay import Replay
from ctlblocks.taps import Tap
from rigkit.experiment.part import Part, Phase, Track
from rigkit.experiment.runner import Conduct, remembered
from rigkit.named_code import named_block
from stagectl.robot.feed_config import ForceFeed
from stagectl.robot.milling.feed_force import FeedForce
from stagectl.robot.milling.feed_record import CONTROLLING
from stagectl.wire.robot import RATE

SEEN = (Port("velocity", "m/s"), Port("force", "N", 2))
"""What the controller is given of the process."""
TRUE = (Port("true_force", "N", 2), Port("true_kappa", "m/(N s)"), Port("true_beta"))
"""What it is not."""
TRACK = "process"
"""Name of its recording."""
SECONDS = 16.0
"""s, of the simulation."""
SETTLED, ENOUGH = 0.4, 0.05
"""s after control has begun from which on errors are measured, and the part of the force within which it is settled."""

Process = Callable[[Graph], None]
"""Adds the process to a graph, under that name, and wires it to the controller, `force`."""


def simulated(plant: str, options: Mapping[str, Any]) -> Process:
    """Return what adds a simulated process.

    Parameters
    ----------
    plant : str, "module:Class" of a Block with the ports of `firmware_sim.feed_blocks.FedTool`
    options : mapping
        Keywords it is built with.
    """

    def add(graph: Graph) -> None:
        graph.add("process", named_block(plant, dict(options)))
        graph.connect("force.reference", "process.asked")

    return add


def recorded(record: Recording) -> Process:
    """Return what adds what a process was seen to do."""

    def add(graph: Graph) -> None:
        parts = {"velocity": ("velocity",), "force": ("force_1", "force_2")}
        graph.add("process", Replay(record, parts))

    return add


def process_part(
    settings: ForceFeed, model: InnovationModel, process: Process, seconds: float = SECONDS, is_true: bool = True
) -> Part:
    """Return the controller against a process, with all that it sees and makes recorded.

    Parameters
    ----------
    settings : ForceFeed
    model : InnovationModel
    process : Process
    seconds : float, s
    is_true : bool
        Whether the process tells the truth as well, which the controller is not shown.

    Raises
    ------
    ValueError : options that the process does not take, or less than a sample.
    """
    if not seconds * RATE >= 1.0:
        raise ValueError(f"seconds is {seconds:g}, must be >= {1.0 / RATE:g}")
    samples = round(seconds * RATE)
    graph, controller = Graph(RATE), FeedForce(settings, model)
    graph.add("force", controller)
    process(graph)
    graph.add("always", Replay(Recording(("one",), ("1",), RATE, np.ones((samples, 1))), {"one": ("one",)}))
    is_late = is_true  # a simulated process shows the end of its sample, a recorded one what was seen
    for port in SEEN:
        graph.connect(f"process.{port.name}", f"force.{port.name}", delayed=is_late)
    for name in ("is_valid", "is_running"):
        graph.connect("always.one", f"force.{name}")
    taps = [Tap(port.name, f"process.{port.name}", is_late) for port in SEEN]
    taps += [Tap(port.name, f"force.{port.name}") for port in controller.outputs]
    for port in TRUE if is_true else ():
        name = port.name if port.unit == "N" else port.name.removeprefix("true_")
        taps.append(Tap(port.name, f"process.{name}", True))
    own = frozenset(port.name for port in controller.outputs)
    return Part("", graph, (Track(TRACK, tuple(taps), own),), (Phase("run", samples),))


def run_process(
    settings: ForceFeed, model: InnovationModel, process: Process, seconds: float = SECONDS, is_true: bool = True
) -> Recording:
    """Run the controller against a process, as fast as it goes; return its recording: as of `process_part`."""
    return remembered(process_part(settings, model, process, seconds, is_true), Conduct())[0][TRACK]


def process_figures(record: Recording, force: float) -> dict[str, Any]:
    """Return what a run comes to, other programs' keys.

    Parameters
    ----------
    record : Recording
        As `run_process` returns it, with the truth.
    force : float, N
        Wanted.

    Returns
    -------
    dict
        `activation` (s), `force_before` (N, largest until 0.1 s after it), `settled_after` (s, to 5 %), and from 0.4 s
        after it on `mean_error`, `largest_error` (N), `kappa_error` (m/(N s)), `beta_error` (1), the last two rms;
        null where control never began.
    """
    on = channel(record, "phase") == CONTROLLING
    names = ("settled_after", "mean_error", "largest_error", "kappa_error", "beta_error")
    true = np.hypot(channel(record, "true_force_1"), channel(record, "true_force_2"))
    if not on.any():
        return {"activation": None, "force_before": float(true.max())} | dict.fromkeys(names)
    begun = int(np.argmax(on))
    error, settled = true[begun:] - force, begun + round(SETTLED * record.rate)
    window = np.abs(error[: round(2.5 * SETTLED * record.rate)])
    outside = np.flatnonzero(window > ENOUGH * force)
    late = true[settled:] - force
    found: dict[str, Any] = {
        "activation": begun / record.rate,
        "force_before": float(true[: begun + round(0.1 * record.rate)].max()),
        "settled_after": float((outside[-1] + 1) / record.rate) if len(outside) else 0.0,
        "mean_error": float(late.mean()),
        "largest_error": float(np.abs(late).max()),
    }
    for name in ("kappa", "beta"):
        apart = (channel(record, name) - channel(record, f"true_{name}"))[settled:]
        found[f"{name}_error"] = float(np.sqrt(np.mean(apart**2)))
    return found


def channel(record: Recording, name: str) -> np.ndarray:
    """Return a channel of a recording, shape (samples,), in its unit."""
    return record.select([name]).data[:, 0]
