"""A torque-position map: what a motor pushed and where it stood while one joint was moved to and fro."""

from dataclasses import dataclass

import numpy as np

from rigkit.compiled import njit

TURN = 0.15
"""Part of the span by which a motion must go back before it counts as a reversal."""

MOST_SAMPLES = 6_000
"""More are averaged in blocks: motions are slow, and averaging loses nothing but noise."""

FEWEST_SAMPLES = 100
FEWEST_REVERSALS = 3
"""Two whole sweeps in each direction, less the parts before the first reversal and after the last."""


class TorqueMapError(ValueError):
    """A record from which no torque-position map can be made; says what is wrong with it."""


@dataclass(frozen=True)
class TorqueMap:
    """A record of one joint, both quantities on the joint's side of the gear.

    Parameters
    ----------
    angle : array, shape (samples,), rad
        Of the motor, divided by the gear ratio.
    torque : array, shape (samples,), N m
        Of the motor, times the gear ratio.
    rate : float, samples/s
    """

    angle: np.ndarray
    torque: np.ndarray
    rate: float

    def __post_init__(self) -> None:
        """Refuse what is no record of a joint."""
        if self.angle.ndim != 1 or self.angle.shape != self.torque.shape:
            raise TorqueMapError(f"angle has shape {self.angle.shape}, torque {self.torque.shape}, must be (samples,)")
        if len(self.angle) < FEWEST_SAMPLES:
            raise TorqueMapError(f"the record has {len(self.angle)} samples, must have >= {FEWEST_SAMPLES}")
        for name, values in (("angle", self.angle), ("torque", self.torque)):
            if not np.isfinite(values).all():
                raise TorqueMapError(f"{name}: sample {int(np.isfinite(values).argmin())} is not finite")
            if not np.ptp(values) > 0:
                raise TorqueMapError(f"{name} is {values[0]:g} throughout, must change")
        if not 0 < self.rate < np.inf:
            raise TorqueMapError(f"the rate is {self.rate}, must be > 0 samples/s")

    def thinned(self) -> "TorqueMap":
        """Return the map with at most `MOST_SAMPLES` samples, averaged in blocks."""
        block = -(-len(self.angle) // MOST_SAMPLES)
        whole = len(self.angle) // block * block
        angle, torque = (values[:whole].reshape(-1, block).mean(axis=1) for values in (self.angle, self.torque))
        return TorqueMap(angle, torque, self.rate / block)

    def corrected(self, arm_motion: np.ndarray) -> "TorqueMap":
        """Return the map over the twist of the gear alone: less the motion of the arm's side.

        Parameters
        ----------
        arm_motion : array, shape (samples,), rad
        """
        return TorqueMap(self.angle - arm_motion, self.torque, self.rate)


@dataclass(frozen=True)
class Branches:
    """A map cut at its reversals.

    Parameters
    ----------
    number : array, shape (samples,), integer
        Of the branch a sample belongs to; branch 0 is before the first reversal.
    direction : array, shape (samples,), 1
        +1 where the branch rises, -1 where it falls.
    since : array, shape (samples,), rad
        Distance from the reversal at which the branch began.
    """

    number: np.ndarray
    direction: np.ndarray
    since: np.ndarray

    @property
    def reversals(self) -> int:
        """How often the motion turned."""
        return int(self.number[-1])


def branches(joint: TorqueMap) -> Branches:
    """Cut a map at its reversals.

    Raises
    ------
    TorqueMapError : fewer than `FEWEST_REVERSALS`.
    """
    turned = _turned(joint.angle, TURN * float(np.ptp(joint.angle)))
    number = np.searchsorted(turned, np.arange(len(joint.angle)), side="right")
    starts = np.concatenate([[0], turned])
    if len(turned) < FEWEST_REVERSALS:
        raise TorqueMapError(f"the motion turns {len(turned)} times, must turn >= {FEWEST_REVERSALS} times")
    ends = np.concatenate([turned, [len(joint.angle) - 1]])
    direction = np.sign(joint.angle[ends] - joint.angle[starts])[number]
    return Branches(number, direction, direction * (joint.angle - joint.angle[starts][number]))


@njit(cache=True, nogil=True)
def _turned(angle: np.ndarray, least: float) -> np.ndarray:
    """Return the samples at which the angle is extreme between two motions of at least `least`."""
    found = np.empty(len(angle), np.int64)
    count, direction = 0, 0
    top = bottom = 0
    for n in range(len(angle)):
        if angle[n] > angle[top]:
            top = n
        if angle[n] < angle[bottom]:
            bottom = n
        if direction >= 0 and angle[top] - angle[n] >= least:
            if direction > 0 or top > 0:
                found[count] = top
                count += 1
            direction, bottom = -1, n
            top = n
        elif direction <= 0 and angle[n] - angle[bottom] >= least:
            if direction < 0 or bottom > 0:
                found[count] = bottom
                count += 1
            direction, top = 1, n
            bottom = n
    return found[:count].copy()
