"""A run of the pair in a graph of one sample a tick: reference, controller, manipulators, recorder."""

from typing import Any

import numpy as np

from ctlblocks import Block, Graph, Port
from ctlblocks.clock import run_offline
from ctlblocks.recording import Recording
from ctlblocks.replay import Record, Replay
from rigkit.config import resolve
from stagectl.robot.midranging.config import MidrangeConfig
from stagectl.robot.midranging.scenario import Scenario

MEASURED = ("relative", "fast", "slow", "control", "position")
"""What the pair gives; `position` is the relative position itself, without noise."""


def simulate(made: Block, chosen: Scenario, config: MidrangeConfig) -> Recording:
    """Run one controller against the pair that the rig file names.

    Parameters
    ----------
    made : Block
        InternalModel or ValvePosition, of one axis.
    chosen : Scenario
    config : MidrangeConfig

    Returns
    -------
    Recording
        `reference`, what the pair gave, and all that the controller made, from the first sample of the scenario's
        reference.  Every sample holds what the controller saw and what it answered.

    Raises
    ------
    ValueError : a controller that must estimate first had not done so when the reference began.
    """
    rate = config.pair.rate
    lead = round(config.session.lead * rate)
    wanted = np.concatenate([np.zeros(lead), chosen.reference])[:, np.newaxis]
    graph = Graph(rate)
    graph.add("wanted", Replay(Recording(("reference",), ("m",), rate, wanted), {"reference": ("reference",)}))
    graph.add("controller", made)
    graph.add("pair", _pair(config, chosen.options))
    sources = {"reference": ("wanted.reference", False)}
    sources |= {name: (f"pair.{name}", True) for name in MEASURED}
    answers = {port.name: f"controller.{port.name}" for port in made.outputs}
    for port in made.inputs:
        graph.connect(sources[port.name][0], f"controller.{port.name}", delayed=sources[port.name][1])
    for name in ("fast_reference", "slow_reference"):
        graph.connect(answers[name], f"pair.{name}")
    ports = [Port(name, "m/s" if name == "control" else "m") for name in sources]
    ports += [Port(_told(port.name), port.unit, port.width) for port in made.outputs]
    record = Record(ports, len(wanted))
    graph.add("record", record)
    for name, (source, delayed) in sources.items():
        graph.connect(source, f"record.{name}", delayed=delayed and name != "control")
    for name, source in answers.items():
        graph.connect(source, f"record.{_told(name)}")
    graph.prepare()
    run_offline(graph, len(wanted))
    whole = record.recording()
    _refuse_unready(whole, lead)
    return Recording(whole.names, whole.units, rate, whole.data[lead:].copy())


def _told(name: str) -> str:
    """Return under which name a controller's output is recorded: its own control signal beside the pair's."""
    return "foreseen_control" if name == "control" else name


def _pair(config: MidrangeConfig, options: dict[str, Any]) -> Block:
    """Build the pair, its times counted from the end of the lead."""
    lead, given = config.session.lead, {**config.simulator.options, **options}
    if "gains" in given:
        given["gains"] = tuple((time + lead, gain) for time, gain in given["gains"])
    if "disturbed_at" in given:
        given["disturbed_at"] += lead
    try:
        made = resolve(config.simulator.plant)(**given)
    except TypeError as fault:
        raise ValueError(f"{config.simulator.plant} does not take these options: {fault}") from None
    if not isinstance(made, Block):
        raise ValueError(f"{config.simulator.plant} makes a {type(made).__name__}, must be a Block")
    return made


def _refuse_unready(whole: Recording, lead: int) -> None:
    if "active" in whole.names:
        active = whole.data[:, whole.names.index("active")]
        if not active[min(lead, len(active) - 1)]:
            raise ValueError(
                f"the models are not accurate after session.lead of {lead / whole.rate:g} s: let the estimation phase "
                "last longer, excite more, or allow estimating.accuracy to be worse"
            )
