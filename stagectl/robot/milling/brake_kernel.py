"""The compiled kernel that brakes the feed where the force rises faster than feedback would follow."""

from rigkit.compiled import njit
from rigkit.record import Record
from stagectl.robot.milling.feed_record import CONTROLLING, ESTIMATING
from stagectl.robot.milling.velocity_loop_kernel import foreseen

SCATTERS = 2.0
"""Of the usual scatter, beside the share of the force wanted, beyond which it brakes: a ripple's peak is at 1.6."""
LARGER = 1.5
"""Times a swing before, as it fades, that one must be to be braked for: one in 0.2 s and more often is not."""
RELEASE = 0.5
"""Of the way from the force wanted to where it brakes, at which it ends."""
LEAD = 2.0
"""Of the way from the feed that would make the force wanted to the velocity, by which less is asked for."""


@njit(cache=True, nogil=True)
def begin(brake: Record) -> None:
    """Have seen nothing."""
    brake.scatter, brake.last, brake.is_on = brake.noise, 0.0, 0
    brake.swing = brake.peak = 0.0


@njit(cache=True, nogil=True)
def _swing(brake: Record, over: float) -> None:
    """Keep how far the force went beyond what is wanted in the swings before this one, as it fades; `over` in N."""
    brake.peak -= brake.slow * brake.peak
    if over > 0.0:
        brake.swing = max(brake.swing, over)
    else:
        brake.peak, brake.swing = max(brake.peak, brake.swing), 0.0


@njit(cache=True, nogil=True)
def observe(feed: Record, force: float, notched: float) -> bool:
    """Take in a force, N, as it is and without its ripple; return whether the feed is braked in this sample.

    A swing about as large as those before is none that a feed ends: chatter is not braked for.  Where the robot
    does not follow its model, nothing is foreseen, and the loop for its lag is all there is.
    """
    brake = feed.brake
    if (feed.phase != CONTROLLING and feed.phase != ESTIMATING) or feed.is_careful:
        brake.is_on = 0
        return False
    beyond = (brake.share - 1.0) * feed.force + SCATTERS * brake.scatter
    seen, was = min(force, notched), brake.last
    mean, brake.last = 0.5 * (seen + was), seen
    _swing(brake, mean - feed.force)
    if brake.is_on:
        brake.is_on = 1 if seen > feed.force + RELEASE * beyond else 0
    else:
        brake.is_on = 1 if mean > feed.force + max(beyond, LARGER * brake.peak) else 0
    if feed.phase == CONTROLLING:
        brake.scatter += brake.slow * (abs(force - feed.waves.level) - brake.scatter)
    return bool(brake.is_on)


@njit(cache=True, nogil=True)
def target(feed: Record, velocity: float, force: float) -> float:
    """Return the feed that makes the force wanted with the chip of now, m/s."""
    return float(max(velocity, 0.0) * feed.force / max(force, feed.force))


@njit(cache=True, nogil=True)
def _foreseen(feed: Record, velocity: float, goal: float) -> float:
    """Return the velocity in the time in which the robot follows by half, if `goal` is asked for until then, m/s."""
    loop, brake = feed.loop, feed.brake
    n = loop.states
    for i in range(n):
        brake.state[i] = loop.state[i]
    for _ in range(brake.samples):
        velocity = foreseen(loop, n, goal, brake.state, loop.work)
        for i in range(n):
            brake.state[i] = loop.work[i]
    return velocity


@njit(cache=True, nogil=True)
def asked(feed: Record, velocity: float, force: float) -> float:
    """Return what is asked of the robot meanwhile, m/s: as much less than the target as it will still be faster."""
    goal = target(feed, velocity, force)
    return float(min(max(goal - LEAD * (_foreseen(feed, velocity, goal) - goal), 0.0), feed.loop.most))
