"""What a rig shows of itself: gauges, which change all the time, and panels, which change now and then."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

NEAR = 0.9
"""Part of a limit from which a gauge is near it."""

Role = Literal["measured", "limit", "reference"]
Output = Literal["on", "zero", "unknown"]


@dataclass(frozen=True)
class Gauge:
    """One number that is measured now, and what it may be.

    Parameters
    ----------
    name : str
        For programs: small letters, digits and underscores, the unit not in it.
    title : str
        For people.
    value : float or None
        None, or NaN: not known now.
    unit : str
        "1" for a pure number.
    low, high : float or None
        Limits, where it has any.
    interval : (float, float) or None
        Where the true value lies, for an estimate.
    is_output : bool
        Whether it measures what the rig puts out, which is 0 while nothing moves: `output` goes by it.
    """

    name: str
    title: str
    value: float | None
    unit: str
    low: float | None = None
    high: float | None = None
    interval: tuple[float, float] | None = None
    is_output: bool = False

    @property
    def verdict(self) -> Literal["unknown", "free", "good", "near", "over"]:
        """How the value stands to its limits; "free" where there are none.

        Examples
        --------
        >>> Gauge("drive_peak", "Drive, peak", 8.4, "V", high=9.0).verdict
        'near'
        """
        if self.value is None or not math.isfinite(self.value):
            return "unknown"
        if self.low is None and self.high is None:
            return "free"
        if self._beyond(self.value, 1.0):
            return "over"
        return "near" if self._beyond(self.value, NEAR) else "good"

    def _beyond(self, value: float, part: float) -> bool:
        """Whether a value lies outside `part` of the way from the middle of the limits, or from 0, to a limit."""
        middle = (self.low + self.high) / 2 if self.low is not None and self.high is not None else 0.0
        above = self.high is not None and value > middle + part * (self.high - middle)
        return above or (self.low is not None and value < middle + part * (self.low - middle))

    def plain(self) -> dict[str, Any]:
        """Return it as JSON has it."""
        return {**vars(self), "verdict": self.verdict}


def output(gauges: Iterable[Gauge]) -> Output:
    """Return whether a rig puts something out, of what its gauges measure; unknown where it is not measured.

    Examples
    --------
    >>> output([Gauge("drive_1", "Drive 1", 0.0, "V", is_output=True), Gauge("drive_2", "Drive 2", None, "V")])
    'zero'
    >>> output([Gauge("drive_1", "Drive 1", None, "V", is_output=True)])
    'unknown'
    """
    values = [math.nan if gauge.value is None else gauge.value for gauge in gauges if gauge.is_output]
    if any(value != 0 and not math.isnan(value) for value in values):
        return "on"
    return "zero" if values and not any(map(math.isnan, values)) else "unknown"


@dataclass(frozen=True)
class Axis:
    """What lies along one direction of a panel."""

    title: str
    unit: str
    scale: Literal["linear", "log"] = "linear"


@dataclass(frozen=True, eq=False)
class Trace:
    """One line of `Curves`.

    Parameters
    ----------
    name : str
    x, y : array, shape (points,), units of the panel's axes
        NaN in y is a gap.
    role : "measured", "limit" or "reference"
    low, high : array, shape (points,), unit of y, or None
        The band in which the true values lie, for an estimate.
    """

    name: str
    x: np.ndarray
    y: np.ndarray
    role: Role = "measured"
    low: np.ndarray | None = None
    high: np.ndarray | None = None


@dataclass(frozen=True, eq=False)
class Curves:
    """A panel of lines, or of bars, over one abscissa."""

    title: str
    x: Axis
    y: Axis
    traces: tuple[Trace, ...]
    drawn: Literal["lines", "bars", "points"] = "lines"

    def plain(self) -> dict[str, Any]:
        """Return it as JSON has it."""
        traces = [vars(trace) for trace in self.traces]
        return {"kind": "curves", **vars(self), "x": vars(self.x), "y": vars(self.y), "traces": traces}


@dataclass(frozen=True, eq=False)
class Image:
    """A panel of colours over a plane.

    Parameters
    ----------
    title : str
    x, y, z : Axis
        z: what the colours mean.
    x_range, y_range : (float, float), units of x and y
        Centres of the first and last column, and of the first and last row.
    z_range : (float, float), unit of z
        What the ends of the colour scale mean.
    values : array, shape (rows, columns), unit of z
    """

    title: str
    x: Axis
    y: Axis
    z: Axis
    x_range: tuple[float, float]
    y_range: tuple[float, float]
    z_range: tuple[float, float]
    values: np.ndarray

    def plain(self) -> dict[str, Any]:
        """Return it as JSON has it, the values to three digits of their range."""
        digits = max(0, 3 - math.ceil(math.log10(max(self.z_range[1] - self.z_range[0], 1e-12))))
        axes = {"x": vars(self.x), "y": vars(self.y), "z": vars(self.z)}
        return {"kind": "image", **vars(self), **axes, "values": np.round(self.values, digits)}


@dataclass(frozen=True)
class Table:
    """A panel of rows under a head; a cell is a text, a number or None."""

    title: str
    head: tuple[str, ...]
    rows: tuple[tuple[str | float | None, ...], ...]

    def plain(self) -> dict[str, Any]:
        """Return it as JSON has it."""
        return {"kind": "table", **vars(self)}


Panel = Curves | Image | Table
