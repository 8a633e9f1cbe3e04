"""Reference, controller, manipulators and recorder in one graph, the pair in process or behind its wires."""

from collections.abc import Mapping

import numpy as np

from ctlblocks import Block, Graph, Port
from ctlblocks.recording import Recording
from ctlblocks.replay import Record, Replay

MEASURED = ("relative", "fast", "slow", "control", "position")
"""What the pair gives; `position` is the relative position itself, without noise where it is simulated."""

Source = tuple[str, bool]
"""An output in the graph, and whether it is read a tick late."""


def wire(graph: Graph, made: Block, wanted: np.ndarray, seen: Mapping[str, Source], sink: str) -> Record:
    """Add reference, controller and recorder to a graph that has the pair, and prepare it.

    Parameters
    ----------
    graph : Graph
    made : Block
        InternalModel or ValvePosition, of as many axes as `wanted` has.
    wanted : array, shape (samples, axes), m
        The reference.
    seen : mapping of str to (str, bool)
        Where each of `MEASURED` comes from.
    sink : str
        The block that takes `fast_reference` and `slow_reference`.

    Returns
    -------
    Record
        Of `reference`, what the pair gives, and all that the controller makes.
    """
    axes = wanted.shape[1]
    names = tuple(f"reference_{axis}" for axis in range(axes))
    graph.add("wanted", Replay(Recording(names, ("m",) * axes, graph.rate, wanted), {"reference": names}))
    graph.add("controller", made)
    sources = {"reference": ("wanted.reference", False), **seen}
    answers = {port.name: f"controller.{port.name}" for port in made.outputs}
    for port in made.inputs:
        graph.connect(sources[port.name][0], f"controller.{port.name}", delayed=sources[port.name][1])
    for name in ("fast_reference", "slow_reference"):
        graph.connect(answers[name], f"{sink}.{name}")
    ports = [Port(name, "m/s" if name == "control" else "m", axes) for name in sources]
    ports += [Port(_told(port.name), port.unit, port.width) for port in made.outputs]
    record = Record(ports, len(wanted))
    graph.add("record", record)
    for name, (source, delayed) in sources.items():
        graph.connect(source, f"record.{name}", delayed=delayed and name != "control")
    for name, source in answers.items():
        graph.connect(source, f"record.{_told(name)}")
    graph.prepare()
    return record


def split(record: Record, axes: int, lead: int) -> list[Recording]:
    """Return what was recorded from sample `lead` on, a recording an axis, named as that of one axis alone.

    Parameters
    ----------
    record : Record
        Of `wire`.
    axes : int
    lead : int, samples
    """
    whole = record.recording()
    edges = np.cumsum([0, *(port.width for port in record.inputs)])
    found = []
    for axis in range(axes):
        columns, names, units = [], [], []
        for port, start in zip(record.inputs, edges, strict=False):
            width = port.width // axes
            columns += list(range(start + axis * width, start + (axis + 1) * width))
            names += [port.name] if width == 1 else [f"{port.name}_{place + 1}" for place in range(width)]
            units += [port.unit] * width
        found.append(Recording(tuple(names), tuple(units), whole.rate, whole.data[lead:, columns].copy()))
    return found


def _told(name: str) -> str:
    """Return under which name a controller's output is recorded: its own control signal beside the pair's."""
    return "foreseen_control" if name == "control" else name


def refuse_unready(record: Record, lead: int) -> None:
    """Raise ValueError where a controller that must estimate first had not done so when the lead was over."""
    whole = record.recording()
    columns = [place for place, name in enumerate(whole.names) if name.partition("_")[0] == "active"]
    if columns and not whole.data[min(lead, len(whole.data) - 1), columns].all():
        raise ValueError(
            f"the models are not accurate after session.lead of {lead / whole.rate:g} s: let the estimation phase "
            "last longer, excite more, or allow estimating.accuracy to be worse"
        )
