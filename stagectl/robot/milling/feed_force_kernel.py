"""The compiled kernel of force-controlled feed: observer, estimates, outer and inner loop, and what goes wrong."""

import math

import numpy as np

from rigkit.compiled import njit
from rigkit.record import Record
from stagectl.robot.milling import brake_kernel as brake
from stagectl.robot.milling import cutting_estimate_kernel as cutting
from stagectl.robot.milling import feed_watch_kernel as watch
from stagectl.robot.milling import follow_kernel as follow
from stagectl.robot.milling import force_law_kernel as law
from stagectl.robot.milling import velocity_loop_kernel as inner
from stagectl.robot.milling import wave_kernel as waves
from stagectl.robot.milling.feed_record import (
    APPROACHING,
    BRAKED,
    CHATTER,
    CHATTERING,
    CONTROLLING,
    ESTIMATING,
    IDLE,
    MODEL,
    OSCILLATION,
    RETREATED,
    RETREATING,
    RIPPLE,
    UNKNOWN,
)

Signals = tuple[np.ndarray, ...]
"""Of a frame, shape (frames, 1) each, the force (frames, 2): what is seen, then what is made, as `FeedForce` has it."""
SMOOTH = 0.2
"""Of a mean of the forces, in a sample."""
CREEP = 0.02
"""Of the highest feed, to which chatter lowers it at most."""


@njit(cache=True, nogil=True)
def _begin(feed: Record) -> None:
    """Begin a segment at rest: what was learned stays, but is in doubt."""
    feed.phase, feed.reason, feed.wanted, feed.cap = APPROACHING, 0, 0.0, feed.most
    feed.returning = feed.initial
    feed.last_velocity = feed.last_force = feed.back = feed.smooth_along = feed.smooth_across = 0.0
    feed.touched = feed.lost = feed.strained = feed.blind = feed.stuck = feed.estimating = feed.strange = 0
    feed.notice &= MODEL | OSCILLATION
    inner.rest(feed.loop)
    for i in range(feed.loop.states):
        feed.loop.state[i] = 0.0
    follow.begin(feed.follow)
    waves.begin(feed.waves)
    brake.begin(feed.brake)
    feed.cutting.kappa_variance, feed.cutting.beta_variance = feed.kappa_doubt, feed.beta_doubt
    feed.cutting.kappa_left = feed.cutting.kappa_scatter = 0.0
    feed.cutting.beta_left = feed.cutting.beta_scatter = 0.0
    feed.cutting.is_fresh = 0


@njit(cache=True, nogil=True)
def _be_careful(feed: Record, why: int) -> None:
    """Pass the feed on without the inner loop, whose model is in doubt, and control the force more slowly."""
    feed.notice |= why
    if feed.is_careful:
        return
    feed.is_careful = 1
    feed.outer.lag, feed.outer.integral = feed.careful_lag, feed.careful_integral
    feed.wanted = min(max(feed.loop.asked, 0.0), feed.cap)
    if feed.phase == CONTROLLING:
        law.begin(feed, feed.last_velocity, feed.last_force)


@njit(cache=True, nogil=True)
def _judge(feed: Record, measured: float) -> None:
    """Look whether the robot follows as identified, and what of the force is periodic."""
    if follow.observe(feed.follow, feed.loop, measured):
        _be_careful(feed, MODEL)
    if feed.phase != CONTROLLING:
        return
    feed.usual += feed.brake.slow * (feed.wanted - feed.usual)
    if waves.oscillates(feed.waves):
        _be_careful(feed, OSCILLATION)
    if waves.chatters(feed.waves):
        feed.notice |= CHATTER
        feed.cap = max(feed.chatter_share * min(feed.cap, feed.usual), CREEP * feed.most)
    if feed.waves.lasting >= feed.chatter_samples:
        watch.retreat(feed, CHATTERING)
    if feed.waves.weight > 0.0:
        feed.notice |= RIPPLE
    watch.recognize(feed)


@njit(cache=True, nogil=True)
def _is_braked(feed: Record, velocity: float, force: float, notched: float) -> bool:
    """Brake where the force has risen at once, and go on under control from there once it is back."""
    was = feed.brake.is_on
    if brake.observe(feed, force, notched):
        feed.notice |= BRAKED
        asked = brake.asked(feed, velocity, force)
        if feed.phase == CONTROLLING:
            asked = min(asked, max(law.wanted(feed.law, velocity, notched), 0.0))
        feed.wanted = feed.loop.asked = asked
        return True
    if was and feed.phase <= CONTROLLING:
        feed.wanted = min(brake.target(feed, velocity, force), feed.cap)
        inner.begin(feed.loop, feed.wanted)
        law.begin(feed, velocity, notched)
    return False


@njit(cache=True, nogil=True)
def _limited(feed: Record, wanted: float) -> float:
    """Return the feed within its limits of speed and acceleration; a retreat has only that of speed."""
    if feed.phase >= RETREATING:
        return wanted
    low, high = feed.wanted - feed.step, feed.wanted + feed.step
    limited: float = min(max(wanted, low, 0.0), high, feed.cap)
    return limited


