"""The netlist of mid-ranging: reference, controller, and the pair of manipulators, of whatever make."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from ctlblocks import Block, Graph, Port
from ctlblocks.recording import Recording
from ctlblocks.replay import Replay, numbered
from ctlblocks.taps import Tap
from rigkit.experiment.part import Track

MEASURED = ("relative", "fast", "slow", "control", "position")
"""What the pair gives; `position` is the relative position itself, without noise where it is simulated."""
ASKED = ("fast_reference", "slow_reference")
"""What it takes."""


def netlist(
    graph: Graph,
    made: Block,
    wanted: np.ndarray,
    seen: Mapping[str, Tap],
    sink: str | None,
    track: str,
    channels: Callable[[Port], tuple[str, ...]] = numbered,
) -> Track:
    """Add reference and controller to a graph that has the pair; return what is to be recorded.

    Parameters
    ----------
    graph : Graph
    made : Block
        InternalModel or ValvePosition, of as many axes as `wanted` has.
    wanted : array, shape (samples, axes), m
        The reference.
    seen : mapping of str to Tap
        Where each of `MEASURED` comes from.
    sink : str or None
        The block that takes `ASKED`; none where the pair is a recording.
    track : str
        Name of the recording.
    channels : callable(Port) -> tuple of str
        As of `Track`.
    """
    names = tuple(f"reference_{axis}" for axis in range(wanted.shape[1]))
    reference = Recording(names, ("m",) * len(names), graph.rate, wanted)
    graph.add("wanted", Replay(reference, {"reference": names}))
    graph.add("controller", made)
    sources = {"reference": Tap("reference", "wanted.reference"), **seen}
    for port in made.inputs:
        tap = sources[port.name]
        graph.connect(tap.source, f"controller.{port.name}", delayed=tap.delayed)
    for name in ASKED if sink is not None else ():
        graph.connect(f"controller.{name}", f"{sink}.{name}")
    answers = [Tap(_told(port.name), f"controller.{port.name}") for port in made.outputs]
    return Track(track, (*sources.values(), *answers), frozenset(tap.name for tap in answers), 1, channels)


def of_axes(axes: Sequence[str]) -> Callable[[Port], tuple[str, ...]]:
    """Return how the channels of a port are called that is equally wide for each axis: an axis' name ends each."""

    def channels(port: Port) -> tuple[str, ...]:
        each = port.width // len(axes)
        return tuple(
            f"{name}_{axis}" if axis else name for axis in axes for name in numbered(Port(port.name, port.unit, each))
        )

    return channels


def _told(name: str) -> str:
    """Return under which name a controller's output is recorded: its own control signal beside the pair's."""
    return "foreseen_control" if name == "control" else name
