"""A live run: the stage controls itself behind its CAN adapter; the host sends references and records."""

from collections.abc import Callable
from typing import Any

from ctlblocks import Graph, Port, recording
from ctlblocks.recording import RecordingError
from ctlblocks.replay import Replay
from rigkit.provenance import now, software
from rigkit.run_folder import RunFolder
from rigkit.stream_recorder import StreamRecorder
from rigkit.stream_writer import Stream
from stagectl.link.blocks import Newest, Receive, Send
from stagectl.link.clock import run_linked
from stagectl.link.priority import undisturbed
from stagectl.link.stage_link import StageLink
from stagectl.link.upload import upload
from stagectl.reference import wanted_position
from stagectl.session import RECORDED_LIVE, RECORDING, summary
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
        graph, recorder = _graph(link, made, folder)
        folder.event("started", {"software": software(), "channel": made.config.link.channel})
        graph.prepare()
        if made.designs:
            axes = made.config.stage.axes
            parameters = loop_parameters(axes, [each.loop for each in made.designs])
            parameters |= inner_parameters(axes, inner_loops(made.config))
            folder.event("uploaded", {"crc": f"{upload(link, parameters):08x}"})
        try:
            with undisturbed(), recorder:
                link.start()
                run_linked(graph, link, made.timeline.total // link.frames, stopped)
                link.stop()  # finishing takes longer than the stage waits for references
        finally:
            _keep(folder, made, recorder)
    figures = summary(folder.path, made) | {"lost": recorder.lost}
    folder.summarise(figures)
    return figures


def _graph(link: StageLink, made: Setup, folder: RunFolder) -> tuple[Graph, StreamRecorder]:
    axes, times = made.config.stage.axes, made.timeline
    wanted = wanted_position(made.config, times)
    graph = Graph(link.rate, link.frames)
    ports = tuple(Port(name, "V" if name == "voltage" else "m", len(axes)) for name in RECORDED_LIVE)
    names = tuple(f"{name}_{axis}" for name in RECORDED_LIVE for axis in axes)
    about = {"rig": made.config.rig.name, "date": now(), "software": software()}
    recorder = StreamRecorder(Stream(folder.path / f"{RECORDING}.wav", ports, names, about), folder.event)
    for name, block in (
        ("wanted", Replay(wanted, {"reference": wanted.names})),
        ("send", Send(link)),
        ("position", Receive(link)),
        ("extension", Newest(link, "extension")),
        ("voltage", Newest(link, "voltage")),
        ("record", recorder),
    ):
        graph.add(name, block)
    graph.connect("wanted.reference", "send.reference")
    for name in RECORDED_LIVE:
        source = "wanted.reference" if name == "reference" else f"{name}.{name}"
        graph.connect(source, f"record.{name}")
    return graph, recorder


def _keep(folder: RunFolder, made: Setup, recorder: StreamRecorder) -> None:
    """Convert what was recorded to the format that the rig file asks for."""
    if not recorder.files:
        return
    if made.config.session.recording == "csv":
        for path in recorder.files:
            try:
                recording.write(path.with_suffix(".csv"), recording.read(path))
            except RecordingError as fault:
                folder.event("kept_as_wav", {"recording": path.name, "text": str(fault)})
            else:
                path.unlink()
    folder.event("recorded", {"recording": RECORDING, "samples": recorder.recorded, "lost": recorder.lost})
