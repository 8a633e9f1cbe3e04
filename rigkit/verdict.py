"""A verdict on one thing about a rig: what was measured, what is allowed, and what to do."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

Grade = Literal["pass", "warn", "fail"]


@dataclass(frozen=True)
class Verdict:
    """One row of what the doctor says.

    Parameters
    ----------
    check : str
        What was looked at.
    grade : "pass", "warn" or "fail"
    measured : str
        In words, with units.
    limit : str
        What it must be to pass, in words.
    advice : str
        What to do; empty when it passes.
    value : float
        The figure that decided it, NaN where there is none.
    unit : str
    detail : mapping of str to float
        Figures behind it, for programs.
    """

    check: str
    grade: Grade
    measured: str
    limit: str
    advice: str = ""
    value: float = math.nan
    unit: str = ""
    detail: Mapping[str, float] = field(default_factory=dict)

    def figures(self) -> dict[str, Any]:
        """Return it for `--json`."""
        shown = {name: getattr(self, name) for name in ("check", "measured", "limit", "advice", "value", "unit")}
        return {"verdict": self.grade, **shown, "detail": dict(self.detail)}


def graded(value: float, wanted: float, worst: float) -> Grade:
    """Grade a figure that must be small.

    Parameters
    ----------
    value : float
    wanted, worst : float, in the unit of the value
        It passes up to the one and fails beyond the other.  NaN fails.

    Examples
    --------
    >>> [graded(value, -60.0, -50.0) for value in (-60.0, -55.0, -49.0, math.nan)]
    ['pass', 'warn', 'fail', 'fail']
    """
    if value <= wanted:
        return "pass"
    return "warn" if value <= worst else "fail"


def advice(verdicts: Sequence[Verdict]) -> list[str]:
    """Return what to do, a line for each different advice, with the checks that it is for.

    Examples
    --------
    >>> advice([Verdict("hum", "fail", "-30 dB", "-60 dB", "one ground"), unmeasured("clock", "the card failed")])
    ['hum: one ground', 'clock: put that right first, then look again']
    """
    checks: dict[str, list[str]] = {}
    for each in verdicts:
        if each.advice:
            checks.setdefault(each.advice, []).append(each.check)
    return [f"{', '.join(of)}: {what}" for what, of in checks.items()]


def unmeasured(check: str, why: str) -> Verdict:
    """Return a warning that something could not be looked at."""
    return Verdict(check, "warn", f"not measured: {why}", "", "put that right first, then look again")
