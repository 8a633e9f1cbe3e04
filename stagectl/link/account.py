"""What both ends count: of the frames from the stage, and in the stage's own account of those from the host."""

from dataclasses import dataclass


@dataclass
class Counts:
    """What became of the frames from the stage.

    Parameters
    ----------
    received, lost, late, garbled : int, frames
        Lost: missing before the next one, told by the counter; late: after their place was filled, or twice.
    longest_gap : int, frames lost in a row
    longest_silence : float, s
        Without a heartbeat of the stage, while it was to follow.
    """

    received: int = 0
    lost: int = 0
    late: int = 0
    garbled: int = 0
    longest_gap: int = 0
    longest_silence: float = 0.0


@dataclass(frozen=True)
class Status:
    """The stage's own account, ten times a second.

    Parameters
    ----------
    time : float, s since it was switched on
    block : int, its newest
    parameters : int, CRC-32 of the set in use
    lost, late, garbled, underruns : int, of the references
    reference : int, counter of the newest reference
    waiting : int, references that have come and are not yet played
    silence : float, s
        Longest without the host's heartbeat, or without a reference, since the stage began to follow.
    """

    time: float
    block: int
    parameters: int
    lost: int
    late: int
    garbled: int
    underruns: int
    reference: int
    waiting: int
    silence: float
