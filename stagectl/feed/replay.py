"""Replay: what robot and force sensor said goes through planner and controllers again; all must come out as it was."""

from collections.abc import Iterator
from pathlib import Path

from rigkit.experiment.replayed import Replayed, compared
from stagectl.feed.job import Repeated, once
from stagectl.feed.recorded import made
from stagectl.feed.run import mill_pocket
from stagectl.feed.session import read_back
from stagectl.feed.surroundings import recorded
from stagectl.trials.conduct import Conduct


def replay_feed(path: Path) -> Iterator[Replayed]:
    """Make every output of a folder's pockets again from their recorded sensors.

    Parameters
    ----------
    path : Path
        Run folder.

    Raises
    ------
    ValueError : nothing is recorded, or the run was stopped by its user.
    """
    job, pockets = read_back(path)
    planner = job.make()
    for each in pockets:
        plan, record = each.plan, each.done.recording
        same = planner if plan.feeds is None else Repeated([segment.cut for segment in each.done.segments])
        again = mill_pocket(plan, once(same), Conduct(), recorded(record), made(plan.control), {})
        if again.reason != each.done.reason:
            raise ValueError(f"{plan.name} was held because {each.done.reason!r}, and is now because {again.reason!r}")
        yield from compared(plan.name, record, again.recording)
