"""What may be asked of an identification: numbers that are none are refused by name."""

import operator
from typing import Any, Literal, get_args

import numpy as np

from calibration.subspace.realization import Method


def check(rate: Any, method: Any, stable: Any, direct: Any) -> None:
    """Refuse what is no rate, no method, or neither yes nor no.

    Raises
    ------
    ValueError : which, what it is and what it must be.
    """
    check_rate(rate)
    if method not in ("auto", *get_args(Method)):
        raise ValueError(f"method is {method!r}, must be one of auto, {', '.join(get_args(Method))}")
    if not isinstance(stable, bool | np.bool_):
        raise ValueError(f"stable is {stable!r}, must be True or False")
    if not isinstance(direct, bool | np.bool_) and not (isinstance(direct, str) and direct == "auto"):
        raise ValueError(f"direct is {direct!r}, must be True, False or 'auto'")


def check_rate(rate: Any) -> None:
    """Refuse what is no rate.

    Raises
    ------
    ValueError : what it is and what it must be.
    """
    try:
        known = not isinstance(rate, bool | str) and np.ndim(rate) == 0 and bool(np.isfinite(rate) and rate > 0)
    except (TypeError, ValueError):
        known = False
    if not known:
        raise ValueError(f"rate is {rate!r}, must be a number > 0, samples/s")


def order_of(order: Any, name: str = "order") -> int | None:
    """Return an order, or none where it is to be found.

    Raises
    ------
    ValueError : no whole number of 1 or more.
    """
    if order is None:
        return None
    if (found := _whole(order)) is None or not found >= 1:
        raise ValueError(f"{name} is {order!r}, must be a whole number >= 1, or None: it is found then")
    return found


def horizon_of(horizon: Any) -> tuple[int, int] | None:
    """Return past and future horizons, or none where they are to be found.

    Raises
    ------
    ValueError : no whole number, and no two of them.
    """
    if horizon is None:
        return None
    both = [horizon, horizon] if _whole(horizon) is not None else horizon
    parts = [_whole(each) for each in both] if hasattr(both, "__iter__") and not isinstance(both, str) else []
    if len(parts) != 2 or None in parts:
        raise ValueError(f"horizon is {horizon!r}, must be a number of samples, or two: past and future")
    past, future = (int(each or 0) for each in parts)
    if not (past >= 1 and future >= 2):
        raise ValueError(f"horizon is {past} past and {future} future samples, must be at least 1 and 2")
    return past, future


def delay_of(delay: Any, inputs: int, longest: int) -> tuple[int, ...] | Literal["auto"]:
    """Return the delay of each input, or that they are to be found.

    Parameters
    ----------
    delay : int or sequence of int, samples, or "auto"
    inputs : int
    longest : int, samples
        Of the longest record.

    Raises
    ------
    ValueError : not one delay or one for each input, a negative one, or one as long as a record.
    """
    if isinstance(delay, str) and delay == "auto":
        return "auto"
    one = _whole(delay)
    several = not isinstance(delay, str) and hasattr(delay, "__iter__")
    late = [one] * inputs if one is not None else [_whole(each) for each in delay] if several else [None]
    if None in late:
        raise ValueError(f"delay is {delay!r}, must be 'auto', whole samples or as many for each input")
    if len(late) != inputs:
        raise ValueError(f"delay has {len(late)} entries, must be one number or one for each of {inputs} inputs")
    if not all(each is not None and 0 <= each < longest // 2 for each in late):
        raise ValueError(f"delay is {delay}, must be 0 to {longest // 2 - 1} samples, half of the longest record")
    return tuple(int(each or 0) for each in late)


def _whole(value: Any) -> int | None:
    if isinstance(value, bool | np.bool_):
        return None
    try:
        return operator.index(value)
    except TypeError:
        return None
