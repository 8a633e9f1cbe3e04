"""The graph of a run: the stage's controllers, what they see, what is recorded of it, and its phases."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from typing import Any

from ctlblocks import Block, Graph, Port
from ctlblocks.recording import Recording
from ctlblocks.replay import Replay
from ctlblocks.taps import Tap, attach
from rigkit.experiment.part import Part, Phase, Retreat, Track
from rigkit.named_code import named_block
from rigkit.stream_writer import Tell
from stagectl.config import StageConfig
from stagectl.experiments.piezo.deflection import DeflectionReference
from stagectl.experiments.piezo.held_reference import HeldReference, Holding
from stagectl.experiments.piezo.setup import Setup
from stagectl.experiments.piezo.timeline import Timeline
from stagectl.link.tell import nobody
from stagectl.stage.loop import Stage
from stagectl.stage.prefiltered_reference import PrefilteredReference

RECORDING, UNCOMPENSATED = "recording", "uncompensated"
"""Names of a run's recordings, less the suffix."""
SEEN = ("position", "extension", "absolute")
"""What sensors give, m."""
MADE = ("reference", "extension_reference", "voltage")
"""What the controllers make of it: m, m and V."""
RECORDED = ("wanted", *SEEN, *MADE)
"""What is recorded of a run in process."""
CHUNK = 100
"""Samples between two looks at faults and at whether the run is to stop."""

Seen = Callable[[Graph], dict[str, tuple[str, bool]]]
"""Adds the stage itself to a graph; returns for each of `SEEN` its output, and whether it is read a tick late.

"kept position" and so on are what is recorded in its place, where that differs.
"""


class Cell:
    """A run in a graph of one sample a tick.

    Parameters
    ----------
    made : Setup
    wanted : Recording
        Position of every axis, as long as the run.
    seen : Seen
        `simulated(config)` or `recorded(recording, config)`.
    compensate : bool
        Whether the robot's deflection is taken off the reference, and what is left goes through the prefilters.
    watching : mapping of str to Block
        Sinks by name; their ports are of `RECORDED`.
    """

    def __init__(
        self, made: Setup, wanted: Recording, seen: Seen, compensate: bool, watching: Mapping[str, Block]
    ) -> None:
        config, axes = made.config, len(made.config.stage.axes)
        self._made = made
        self.graph = graph = Graph(config.stage.rate)
        self.stage = Stage(graph, config, made.controller(compensate), made.compensation())
        times = made.timeline
        self.reference = HeldReference(wanted, config.limits.ramp, slice(times.begin, times.end - CHUNK))
        graph.add("wanted", self.reference)
        outputs = {"wanted": ("wanted.position", False), **seen(graph)}
        graph.connect(outputs["position"][0], "sensors.position", delayed=outputs["position"][1])
        graph.connect(outputs["extension"][0], "sensors.extension", delayed=outputs["extension"][1])
        outputs["reference"] = ("wanted.position", False)
        if compensate:
            graph.add("deflection", DeflectionReference(config.deflection, axes))
            for name in ("wanted", "absolute", "position"):
                graph.connect(outputs[name][0], f"deflection.{name}", delayed=outputs[name][1])
            outputs["reference"] = ("deflection.reference", False)
        followed = outputs["reference"][0]
        if compensate and any(made.prefilters):
            graph.add("prefilter", PrefilteredReference(made.prefilters))
            graph.connect(followed, "prefilter.reference")
            followed = "prefilter.filtered"
        graph.connect(followed, "controller.reference")
        outputs["extension_reference"] = ("controller.extension_reference", False)
        outputs["voltage"] = ("guard.voltage", False)
        kept = {name.removeprefix("kept "): output for name, output in outputs.items() if name.startswith("kept ")}
        self._outputs = outputs | kept
        watch(graph, watching, self._outputs)

    def part(self, name: str = RECORDING, tell: Tell = nobody) -> Part:
        """Return it as a part: it rises to rest, follows, and goes to rest, also where a fault or a stop ends it.

        Parameters
        ----------
        name : str
            Of its recording.
        tell : callable(event, fields)
        """
        stage, times, rest = self.stage, self._made.timeline, self.ramp
        return Part(
            part_name(name),
            self.graph,
            (track(name, RECORDED, MADE, self._outputs, self._made.config.stage.axes),),
            self.phases(times),
            retreat=Retreat(lambda: stage.fault or "", lambda _: self._stop(), rest),
            counts=self._counts,
            progress=lambda: float(self.reference.played) / times.rate,
            hold=Holding(self.reference, tell, lambda: self.graph.ticks),
            late=lambda: self.graph.ticks - int(self.reference.played),
        )

    def phases(self, times: Timeline) -> tuple[Phase, ...]:
        """Return the phases of a timeline; what they look for is asked often, and ends none of them."""
        return (
            Phase("rise", times.start, end=self._start, every=CHUNK),
            Phase("follow", times.end - times.start, end=self._stop, every=CHUNK),
            Phase("rest", times.total - times.end, every=CHUNK),
        )

    @property
    def ramp(self) -> int:
        """Samples of the way to rest."""
        return round(1.1 * self._made.config.limits.ramp * self.graph.rate)

    def _start(self) -> None:
        if self.stage.fault is None:
            self.stage.start()

    def _stop(self) -> None:
        if self.stage.fault is None:
            self.stage.stop()

    def _counts(self) -> dict[str, Any]:
        stage = self.stage
        met = asdict(stage.controller.met) | {"guard": stage.guard.limited, "held": stage.sensors.held}
        return {"held": self.reference.held, "limits_met": met}


