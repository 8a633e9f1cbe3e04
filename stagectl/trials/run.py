"""A trial from its first sample to its last, or out of the material and into rest: a fault ends in a named reason."""

from rigkit.experiment.runner import STOPPED
from stagectl.devices.signals import Signal, named
from stagectl.trials.conduct import AFTERWARDS, Conduct, Milled
from stagectl.trials.recorded import RATE
from stagectl.trials.surroundings import Surroundings
from stagectl.trials.trial import Trial
from stagectl.trials.trial_graph import TrialGraph

CHUNK = 80
"""Ticks between two looks at faults, and at whether the run is to stop."""
FOLLOW = 0.4
"""s from the beginning, from which on the robot follows: it has been heard by then."""


def run(
    trial: Trial,
    conduct: Conduct,
    surroundings: Surroundings,
    recorded: dict[str, tuple[Signal, ...]],
    about: dict[str, str],
) -> Milled:
    """Run a trial.

    A blind tracker or a force sensor at fault lifts the tool out of the material; a robot that is at fault itself is
    held where it is.

    Parameters
    ----------
    trial : Trial
    conduct : Conduct
    surroundings : Surroundings
    recorded : dict of str to tuple of Signal
        What is recorded, by the name of the recording.
    about : dict of str to str
        Provenance of the recordings.
    """
    made = TrialGraph(trial, conduct.tell, surroundings, recorded)
    graph, total, begins = made.graph, made.total, round(FOLLOW * RATE)
    left = round((trial.cell.limits.stop + AFTERWARDS) * RATE)
    for done in sorted({begins, *range(CHUNK, total, CHUNK), total}):
        conduct.advance(graph, done - graph.ticks)
        conduct.show(done)
        if done == begins:
            made.follow()
        if conduct.stopped():
            made.path.retreat(STOPPED)
        if made.port.reason or made.path.is_clear:
            conduct.advance(graph, min(left, total - done))
            break
    conduct.rest()
    kept = {name: named(made.records[name], signals, about) for name, signals in recorded.items()}
    return Milled(kept, made.reason, made.figures())
