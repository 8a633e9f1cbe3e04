"""The pair of manipulators in a graph: simulated, behind its wires, or as it was recorded; the same signals of each."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ctlblocks import Graph
from ctlblocks.recording import Recording
from ctlblocks.replay import Replay
from ctlblocks.taps import Tap
from rigkit.named_code import named_block
from stagectl.experiments.midranging.graph import MEASURED
from stagectl.experiments.midranging.wired_blocks import LivePair, LiveSeen, LiveSend
from stagectl.robot.midranging_config import MidrangeConfig


@dataclass(frozen=True)
class Wired:
    """Where a pair is in a graph.

    Parameters
    ----------
    seen : mapping of str to Tap
        Of `MEASURED`.
    sink : str or None
        The block that takes what the controller asks for; none where the pair is a recording.
    """

    seen: Mapping[str, Tap]
    sink: str | None


Pair = Callable[[Graph], Wired]
"""Adds a pair to a graph, whatever its make."""


def simulated(config: MidrangeConfig, options: Mapping[str, Any]) -> Pair:
    """Return the pair that the rig file names.

    Parameters
    ----------
    config : MidrangeConfig
    options : mapping
        Keywords over those of the rig file; times count from the end of the lead.
    """
    lead, given = config.session.lead, {**config.simulator.options, **options}
    if "gains" in given:
        given["gains"] = tuple((time + lead, gain) for time, gain in given["gains"])
    if "disturbed_at" in given:
        given["disturbed_at"] += lead
    block = named_block(config.simulator.plant, given)

    def add(graph: Graph) -> Wired:
        graph.add("pair", block)
        return Wired({name: Tap(name, f"pair.{name}", delayed=True) for name in MEASURED}, "pair")

    return add


def wired(pair: LivePair, smoothing: float) -> Pair:
    """Return the pair behind open wires.

    Parameters
    ----------
    pair : LivePair
    smoothing : float, s, > 0
        As of `LiveSend`.
    """

    def add(graph: Graph) -> Wired:
        graph.add("seen", LiveSeen(pair))
        graph.add("send", LiveSend(pair, smoothing))
        return Wired({name: Tap(name, f"seen.{name}") for name in MEASURED}, "send")

    return add


def recorded(recording: Recording, channels: Mapping[str, Sequence[str]]) -> Pair:
    """Return the pair as a recording has it.

    Parameters
    ----------
    recording : Recording
    channels : mapping of str to sequence of str
        Of each of `MEASURED`, an axis each.
    """

    def add(graph: Graph) -> Wired:
        graph.add("recorded", Replay(recording, channels))
        return Wired({name: Tap(name, f"recorded.{name}") for name in MEASURED}, None)

    return add