def part_name(name: str) -> str:
    """Return how the part of a recording is called: not at all, where it is the run proper."""
    return "" if name == RECORDING else name


def track(
    name: str,
    signals: Sequence[str],
    made: Sequence[str],
    outputs: Mapping[str, tuple[str, bool]],
    axes: Sequence[str],
) -> Track:
    """Return what is recorded of a run.

    Parameters
    ----------
    name : str
    signals, made : sequence of str
        All signals, and those of them that controllers make.
    outputs : mapping of str to (str, bool)
        The output of each signal, and whether it is read a tick late.
    axes : sequence of str
    """
    taps = tuple(Tap(signal, *outputs[signal]) for signal in signals)
    return Track(name, taps, frozenset(made), channels=lambda port: channels_of([port.name], axes))


def ports_of(signals: Sequence[str], axes: Sequence[str]) -> tuple[Port, ...]:
    """Return the ports of a run's signals, one wide an axis."""
    return tuple(Port(name, "V" if name == "voltage" else "m", len(axes)) for name in signals)


def channels_of(signals: Sequence[str], axes: Sequence[str]) -> tuple[str, ...]:
    """Return how the channels of a recording of these signals are called."""
    return tuple(f"{name}_{axis}" for name in signals for axis in axes)


def watch(graph: Graph, watching: Mapping[str, Block], outputs: Mapping[str, tuple[str, bool]]) -> None:
    """Add sinks to a graph, and wire each of their ports to the output of its name.

    Parameters
    ----------
    graph : Graph
    watching : mapping of str to Block
    outputs : mapping of str to (str, bool)
        The output of each signal, and whether it is read a tick late.
    """
    for name, block in watching.items():
        attach(graph, name, block, [Tap(port.name, *outputs[port.name]) for port in block.inputs])


def simulated(config: StageConfig) -> Seen:
    """Return what adds the plant that the rig file names, and its surroundings."""

    def seen(graph: Graph) -> dict[str, tuple[str, bool]]:
        options = config.simulator
        graph.add("plant", named_block(options.plant, options.options))
        graph.add("surroundings", named_block(options.surroundings, options.surroundings_options))
        for name in ("force", "base"):
            graph.connect(f"surroundings.{name}", f"plant.{name}")
        graph.connect("guard.voltage", "plant.voltage")
        return {name: (f"plant.{name}", True) for name in SEEN}

    return seen


def recorded(record: Recording, config: StageConfig) -> Seen:
    """Return what adds the sensors of a recording, in place of a stage."""

    def seen(graph: Graph) -> dict[str, tuple[str, bool]]:
        ports = {name: [f"{name}_{axis}" for axis in config.stage.axes] for name in SEEN}
        graph.add("recorded", Replay(record, ports))
        return {name: (f"recorded.{name}", False) for name in SEEN}

    return seen
