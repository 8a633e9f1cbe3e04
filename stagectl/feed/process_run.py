"""The simulation of Sörnmo 2015, fig. 7.5: force control against a process whose kappa and beta change with time."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ctlblocks import Graph, Port
from ctlblocks.clock import run_offline
from ctlblocks.recording import Recording
from ctlblocks.replay import Record, Replay
from stagectl.models import InnovationModel
from stagectl.named_block import named_block
from stagectl.robot.milling.feed_config import ForceFeed
from stagectl.robot.milling.feed_force import FeedForce
from stagectl.wire.egm import RATE

SEEN = (Port("velocity", "m/s"), Port("force", "N", 2))
"""What the controller is given of the process."""
TRUE = (Port("true_force", "N", 2), Port("true_kappa", "m/(N s)"), Port("true_beta"))
"""What it is not."""


def run_process(
    settings: ForceFeed,
    model: InnovationModel,
    seconds: float,
    plant: str = "firmware_sim.feed_blocks:FedTool",
    options: Mapping[str, Any] | None = None,
) -> Recording:
    """Run the controller against a process, as fast as it goes; return all that it saw, made and did not know.

    Parameters
    ----------
    settings : ForceFeed
    model : InnovationModel
    seconds : float, s
    plant : str, "module:Class" of a Block with the ports of `firmware_sim.feed_blocks.FedTool`
    options : mapping, optional
        Keywords it is built with.

    Raises
    ------
    ValueError : options that it does not take.
    """
    if not seconds * RATE >= 1.0:
        raise ValueError(f"seconds is {seconds:g}, must be >= {1.0 / RATE:g}")
    samples = round(seconds * RATE)
    graph, controller = Graph(RATE), FeedForce(settings, model)
    graph.add("process", named_block(plant, dict(options or {})))
    graph.add("always", Replay(Recording(("one",), ("1",), RATE, np.ones((samples, 1))), {"one": ("one",)}))
    graph.add("force", controller)
    graph.connect("force.reference", "process.asked")
    for port in SEEN:
        graph.connect(f"process.{port.name}", f"force.{port.name}", delayed=True)
    for name in ("is_valid", "is_running"):
        graph.connect("always.one", f"force.{name}")
    record = Record((*SEEN, *controller.outputs, *TRUE), samples)
    graph.add("record", record)
    for port in record.inputs:
        is_seen = port not in controller.outputs
        source = f"process.{port.name.removeprefix('true_') if port.unit != 'N' else port.name}"
        graph.connect(source if is_seen else f"force.{port.name}", f"record.{port.name}", delayed=is_seen)
    graph.prepare()
    run_offline(graph, samples)
    return record.recording({"plant": plant})
