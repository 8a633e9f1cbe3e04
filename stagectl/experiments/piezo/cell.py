"""The graph of a run: the stage's controllers, what they see, and who watches all that goes in and out."""

from collections.abc import Callable, Mapping, Sequence

from ctlblocks import Block, Graph, Port
from ctlblocks.clock import run_offline
from ctlblocks.recording import Recording
from ctlblocks.replay import Record, Replay
from ctlblocks.taps import Tap, attach
from rigkit.named_code import named_block
from stagectl.config import StageConfig
from stagectl.experiments.piezo.deflection import DeflectionReference
from stagectl.experiments.piezo.held_reference import HeldReference, Hold, unheld
from stagectl.experiments.piezo.setup import Setup
from stagectl.stage.loop import Stage
from stagectl.stage.prefiltered_reference import PrefilteredReference

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
        Sinks by name, such as a recorder; their ports are of `RECORDED`.
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
        watch(graph, watching, outputs | kept)
        graph.prepare()

    def run(self, tell: Callable[[int], None], stopped: Callable[[], bool], hold: Hold = unheld) -> str | None:
        """Run from the first sample to the last, or to rest after a fault, or until `stopped`; return the fault.

        Parameters
        ----------
        tell : callable(int)
            Told of the samples done, now and then.
        stopped : callable() -> bool
        hold : callable(HeldReference, int)
            Asked as often whether to hold the reference; what is recorded is longer by the time that it is held.
        """
        times = self._made.timeline
        ends = sorted({times.start, times.end, times.total, *range(CHUNK, times.total, CHUNK)})
        for done in ends:
            if not self._play(done, tell, stopped, hold):
                self._come_to_rest()
                break
            if done == times.start:
                self.stage.start()
            if done == times.end:
                self.stage.stop()
        return self.stage.fault

    def _play(self, end: int, tell: Callable[[int], None], stopped: Callable[[], bool], hold: Hold) -> bool:
        """Go on until so many samples of the reference are played; return whether neither fault nor stop came."""
        while self.reference.played < end:
            hold(self.reference, self.graph.ticks)
            run_offline(self.graph, end - int(self.reference.played) if self.reference.is_playing else CHUNK)
            tell(self.graph.ticks)
            if self.stage.fault is not None or stopped():
                return False
        return True

    def _come_to_rest(self) -> None:
        if self.stage.fault is None:
            self.stage.stop()
        left = self._made.timeline.total - int(self.reference.played)
        ramp = round(1.1 * self._made.config.limits.ramp * self.graph.rate)
        run_offline(self.graph, min(left, ramp))


def ports_of(signals: Sequence[str], axes: Sequence[str]) -> tuple[Port, ...]:
    """Return the ports of a run's signals, one wide an axis."""
    return tuple(Port(name, "V" if name == "voltage" else "m", len(axes)) for name in signals)


def channels_of(signals: Sequence[str], axes: Sequence[str]) -> tuple[str, ...]:
    """Return how the channels of a recording of these signals are called."""
    return tuple(f"{name}_{axis}" for name in signals for axis in axes)


def memory(made: Setup, rows: int) -> Record:
    """Return what keeps all that is recorded of a run in process, of so many samples."""
    return Record(ports_of(RECORDED, made.config.stage.axes), rows)


def kept_in(record: Record, made: Setup, provenance: Mapping[str, str]) -> Recording:
    """Return what `memory` has kept, with the axes' names in those of the channels."""
    kept = record.recording(provenance)
    names = channels_of(RECORDED, made.config.stage.axes)
    return Recording(names, kept.units, kept.rate, kept.data, kept.provenance)


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
