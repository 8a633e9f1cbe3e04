"""The compiled kernel that watches force-controlled feed: contact, overload, a sensor that is blind or stuck."""

import math

from rigkit.compiled import njit
from rigkit.record import Record
from stagectl.robot.milling import cutting_estimate_kernel as cutting
from stagectl.robot.milling.feed_record import (
    APPROACHING,
    ESTIMATING,
    IDLE,
    OVERLOAD,
    RETREATED,
    RETREATING,
    SCALE,
    SENSOR,
    STUCK,
    UNFAMILIAR,
)


@njit(cache=True, nogil=True)
def retreat(feed: Record, reason: int) -> None:
    """Go back, or, between segments, where that may lead into the wood, stay."""
    feed.phase = RETREATING if feed.phase != IDLE else RETREATED
    feed.reason, feed.back = reason, 0.0


@njit(cache=True, nogil=True)
def _count(feed: Record, along: float, across: float) -> None:
    """Count the samples of contact and without it, and those in which the sensor shows the same again."""
    force = math.hypot(along, across)
    feed.touched = feed.touched + 1 if force > feed.contact else 0
    feed.lost = feed.lost + 1 if math.hypot(feed.smooth_along, feed.smooth_across) < 0.5 * feed.contact else 0
    is_same = along == feed.last_along and across == feed.last_across
    feed.stuck = feed.stuck + 1 if is_same and (feed.phase > APPROACHING or feed.stuck > 0) else 0
    feed.last_along, feed.last_across = along, across


@njit(cache=True, nogil=True)
def observe(feed: Record, along: float, across: float, is_seen: bool) -> None:
    """Go over to another phase where contact, force or sensor say so; forces in N."""
    feed.blind = 0 if is_seen else feed.blind + 1
    if feed.blind >= feed.blind_samples and feed.phase != IDLE:
        retreat(feed, SENSOR)
        return
    if not is_seen:
        return
    _count(feed, along, across)
    if feed.strained >= feed.overload_samples:
        retreat(feed, OVERLOAD)
    elif feed.phase == IDLE:
        return
    elif feed.stuck >= feed.stuck_samples:
        retreat(feed, STUCK)
    elif feed.phase == APPROACHING and feed.touched >= feed.contact_samples:
        feed.phase = ESTIMATING
    elif feed.phase != APPROACHING and feed.lost >= feed.lost_samples:
        feed.phase, feed.returning = APPROACHING, max(feed.approach, feed.wanted)


@njit(cache=True, nogil=True)
def recognize(feed: Record) -> None:
    """Notice a kappa that this material cannot have, and retreat where by what it can have the force is an overload."""
    known = feed.cutting
    ratio = known.kappa / known.guess
    is_strange = ratio > feed.familiar or ratio * feed.familiar < 1.0
    has_begun = feed.waves.samples > feed.familiar_samples  # while the tool goes in, less of it cuts
    feed.strange = feed.strange + 1 if is_strange and has_begun else 0
    if feed.strange < feed.familiar_samples:
        return
    feed.notice |= SCALE
    if feed.waves.level * ratio / feed.familiar > feed.overload:
        retreat(feed, UNFAMILIAR)


@njit(cache=True, nogil=True)
def _settled(noise: float, drift: float, regressor: float) -> float:
    """Return the variance that a random walk's filter comes to at a constant regressor."""
    return 0.5 * (math.sqrt(drift * drift + 4.0 * drift * noise / (regressor * regressor)) - drift)


@njit(cache=True, nogil=True)
def is_known(feed: Record, force: float) -> bool:
    """Return whether kappa and beta are known about as well as they come to be at this force, N."""
    known, wide = feed.cutting, cutting.widening(feed.cutting)
    level = max(force, known.gate)
    kappa = _settled(cutting.kappa_noise(known), cutting.kappa_drift(known), level)
    beta = _settled(cutting.beta_noise(known), known.beta_drift, level / wide)
    enough: bool = known.kappa_variance < feed.activation * kappa and known.beta_variance < feed.activation * beta
    return enough
