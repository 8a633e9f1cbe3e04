"""Where the shots of recordings are cut, and by how much responses are put earlier: decided from what they show."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from vibractl.foreign.estimate import CERTAIN, Estimate
from vibractl.foreign.examination import Examined
from vibractl.foreign.recorded import Recorded
from vibractl.proof import SLIP

LEAST = 0.5
"""samples: a delay below is none, since nothing is moved by parts of a sample."""


@dataclass(frozen=True)
class Placed:
    """Where a shot lies in its files; samples of the reference's first one.

    Parameters
    ----------
    response : int, samples
        In the response's file.
    drive : int, samples
        In the drive's file.
    fraction : float, samples
        By which the response comes later than that.
    is_exact : bool
        Whether the fraction is known to less than a slip.
    delay : Estimate or None, samples
        By which the response comes after the drive, taken out or not; None where nothing tells.
    removed : int, samples
        What of it is taken out.
    """

    response: int
    drive: int
    fraction: float
    is_exact: bool
    delay: Estimate | None
    removed: int


class Placing:
    """Places the shots of one session, from which one delay is taken out.

    Parameters
    ----------
    lead : int, samples
        Silence before the reference.
    given : float or None, samples
        The delay, where a person knows it.
    shots : sequence of (Examined, Recorded)
        All of the session.
    """

    def __init__(self, lead: int, given: float | None, shots: Sequence[tuple[Examined, Recorded]]) -> None:
        self._lead, self._given = lead, None if given is None else Estimate(given, 0.0)
        found = [late for seen, recorded in shots if (late := self._delay(seen, recorded)) is not None]
        best = min(found, key=lambda late: late.error) if found else Estimate(0.0, 0.0)
        self._removed = round(best.value) if best.is_told and abs(best.value) > LEAST else 0

    def placed(self, seen: Examined, recorded: Recorded, begins: float) -> Placed:
        """Place a shot.

        Parameters
        ----------
        seen : Examined
        recorded : Recorded
        begins : float, samples
            Where the reference begins in the drive of one shot, where that does not lie beside.
        """
        if not recorded.has_drive:
            return _unrecorded(seen, begins)
        is_exact, apparent = _is_exact(recorded), _apparent(seen)
        late = self._given or seen.late
        removed = 0 if late is None else self._removed
        place, error = seen.played.value + removed, seen.played.error
        if seen.heard is not None:
            off = abs(seen.heard.value - place)
            if not (is_exact and off <= max(CERTAIN * seen.heard.error, LEAST)):
                place, error = seen.heard.value, seen.heard.error
        if late is None and abs(place - seen.played.value) > self._lead / 2:  # too long for a vibrator
            removed = round(place - seen.played.value)
        response = round(place)
        played = response - removed
        drive = played if recorded.is_beside else round(begins + played - seen.played.value)
        return Placed(response, drive, place - response, error <= SLIP, late or apparent, removed)

    def _delay(self, seen: Examined, recorded: Recorded) -> Estimate | None:
        """Return the delay that a shot shows: of two estimates that agree the better one."""
        late = self._given or seen.late
        if late is None or not recorded.has_drive:
            return None
        apparent = _apparent(seen) if _is_exact(recorded) else None
        if apparent is None or apparent.error >= late.error:
            return late
        apart = abs(apparent.value - late.value)
        return apparent if apart <= CERTAIN * math.hypot(apparent.error, late.error) else late


def _is_exact(recorded: Recorded) -> bool:
    """Whether it is known to a part of a sample where the reference begins in the drive."""
    return recorded.begins is not None or not recorded.is_beside


def _apparent(seen: Examined) -> Estimate | None:
    """Return by how much the reference is heard later than the drive begins."""
    if seen.heard is None:
        return None
    misfit = math.hypot(seen.heard.misfit, seen.played.misfit)
    return Estimate(seen.heard.value - seen.played.value, seen.heard.noise, misfit)


def _unrecorded(seen: Examined, begins: float) -> Placed:
    """Place a shot of which the response alone is recorded: how late that comes, nothing tells."""
    place, error = seen.played.value, seen.played.error
    if seen.late is not None:
        place, error = place + seen.late.value, seen.late.error
    elif seen.heard is not None:
        place, error = seen.heard.value, seen.heard.error
    return Placed(round(place), round(begins), place - round(place), error <= SLIP, None, 0)
