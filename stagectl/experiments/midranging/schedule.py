"""The order of events in mid-ranging: a lead, in which models are estimated, and the reference."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from ctlblocks import Block, Graph, Port
from ctlblocks.clock import Clock
from ctlblocks.recording import Recording
from ctlblocks.replay import numbered
from rigkit.experiment.part import Part, Phase, nothing
from rigkit.experiment.runner import Conduct, never, remembered
from stagectl.experiments.midranging import pairs
from stagectl.experiments.midranging.graph import netlist
from stagectl.experiments.midranging.scenario import Scenario
from stagectl.link.tell import Tell, nobody
from stagectl.robot.midranging.axis_record import TAKEN_OVER
from stagectl.robot.midranging.internal_model import InternalModel
from stagectl.robot.midranging_config import MidrangeConfig

TRACK = "recording"
LOOK = 240
"""Samples from one look at who controls to the next."""


def lead_of(config: MidrangeConfig) -> int:
    """Return how many samples come before the reference begins."""
    return round(config.session.lead * config.pair.rate)


def with_lead(reference: np.ndarray, config: MidrangeConfig) -> np.ndarray:
    """Return a reference behind its lead, shape (samples, axes), m, from one of shape (samples, axes)."""
    return np.concatenate([np.zeros((lead_of(config), reference.shape[1])), reference])


def without_lead(recording: Recording, config: MidrangeConfig) -> Recording:
    """Return a recording from the first sample of the reference on."""
    return replace(recording, data=recording.data[lead_of(config) :].astype(float))


def part(
    config: MidrangeConfig,
    controls: Block,
    wanted: np.ndarray,
    pair: pairs.Pair,
    name: str = "",
    channels: Callable[[Port], tuple[str, ...]] = numbered,
    tell: Tell = nobody,
) -> Part:
    """Return a part of the experiment, its phases the lead and the reference.

    Parameters
    ----------
    config : MidrangeConfig
    controls : Block
        InternalModel or ValvePosition, of as many axes as `wanted` has.
    wanted : array, shape (samples, axes), m
        The reference, with its lead.
    pair : callable(Graph) -> Wired
        The manipulators.
    name : str
        Of the axis.
    channels : callable(Port) -> tuple of str
        As of `Track`.
    tell : callable(event, fields)
        Told when valve position control takes over.
    """
    graph, lead = Graph(config.pair.rate), lead_of(config)
    there = pair(graph)
    track = netlist(graph, controls, wanted, there.seen, there.sink, f"{TRACK}-{name}" if name else TRACK, channels)
    estimates = any(port.name == "active" for port in controls.outputs)

    def ready() -> None:
        """Refuse, by ValueError, a controller that must estimate first and has not done so."""
        if len(wanted) > lead and estimates and not graph.signal("controller.active").all():
            raise ValueError(
                f"the models are not accurate after session.lead of {config.session.lead:g} s: let the estimation "
                "phase last longer, excite more, or allow estimating.accuracy to be worse"
            )

    first = min(lead + 1, len(wanted))
    look = partial(_look, graph, controls, {"axis": name}, tell, []) if estimates else never
    every = LOOK if tell is not nobody else 0
    phases = (Phase("lead", first, end=ready, every=every, look=look),
              Phase("reference", len(wanted) - first, every=every, look=look))  # fmt: skip
    return Part(name, graph, (track,), phases)


def _look(graph: Graph, controls: Block, fields: dict[str, Any], tell: Tell, told: list[int]) -> bool:
    """Tell, once, that valve position control has taken over of an axis; a phase is never over for that."""
    for axis in np.flatnonzero(graph.signal("controller.active")[-1] == TAKEN_OVER).tolist():
        if axis not in told:
            told.append(axis)
            reason = controls.reasons[axis] if isinstance(controls, InternalModel) else ""
            tell("taken over", {**fields, "number": axis, "by": "mvpc-aw", "ticks": graph.ticks, "reason": reason})
    return False


def led(made: Part, clock: Clock, begin: Callable[[], object], rest: Callable[[], object]) -> Part:
    """Return a part whose pair is behind wires.

    Parameters
    ----------
    made : Part
    clock : Clock
        Of the wires.
    begin, rest : callable()
        Lets the pair follow, and holds it.
    """
    lead, reference = made.phases
    return replace(made, clock=clock, phases=(replace(lead, begin=begin), reference), rest=rest)


def unchecked(made: Part) -> Part:
    """Return a part that is made again: what it was refused for it has been refused for."""
    lead, reference = made.phases
    return replace(made, phases=(replace(lead, end=nothing), reference))


def simulate(controls: Block, chosen: Scenario, config: MidrangeConfig) -> Recording:
    """Run one controller of one axis against the pair that the rig file names, in memory.

    Parameters
    ----------
    controls : Block
        InternalModel or ValvePosition.
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
    wanted = with_lead(chosen.reference[:, np.newaxis], config)
    made, _ = remembered(part(config, controls, wanted, pairs.simulated(config, chosen.options)), Conduct())
    return without_lead(made[TRACK], config)
