"""What can go wrong on the way to and from an audio card, to be played on purpose."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Drop:
    """A block is lost: silence is played, what the card recorded meanwhile is thrown away.

    Parameters
    ----------
    block : int, blocks since the stream was started
    flagged : bool
        Whether the next callback is told (real cards do not always tell).
    """

    block: int
    flagged: bool


@dataclass(frozen=True)
class Slip:
    """From a block on, the recording comes later (or earlier), and nobody is told.

    Parameters
    ----------
    block : int, blocks since the stream was started
    samples : int, later if > 0; more negative than the card's latency is refused
    """

    block: int
    samples: int


@dataclass(frozen=True)
class BadSample:
    """One recorded sample is not what the card saw.

    Parameters
    ----------
    block : int, blocks since the stream was started
    channel : int, input counted from 1
    value : float, full scale
        NaN, for example.
    """

    block: int
    channel: int
    value: float


@dataclass(frozen=True)
class Stall:
    """The callback is called late.

    Parameters
    ----------
    block : int, blocks since the stream was started
    seconds : float, s
    """

    block: int
    seconds: float


Fault = Drop | Slip | BadSample | Stall
