"""A live run: the stage controls itself behind its CAN adapter; the host sends references and records."""

from collections.abc import Callable
from typing import Any

from ctlblocks import Graph, Port, recording
from ctlblocks.recording import Recording
from ctlblocks.replay import Record, Replay
from rigkit.provenance import now, software
from rigkit.run_folder import RunFolder
from stagectl.link.blocks import Newest, Receive, Send
from stagectl.link.clock import run_linked
from stagectl.link.priority import undisturbed
from stagectl.link.stage_link import StageLink
from stagectl.link.upload import upload
from stagectl.reference import wanted_position
from stagectl.session import RECORDING, summary
from stagectl.setup import Setup
from stagectl.stage.inner_parameters import inner_parameters
from stagectl.stage.loop import inner_loops
from stagectl.stage.loop_parameters import loop_parameters


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
        graph, record = _graph(link, made)
        folder.event("started", {"software": software(), "channel": made.config.link.channel})
        graph.prepare()
        if made.designs:
            axes = made.config.stage.axes
            parameters = loop_parameters(axes, [each.loop for each in made.designs])
            parameters |= inner_parameters(axes, inner_loops(made.config))
            folder.event("uploaded", {"crc": f"{upload(link, parameters):08x}"})
        try:
            with undisturbed():
                link.start()
                run_linked(graph, link, made.timeline.total // link.frames, stopped)
                link.stop()  # writing takes longer than the stage waits for references
        finally:
            if record.position:
                _keep(folder, made, record)
    figures = summary(folder.path, made)
    folder.summarise(figures)
    return figures


def _graph(link: StageLink, made: Setup) -> tuple[Graph, Record]:
    axes, times = len(made.config.stage.axes), made.timeline
    wanted = wanted_position(made.config, times)
    graph = Graph(link.rate, link.frames)
    ports = [Port(name, "V" if name == "voltage" else "m", axes) for name in _CHANNELS]
    record = Record(ports, times.total)
    for name, block in (
        ("wanted", Replay(wanted, {"reference": wanted.names})),
        ("send", Send(link)),
        ("position", Receive(link)),
        ("extension", Newest(link, "extension")),
        ("voltage", Newest(link, "voltage")),
        ("record", record),
    ):
        graph.add(name, block)
    graph.connect("wanted.reference", "send.reference")
    for name in _CHANNELS:
        source = "wanted.reference" if name == "reference" else f"{name}.{name}"
        graph.connect(source, f"record.{name}")
    return graph, record


_CHANNELS = ("reference", "position", "extension", "voltage")


def _keep(folder: RunFolder, made: Setup, record: Record) -> None:
    kept, axes = record.recording(), made.config.stage.axes
    names = tuple(f"{name}_{axis}" for name in _CHANNELS for axis in axes)
    about = {"rig": made.config.rig.name, "date": now(), "software": software()}
    path = folder.path / f"{RECORDING}.{made.config.session.recording}"
    recording.write(path, Recording(names, kept.units, kept.rate, kept.data, about))
    folder.event("recorded", {"recording": RECORDING, "samples": len(kept.data)})
