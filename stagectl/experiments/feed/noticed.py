"""What force control noticed in a recorded run: when, in which segment, and what."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ctlblocks.recording import Recording
from stagectl.experiments.feed.process_run import channel
from stagectl.robot.milling.feed_notices import words

NOTICE = "notice"
"""The channel, which only a recording of force control has."""


@dataclass(frozen=True)
class Noticed:
    """Something that force control has noticed.

    Parameters
    ----------
    time : float, s
        From the beginning of the recording.
    segment : int
        From 1; 0 where there are none.
    what : str
    """

    time: float
    segment: int
    what: str


def noticed(record: Recording) -> tuple[Noticed, ...]:
    """Return what was noticed, in the order of time.

    Parameters
    ----------
    record : Recording
    """
    if NOTICE not in record.names:
        return ()
    bits = channel(record, NOTICE).astype(int)
    risen = bits & ~np.concatenate([[0], bits[:-1]])
    number = channel(record, "number").astype(int) if "number" in record.names else np.zeros(len(bits), int)
    return tuple(
        Noticed(float(n / record.rate), int(number[n]), text)
        for n in np.flatnonzero(risen)
        for text in words(int(risen[n]))
    )


def notice_rows(found: Sequence[Noticed]) -> tuple[tuple[str, str, str], ...]:
    """Return what was noticed as text: time, segment, what."""
    return tuple((f"{each.time:.2f}", f"{each.segment}", each.what) for each in found)
