"""What a frame's counter says of the frames before it."""


class Sequence:
    """Follow the counters of one kind of frame.

    Parameters
    ----------
    modulus : int
        Where the counter begins again.  Up to half of it may be lost in a row and is still told from being late.

    Examples
    --------
    >>> follow = Sequence(256)
    >>> [follow.accept(counter) for counter in (254, 255, 1, 0, 2)]
    [0, 0, 1, -1, 0]
    """

    def __init__(self, modulus: int) -> None:
        self._modulus = modulus
        self._next: int | None = None

    def accept(self, counter: int) -> int:
        """Return how many frames are missing before this one, or -1 where it comes late or twice."""
        missing = 0 if self._next is None else (counter - self._next) % self._modulus
        if missing >= self._modulus // 2:
            return -1
        self._next = (counter + 1) % self._modulus
        return missing

    def reset(self) -> None:
        """Take the next frame as the first."""
        self._next = None
