"""What died away, as zero: numbers too small to be normal take some processors a hundred times as long."""

from rigkit.compiled import njit

LEAST = 1e-150
"""In any unit.  A product of two that are no smaller is still a normal number, beyond 2.3e-308."""


@njit(cache=True, nogil=True, inline="always")
def flushed(value: float) -> float:
    """Return a state of a recursion; zero where it has died away, which no sum with a number of use would show.

    A decaying state is rounded to itself at the smallest number there is, and would stay there.

    Parameters
    ----------
    value : float, any unit

    Examples
    --------
    >>> flushed(1e-149), flushed(-1e-151), flushed(float("nan"))
    (1e-149, 0.0, nan)
    """
    return 0.0 if abs(value) < LEAST else value
