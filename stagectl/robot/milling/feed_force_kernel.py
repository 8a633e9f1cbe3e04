"""The compiled kernel of force-controlled feed: observer, estimates, outer and inner loop, and what goes wrong.

Numba's cache looks at the date of this file alone: change it with the kernels that it is made of.
"""

import math

import numpy as np
from numba import njit

from stagectl.robot.milling import cutting_estimate_kernel as cutting
from stagectl.robot.milling import force_gain_kernel as outer
from stagectl.robot.milling import velocity_loop_kernel as inner
from stagectl.robot.milling.feed_record import (
    APPROACHING,
    CONTROLLING,
    ESTIMATING,
    IDLE,
    OVERLOAD,
    RETREATED,
    RETREATING,
    SENSOR,
)

Signals = tuple[np.ndarray, ...]
"""Of a frame, shape (frames, 1) each, the force (frames, 2): what is seen, then what is made, as `FeedForce` has it."""


@njit(cache=True, nogil=True)
def _begin(feed: np.record) -> None:
    """Begin a segment at rest: what was learned stays, but is in doubt."""
    feed.phase, feed.reason, feed.wanted = APPROACHING, 0, 0.0
    feed.last_velocity = feed.last_force = feed.back = 0.0
    feed.touched = feed.lost = feed.strained = feed.blind = 0
    inner.rest(feed.loop)
    for i in range(feed.loop.states):
        feed.loop.state[i] = 0.0
    feed.cutting.kappa_variance, feed.cutting.beta_variance = feed.kappa_doubt, feed.beta_doubt
    feed.cutting.is_fresh = 0


@njit(cache=True, nogil=True)
def retreat(feed: np.record, reason: int) -> None:
    """Go back, or, between segments, where that may lead into the wood, stay."""
    feed.phase = RETREATING if feed.phase != IDLE else RETREATED
    feed.reason, feed.back = reason, 0.0


@njit(cache=True, nogil=True)
def _watch(feed: np.record, force: float, along: float, is_seen: bool) -> None:
    """Go over to another phase where contact, force or sensor say so."""
    feed.blind = 0 if is_seen else feed.blind + 1
    if feed.blind >= feed.blind_samples and feed.phase != IDLE:
        retreat(feed, SENSOR)
        return
    if not is_seen:
        return
    feed.strained = feed.strained + 1 if abs(force) > feed.overload else 0
    feed.touched = feed.touched + 1 if along > feed.contact else 0
    feed.lost = feed.lost + 1 if along < 0.5 * feed.contact else 0
    if feed.strained >= feed.overload_samples:
        retreat(feed, OVERLOAD)
    elif feed.phase == IDLE:
        return
    elif feed.phase == APPROACHING and feed.touched >= feed.contact_samples:
        feed.phase = ESTIMATING
    elif feed.phase != APPROACHING and feed.lost >= feed.lost_samples:
        feed.phase = APPROACHING


@njit(cache=True, nogil=True)
def _is_known(feed: np.record) -> bool:
    known: bool = feed.cutting.kappa_variance < feed.kappa_enough and feed.cutting.beta_variance < feed.beta_enough
    return known


@njit(cache=True, nogil=True)
def _controlled(feed: np.record, velocity: float, force: float) -> float:
    """Return the feed that the outer loop wants, m/s; from sample to sample, so that new gains make no step."""
    if feed.is_adapted:
        kappa, wide = feed.cutting.kappa, cutting.widening(feed.cutting)
    else:
        kappa, wide = feed.fixed_kappa, feed.fixed_widening
    on_velocity, on_force, on_error = outer.gains(kappa, wide, feed.outer)
    moved, risen = velocity - feed.last_velocity, force - feed.last_force
    error = feed.force - feed.last_force
    wanted: float = feed.wanted - on_velocity * moved - on_force * risen + on_error * feed.outer.period * error
    return wanted


@njit(cache=True, nogil=True)
def _wanted(feed: np.record, velocity: float, force: float) -> float:
    """Return the feed wanted in this phase, m/s."""
    phase, wanted = feed.phase, 0.0
    if phase == APPROACHING or phase == ESTIMATING:
        most = feed.initial if phase == APPROACHING else feed.risen
        wanted = feed.wanted
        if not force >= feed.enough:
            wanted = min(most, max(feed.approach, feed.wanted * feed.rise))
    elif phase == CONTROLLING:
        wanted = _controlled(feed, velocity, force)
    elif phase == RETREATING:
        wanted = -feed.retreat
    return wanted


@njit(cache=True, nogil=True)
def _limited(feed: np.record, wanted: float) -> float:
    """Return the feed within its limits of speed and acceleration; a retreat has only that of speed."""
    if feed.phase >= RETREATING:
        return wanted
    low, high = feed.wanted - feed.step, feed.wanted + feed.step
    limited: float = min(max(wanted, low, 0.0), high, feed.most)
    return limited


@njit(cache=True, nogil=True)
def _step(feed: np.record, measured: float, along: float, across: float, is_valid: bool, is_running: bool) -> None:
    """Do a sample: velocity (m/s), force along and across (N), whether they are to be had, whether it runs."""
    if is_running and feed.phase == IDLE:
        _begin(feed)
    elif not is_running and feed.phase < RETREATING:
        feed.phase = IDLE
    velocity = inner.observe(feed.loop, measured)
    is_seen = is_valid and math.isfinite(along + across)
    force = math.copysign(math.hypot(along, across), along) if is_seen else feed.last_force
    if feed.phase <= CONTROLLING:
        if is_seen and math.isfinite(measured) and feed.phase != IDLE:
            cutting.observe(feed.cutting, measured, along, across)
        _watch(feed, force, along, is_seen)
        if feed.phase == ESTIMATING and _is_known(feed):
            feed.phase, feed.last_velocity, feed.last_force = CONTROLLING, velocity, force
    feed.wanted = _limited(feed, _wanted(feed, velocity, force))
    feed.last_velocity, feed.last_force = velocity, force
    if feed.phase == IDLE or feed.phase == RETREATED:
        feed.wanted = 0.0
        inner.rest(feed.loop)
    else:
        inner.control(feed.loop, feed.wanted, velocity)
    if feed.phase == RETREATING:
        feed.back -= feed.loop.asked * feed.loop.period
        if feed.back >= feed.distance:
            feed.phase = RETREATED


@njit(cache=True, nogil=True)
def run(seen: Signals, made: Signals, feeds: np.ndarray) -> None:
    """Run one frame: `feeds` (1,) of `FEED`."""
    feed, (velocity, force, is_valid, is_running) = feeds[0], seen
    reference, wanted, estimated, resultant, kappa, kappa_deviation, beta, beta_deviation, phase = made
    for n in range(len(velocity)):
        _step(feed, velocity[n, 0], force[n, 0], force[n, 1], is_valid[n, 0] > 0.5, is_running[n, 0] > 0.5)
        estimated[n, 0], resultant[n, 0] = feed.last_velocity, feed.last_force
        reference[n, 0], wanted[n, 0], phase[n, 0] = feed.loop.asked, feed.wanted, feed.phase
        kappa[n, 0], beta[n, 0] = feed.cutting.kappa, feed.cutting.beta
        kappa_deviation[n, 0] = math.sqrt(feed.cutting.kappa_variance)
        beta_deviation[n, 0] = math.sqrt(feed.cutting.beta_variance)
