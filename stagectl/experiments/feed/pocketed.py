"""A pocket that was milled: how it was to be, its recording, and the segments that were finished."""

from dataclasses import dataclass

from ctlblocks.recording import Recording
from stagectl.experiments.feed.plan import FeedPlan
from stagectl.planning.milling import Milled


@dataclass(frozen=True)
class Pocketed:
    """What came of a pocket.

    Parameters
    ----------
    recording : Recording
    segments : tuple of Milled
        Those that were finished, as measured.
    reason : str
        Why it was held, or nothing.
    """

    recording: Recording
    segments: tuple[Milled, ...]
    reason: str


@dataclass(frozen=True)
class Kept:
    """A pocket of a run.

    Parameters
    ----------
    plan : FeedPlan
    done : Pocketed
    """

    plan: FeedPlan
    done: Pocketed
