"""The compiled kernel of a tool that is fed into a workpiece: velocity dynamics, removal, and the force between."""

import math

import numpy as np

from firmware_sim.plants.flush_kernel import flushed
from firmware_sim.plants.record import Record
from rigkit.compiled import njit

VARIED = np.dtype([("rest", "f8"), ("swing", "f8"), ("step", "f8"), ("at", "f8")], align=True)
"""At rest, amplitude of its sine, by what it steps, and when, s."""
FEED = np.dtype(
    [
        ("corner", "f8"),  # rad/s
        ("mode", "f8"),  # rad/s
        ("damping", "f8"),  # 1
        ("stiffness", "f8"),  # N/m
        ("force_noise", "f8"),  # N
        ("position_noise", "f8"),  # m
        ("kappa", VARIED),  # m/(N s)
        ("beta", VARIED),  # 1
        ("frequency", "f8"),  # rad/s, of their sines
        ("period", "f8"),  # s a step
        ("steps", "i8"),  # a sample
        # state
        ("filtered", "f8"),  # m/s
        ("speed", "f8"),  # m/s
        ("pull", "f8"),  # m/s^2
        ("place", "f8"),  # m
        ("removed", "f8"),  # m
        ("seen", "f8"),  # m
        ("done", "i8"),  # samples
    ],
    align=True,
)


@njit(cache=True, nogil=True)
def _move(asked: float, feed: Record) -> None:
    """Go on by a step of the velocity's dynamics: a low-pass, then a mode."""
    h, omega = feed.period, feed.mode
    filtered, speed, pull = feed.filtered, feed.speed, feed.pull
    filtered += -math.expm1(-feed.corner * h) * (asked - filtered)
    pull += h * (omega * omega * (filtered - speed) - 2.0 * feed.damping * omega * pull)
    feed.filtered, feed.pull, feed.speed = flushed(filtered), flushed(pull), flushed(speed + h * pull)
    feed.place += h * feed.speed


@njit(cache=True, nogil=True)
def _cut(kappa: float, feed: Record) -> float:
    """Return the force against the feed, N, after a step at constant speed; the workpiece does not pull."""
    moved = feed.period * feed.speed
    before = feed.place - moved - feed.removed
    if before <= 0.0 or feed.place <= feed.removed:
        return float(feed.stiffness * max(feed.place - feed.removed, 0.0))
    decay = kappa * feed.stiffness * feed.period
    depth = before + -math.expm1(-decay) * (moved / decay - before)
    if depth > 0.0:
        feed.removed = feed.place - depth
    return float(feed.stiffness * max(depth, 0.0))


@njit(cache=True, nogil=True)
def _varied(time: float, value: Record, frequency: float) -> float:
    """Return kappa or beta as it is at a time, s."""
    now: float = value.rest + value.swing * math.sin(frequency * time)
    return now + float(value.step) if time >= value.at else now


@njit(cache=True, nogil=True)
def run(
    asked: np.ndarray,
    velocity: np.ndarray,
    force: np.ndarray,
    true_force: np.ndarray,
    kappa: np.ndarray,
    beta: np.ndarray,
    noise: np.ndarray,
    feeds: np.ndarray,
) -> None:
    """Run one frame; signals are shape (frames, 1), forces (frames, 2), `noise` (samples, 3) of unit variance.

    `feeds` is of one `FEED`.
    """
    feed = feeds[0]
    steps = feed.steps
    for n in range(len(asked)):
        done = feed.done
        time = done * feed.period * steps
        kappa[n, 0], beta[n, 0] = _varied(time, feed.kappa, feed.frequency), _varied(time, feed.beta, feed.frequency)
        along = 0.0
        for _ in range(steps):
            _move(asked[n, 0], feed)
            along = _cut(kappa[n, 0], feed)
        drawn = noise[done % len(noise)]
        seen = feed.place + feed.position_noise * drawn[0]
        velocity[n, 0] = (seen - feed.seen) / (feed.period * steps)
        true_force[n, 0], true_force[n, 1] = along, beta[n, 0] * along
        for part in range(2):
            force[n, part] = true_force[n, part] + feed.force_noise * drawn[1 + part]
        feed.seen, feed.done = seen, done + 1
