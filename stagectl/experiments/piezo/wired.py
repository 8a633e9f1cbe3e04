"""A live run: the stage controls itself behind its CAN adapter; the host sends references and records."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from ctlblocks import Block, Graph
from ctlblocks.recording import Recording
from rigkit.experiment.part import Part, Phase
from rigkit.stream_writer import Tell
from stagectl.config import StageConfig
from stagectl.experiments.piezo.cell import RECORDING, part_name, track, watch
from stagectl.experiments.piezo.held_reference import HeldReference, Holding
from stagectl.experiments.piezo.lasers import laser_limits, reads_laser
from stagectl.experiments.piezo.setup import Setup
from stagectl.link.blocks import Newest, Receive, ReceiveAbsolute, Send
from stagectl.link.clock import Linked
from stagectl.link.stage_link import StageLink
from stagectl.link.upload import upload
from stagectl.stage.deflection_parameters import DeflectionLoop, deflection_parameters
from stagectl.stage.inner_parameters import inner_parameters
from stagectl.stage.loop import inner_loops
from stagectl.stage.loop_parameters import loop_parameters
from stagectl.wire.messages import State

RECORDED_LIVE = ("reference", "position", "extension", "voltage")
"""What is recorded of a live run; `recorded_live` says whether there is more."""


def recorded_live(config: StageConfig) -> tuple[str, ...]:
    """Return what is recorded of a live run: what lasers see as well, where they are read.

    Parameters
    ----------
    config : StageConfig
    """
    return (*RECORDED_LIVE, "absolute") if reads_laser(config) else RECORDED_LIVE


def wired_part(
    link: StageLink, made: Setup, name: str, wanted: Recording, watching: Mapping[str, Block], tell: Tell
) -> Part:
    """Upload what the stage behind an open link is to use; return the part in which it follows the reference.

    Whatever ends it, the stage goes to mid-travel.

    Parameters
    ----------
    link : StageLink
    made : Setup
        With designs, their loops and the rig file's PIDs go to the stage first; without, it uses those it has.
    name : str
        Of the recording; the deflection is compensated in `RECORDING` alone.
    wanted : Recording
    watching : mapping of str to Block
        Sinks by name; their ports are of `recorded_live`.
    tell : callable(event, fields)

    Raises
    ------
    LinkError : the stage does not take them.
    """
    config, times, frames = made.config, made.timeline, link.frames
    if parameters := _parameters(made, config.deflection.on and name == RECORDING):
        tell("uploaded", {"crc": f"{upload(link, parameters):08x}"})
    reference = HeldReference(wanted, config.limits.ramp, slice(times.begin, times.end))
    graph, outputs = _graph(link, reference, recorded_live(config))
    watch(graph, watching, outputs)

    def begin() -> None:
        _come_to_rest(link)
        link.start()

    def rest() -> None:
        if not link.reason:  # finishing a recording takes longer than the stage waits for references
            link.stop()

    def counts() -> dict[str, Any]:
        lasers = {"lasers": asdict(link.counts.lasers)} if reads_laser(config) else {}
        return {"held": reference.held, **lasers}

    return Part(
        part_name(name),
        graph,
        (track(name, recorded_live(config), (), outputs, config.stage.axes),),
        (Phase("follow", times.total // frames, begin),),
        clock=Linked(link),
        counts=counts,
        rest=rest,
        progress=lambda: float(reference.played) / times.rate,
        hold=Holding(reference, tell, lambda: graph.ticks * frames),
        late=lambda: graph.ticks - int(reference.played // frames),
    )


def _parameters(made: Setup, compensates: bool) -> dict[str, np.ndarray]:
    """Return what the stage is to use: loops where they were designed, and what it is to do with its lasers."""
    axes, parameters = made.config.stage.axes, dict[str, np.ndarray]()
    if made.designs:
        parameters |= loop_parameters(axes, made.loops_for(compensates))
        parameters |= inner_parameters(axes, inner_loops(made.config))
    if reads_laser(made.config):
        corner, filters = (made.config.deflection.corner, made.prefilters) if compensates else (None, ())
        parameters |= deflection_parameters(axes, DeflectionLoop(laser_limits(made.config), corner, filters))
    return parameters


def _come_to_rest(link: StageLink) -> None:
    """Wait while the stage is on its way to mid-travel, from the recording before."""
    while link.state is State.RAMPING and link.wait(link.skip() + link.frames, link.patience):
        pass


def _graph(
    link: StageLink, reference: HeldReference, signals: tuple[str, ...]
) -> tuple[Graph, dict[str, tuple[str, bool]]]:
    """Return the graph, and for each signal its output, and that it is not read late."""
    graph = Graph(link.rate, link.frames)
    for name, block in (
        ("wanted", reference),
        ("send", Send(link)),
        ("position", Receive(link)),
        ("extension", Newest(link, "extension")),
        ("voltage", Newest(link, "voltage")),
    ):
        graph.add(name, block)
    if "absolute" in signals:
        graph.add("absolute", ReceiveAbsolute(link))
    graph.connect("wanted.position", "send.reference")
    outputs = {name: (f"{name}.{name}", False) for name in signals}
    return graph, outputs | {"reference": ("wanted.position", False)}
