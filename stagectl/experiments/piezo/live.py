"""A live run: the stage controls itself behind its CAN adapter; the host sends references and records."""

import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from ctlblocks import Block, Graph
from rigkit.priority import undisturbed
from rigkit.provenance import software
from rigkit.run_folder import RunFolder
from rigkit.stream_recorder import StreamRecorder
from stagectl.experiments.piezo.cell import watch
from stagectl.experiments.piezo.held_reference import HeldReference, Hold, unheld
from stagectl.experiments.piezo.lasers import laser_limits, reads_laser
from stagectl.experiments.piezo.reference import wanted_position
from stagectl.experiments.piezo.session import prefiltered_after, summary
from stagectl.experiments.piezo.setup import Setup
from stagectl.experiments.piezo.streamed import RECORDING, convert, recorded_live, recorder, recordings_of
from stagectl.link.blocks import Newest, Receive, ReceiveAbsolute, Send
from stagectl.link.clock import run_linked
from stagectl.link.stage_link import StageLink
from stagectl.link.upload import upload
from stagectl.stage.deflection_parameters import DeflectionLoop, deflection_parameters
from stagectl.stage.inner_parameters import inner_parameters
from stagectl.stage.loop import inner_loops
from stagectl.stage.loop_parameters import loop_parameters
from stagectl.wire.messages import State


def run_live(folder: RunFolder, made: Setup, stopped: Callable[[], bool]) -> dict[str, Any]:
    """Let the stage follow the reference for the length of the run; return the figures, also in `summary.json`.

    Whatever ends it, what has come until then is recorded, and the stage goes to mid-travel.

    Parameters
    ----------
    folder : RunFolder
    made : Setup
        With designs, their loops and the rig file's PIDs go to the stage first; without, it uses those it has.
    stopped : callable() -> bool

    Raises
    ------
    LinkError : the bus cannot be opened, the stage is not heard, or a fault has latched; its reason is in the events.
    """
    with StageLink(made.config.link, folder.event) as link:
        for name in recordings_of(made.config):
            kept = follow(link, folder, made, stopped, {}, name=name)
            if stopped():
                break
            made = prefiltered_after(folder, made, name)
    return finish(folder, made, kept)


def follow(
    link: StageLink,
    folder: RunFolder,
    made: Setup,
    stopped: Callable[[], bool],
    watching: Mapping[str, Block],
    hold: Hold = unheld,
    *,
    name: str = RECORDING,
) -> StreamRecorder:
    """Let the stage behind an open link follow the reference; return the recorder, which is at its end.

    Parameters
    ----------
    link : StageLink
    folder : RunFolder
    made : Setup
    stopped : callable() -> bool
    watching : mapping of str to Block
        Further sinks by name; their ports are of `recorded_live`.
    hold : callable(HeldReference, int)
        Asked at each block whether to hold the reference.
    name : str
        Of the recording; the deflection is compensated in `RECORDING` alone.

    Raises
    ------
    LinkError : as `run_live`.
    """
    signals = recorded_live(made.config)
    kept = recorder(folder, made.config, signals, name)
    times = made.timeline
    reference = HeldReference(
        wanted_position(made.config, times), made.config.limits.ramp, slice(times.begin, times.end)
    )
    graph = _graph(link, reference, signals, {"record": kept, **watching})
    samples = times.total // link.frames * link.frames

    def over() -> bool:
        hold(reference, graph.ticks * link.frames)
        return stopped() or reference.played >= samples

    folder.event("started", {"software": software(), "channel": made.config.link.channel})
    graph.prepare()
    if parameters := _parameters(made, made.config.deflection.on and name == RECORDING):
        folder.event("uploaded", {"crc": f"{upload(link, parameters):08x}"})
    try:
        with undisturbed(), kept:
            _come_to_rest(link)
            link.start()
            run_linked(graph, link, sys.maxsize, over)
            link.stop()  # finishing takes longer than the stage waits for references
    finally:
        if kept.files:
            _keep(folder, made, kept, name, link)
    return kept


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


def finish(folder: RunFolder, made: Setup, kept: StreamRecorder) -> dict[str, Any]:
    """Return the figures of a run that was recorded as it went, also in `summary.json`."""
    figures = summary(folder.path, made) | {"lost": kept.lost}
    folder.summarise(figures)
    return figures


def _graph(link: StageLink, reference: HeldReference, signals: Sequence[str], watching: Mapping[str, Block]) -> Graph:
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
    outputs = {name: (f"{name}.{name}", False) for name in signals if name != "reference"}
    watch(graph, watching, {"reference": ("wanted.position", False), **outputs})
    return graph


def _keep(folder: RunFolder, made: Setup, kept: StreamRecorder, name: str, link: StageLink) -> None:
    convert(folder, made.config, kept)
    folder.event("recorded", {"recording": name, "samples": kept.recorded, "lost": kept.lost})
    if reads_laser(made.config):
        folder.event("lasers", {"recording": name, **asdict(link.counts.lasers)})