@njit(cache=True, nogil=True)
def _highest(feed: Record) -> float:
    """Return the feed that is allowed under control: it does not rise without contact, and gently with little force."""
    if feed.lost:
        return float(feed.wanted)
    if feed.waves.level < feed.enough:
        return float(max(feed.approach, feed.wanted * feed.rise))
    return float(feed.cap)


@njit(cache=True, nogil=True)
def _controlled(feed: Record, velocity: float, force: float, notched: float) -> float:
    """Return the feed of the outer loop within its limits, m/s; without contact it does not rise."""
    law.adapt(feed, velocity, notched)
    asked = law.wanted(feed.law, velocity, notched)
    given = _limited(feed, min(asked, _highest(feed)))
    law.integrate(feed.law, feed.force - force, feed.outer.period, asked, given)
    return given


@njit(cache=True, nogil=True)
def _wanted(feed: Record, velocity: float, force: float, notched: float) -> float:
    """Return the feed wanted in this phase, m/s."""
    phase, wanted = feed.phase, 0.0
    if phase == APPROACHING or phase == ESTIMATING:
        most = min(feed.initial, feed.returning) if phase == APPROACHING else feed.risen
        wanted = feed.wanted
        if not force >= feed.enough:
            wanted = min(most, max(feed.approach, feed.wanted * feed.rise))
        wanted = _limited(feed, wanted)
    elif phase == CONTROLLING:
        wanted = _controlled(feed, velocity, force, notched)
    elif phase == RETREATING:
        wanted = -feed.retreat
    return wanted


@njit(cache=True, nogil=True)
def _seen(feed: Record, measured: float, along: float, across: float, is_seen: bool) -> tuple[float, float]:
    """Take in the force, and go over to another phase where it says so; return it, and it without its ripple, N."""
    force = math.hypot(along, across) if is_seen else feed.last_force
    if feed.phase > CONTROLLING:
        return force, force
    if is_seen:
        feed.smooth_along += SMOOTH * (along - feed.smooth_along)
        feed.smooth_across += SMOOTH * (across - feed.smooth_across)
        if math.isfinite(measured) and feed.phase != IDLE:
            cutting.observe(feed.cutting, measured, along, across)
    watch.observe(feed, along, across, is_seen)
    return force, waves.observe(feed.waves, force)


@njit(cache=True, nogil=True)
def _step(feed: Record, measured: float, along: float, across: float, is_valid: bool, is_running: bool) -> None:
    """Do a sample: velocity (m/s), force along and across (N), whether they are to be had, whether it runs."""
    if is_running and feed.phase == IDLE:
        _begin(feed)
    elif not is_running and feed.phase < RETREATING:
        feed.phase = IDLE
    velocity = inner.observe(feed.loop, measured)
    if feed.is_careful:
        velocity = measured if math.isfinite(measured) else feed.last_velocity
    is_seen = is_valid and math.isfinite(along + across)
    feed.strained = feed.strained + 1 if is_seen and math.hypot(along, across) > feed.overload else 0
    if 0 < feed.strained < feed.overload_samples:  # perhaps a spark of the sensor
        along, across = feed.last_along, feed.last_across
    force, notched = _seen(feed, measured, along, across, is_seen)
    feed.estimating = feed.estimating + 1 if feed.phase == ESTIMATING else 0
    if feed.phase == ESTIMATING and (watch.is_known(feed, force) or feed.estimating > feed.hesitation):
        feed.notice |= 0 if watch.is_known(feed, force) else UNKNOWN
        feed.phase, feed.waves.samples, feed.usual = CONTROLLING, 0, feed.wanted
        law.begin(feed, velocity, notched)
    feed.last_velocity, feed.last_force = velocity, force
    if IDLE < feed.phase <= CONTROLLING:
        _judge(feed, measured)
    if _is_braked(feed, velocity, force, notched):
        return
    feed.wanted = _wanted(feed, velocity, force, notched)
    if feed.phase == IDLE or feed.phase == RETREATED:
        feed.wanted = 0.0
        inner.rest(feed.loop)
    elif feed.is_careful:
        feed.loop.asked = min(max(feed.wanted, feed.loop.least), feed.loop.most)
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
    reference, wanted, estimated, resultant, kappa, kappa_deviation, beta, beta_deviation, phase, notice, ripple = made
    for n in range(len(velocity)):
        _step(feed, velocity[n, 0], force[n, 0], force[n, 1], is_valid[n, 0] > 0.5, is_running[n, 0] > 0.5)
        estimated[n, 0], resultant[n, 0] = feed.last_velocity, feed.last_force
        reference[n, 0], wanted[n, 0], phase[n, 0] = feed.loop.asked, feed.wanted, feed.phase
        kappa[n, 0], beta[n, 0] = feed.cutting.kappa, feed.cutting.beta
        kappa_deviation[n, 0] = math.sqrt(feed.cutting.kappa_variance)
        beta_deviation[n, 0] = math.sqrt(feed.cutting.beta_variance)
        notice[n, 0] = feed.notice
        ripple[n, 0] = feed.waves.omega / (2.0 * math.pi * feed.loop.period) if feed.waves.weight > 0.0 else 0.0
