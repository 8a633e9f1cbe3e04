"""A run of the simulated pair: reference, controller, manipulators, recorder, as fast as it goes."""

from collections.abc import Callable
from typing import Any

import numpy as np

from ctlblocks import Block, Graph
from ctlblocks.clock import run_offline
from ctlblocks.recording import Recording
from rigkit.named_code import named_block
from rigkit.stop import Stopped
from stagectl.robot.midranging.config import MidrangeConfig
from stagectl.robot.midranging.scenario import Scenario
from stagectl.robot.midranging.wiring import MEASURED, refuse_unready, split, wire

CHUNK = 25
"""Samples between two looks at whether the run is to stop."""

Advance = Callable[[Graph, int], object]
"""Ticks a graph so many times."""


def never() -> bool:
    """Do not stop."""
    return False


def simulate(
    made: Block,
    chosen: Scenario,
    config: MidrangeConfig,
    stopped: Callable[[], bool] = never,
    advance: Advance = run_offline,
) -> Recording:
    """Run one controller against the pair that the rig file names.

    Parameters
    ----------
    made : Block
        InternalModel or ValvePosition, of one axis.
    chosen : Scenario
    config : MidrangeConfig
    stopped : callable() -> bool
        Whether to end early.
    advance : callable(Graph, int)
        As fast as it goes unless given.

    Returns
    -------
    Recording
        `reference`, what the pair gave, and all that the controller made, from the first sample of the scenario's
        reference.  Every sample holds what the controller saw and what it answered.

    Raises
    ------
    ValueError : a controller that must estimate first had not done so when the reference began.
    Stopped : it was, before the reference began.
    """
    lead = round(config.session.lead * config.pair.rate)
    wanted = np.concatenate([np.zeros(lead), chosen.reference])[:, np.newaxis]
    graph = Graph(config.pair.rate)
    graph.add("pair", _pair(config, chosen.options))
    record = wire(graph, made, wanted, {name: (f"pair.{name}", True) for name in MEASURED}, "pair")
    while graph.ticks < len(wanted) and not stopped():
        advance(graph, min(CHUNK, len(wanted) - graph.ticks))
    if graph.ticks <= lead:
        raise Stopped(f"stopped after {graph.ticks / graph.rate:g} s, before the reference began")
    refuse_unready(record, lead)
    return split(record, 1, lead)[0]


def _pair(config: MidrangeConfig, options: dict[str, Any]) -> Block:
    """Build the pair, its times counted from the end of the lead."""
    lead, given = config.session.lead, {**config.simulator.options, **options}
    if "gains" in given:
        given["gains"] = tuple((time + lead, gain) for time, gain in given["gains"])
    if "disturbed_at" in given:
        given["disturbed_at"] += lead
    return named_block(config.simulator.plant, given)
