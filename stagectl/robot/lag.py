"""How much later than the quickest a message with a time stamp of another clock comes."""

from collections import deque


class Lag:
    """Compares a sender's clock with ours by the quickest messages of the last seconds.

    Parameters
    ----------
    memory : float, s
        Crystals part by 1e-4 at most, so the quickest of 10 s tells the clocks apart to 1 ms.

    Examples
    --------
    >>> lag = Lag()
    >>> [round(lag.take(stamp, now), 3) for stamp, now in ((5.0, 100.01), (5.1, 100.1), (5.2, 100.25))]
    [0.0, 0.0, 0.05]
    """

    def __init__(self, memory: float = 10.0) -> None:
        self._memory = memory
        self._quickest: deque[tuple[float, float]] = deque()

    def take(self, stamp: float, now: float) -> float:
        """Return how much later a message stamped `stamp` (s, its clock) has come `now` (s) than the quickest, s."""
        offset, kept = now - stamp, self._quickest
        while kept and kept[-1][1] >= offset:
            kept.pop()
        kept.append((now, offset))
        while now - kept[0][0] > self._memory:
            kept.popleft()
        return offset - kept[0][1]

    def since(self, stamp: float, now: float) -> float:
        """Return how old what was stamped `stamp` (s) is `now` (s), beside the quickest message's way, s."""
        return now - stamp - self._quickest[0][1] if self._quickest else 0.0

    def forget(self) -> None:
        """Begin anew: the sender has."""
        self._quickest.clear()
