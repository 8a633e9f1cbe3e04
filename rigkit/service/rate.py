"""How often one address may ask: buckets that fill with time and empty with requests."""

from collections import OrderedDict

MOST = 1000
"""Addresses remembered; the one not seen for longest is forgotten."""


class Rates:
    """A bucket for each address.

    Parameters
    ----------
    rate : float, 1/s
        Requests in the long run.
    burst : float
        Requests at once.
    """

    def __init__(self, rate: float, burst: float) -> None:
        self._rate, self._burst = rate, burst
        self._buckets: OrderedDict[str, tuple[float, float]] = OrderedDict()

    def allows(self, address: str, now: float) -> bool:
        """Whether `address` may ask at the time `now`, s; counts it if so."""
        left, then = self._buckets.pop(address, (self._burst, now))
        left = min(self._burst, left + (now - then) * self._rate)
        self._buckets[address] = (left - 1.0 if left >= 1.0 else left), now
        if len(self._buckets) > MOST:
            self._buckets.popitem(last=False)
        return left >= 1.0
