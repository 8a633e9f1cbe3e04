"""What both ends count: of the frames from the stage, and in the stage's own account of those from the host."""

from dataclasses import dataclass, field


@dataclass
class Lasers:
    """The stage's account of its lasers, ten times a second while it reads them.

    Parameters
    ----------
    age : float, s, greatest of a reading that the stage has worked with
    held : int, invalid readings that it has held off since it began to follow
    axis : int, whose laser is at fault: 1 to 3, or 0
    lost : int, blocks of positions that came without what lasers saw: all of them where none is read
    """

    age: float = 0.0
    held: int = 0
    axis: int = 0
    lost: int = 0

    def take(self, age: float, held: int, axis: int) -> None:
        """Take one account.

        Parameters
        ----------
        age : float, s
        held, axis : int
        """
        self.age, self.held, self.axis = max(self.age, age), held, axis


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
    lasers : Lasers
    """

    received: int = 0
    lost: int = 0
    late: int = 0
    garbled: int = 0
    longest_gap: int = 0
    longest_silence: float = 0.0
    lasers: Lasers = field(default_factory=Lasers)


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
