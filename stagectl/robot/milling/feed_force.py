"""Adaptive force control by the feed, as a block: the tool goes as fast as the force that is wanted allows."""

import math

import numpy as np

from calibration.state_space.model import InnovationModel
from ctlblocks.block import Block, Port
from rigkit.record import Record
from stagectl.robot.feed_config import ForceFeed
from stagectl.robot.milling import feed_force_kernel as kernel
from stagectl.robot.milling import feed_record as record
from stagectl.robot.milling import feed_watch_kernel as watch
from stagectl.robot.milling.velocity_loop import VelocityLoop, VelocityWeights, velocity_loop

PHASES = ("idle", "approaching", "estimating", "controlling", "retreating", "retreated")
"""What the port `phase` shows, by number."""
STRAINED = 2
"""Samples of overload at which it retreats; one may be a spark of the sensor."""
TOUCHED = 2
"""Samples of contact."""
FORGET, FLOOR, PATIENCE = 0.25, 1e-3, 0.1
"""s over which it is judged whether the robot follows, m/s that do not count, and s until it is said."""
RINGING, NOISE = 0.08, 3.0
"""s in which a resonator forgets, and the amplitude that noise alone hardly shows in it, over its deviation."""
USUAL, UNUSUAL = 0.5, 0.5
"""s over which the force's usual scatter is a mean, and, after as long of control, in which kappa is none that is known
until that is said."""
LEAST_KAPPA, MOST_KAPPA = 1e-5, 0.1
"""m/(N s), beyond which no estimate goes."""


class FeedForce(Block):
    """Control the force on a milling tool by its feed, while kappa and beta are estimated.

    A segment begins when `is_running` rises: the tool approaches, touches, feeds so that kappa and beta can be
    estimated, and is under force control as soon as both are known well enough.  Overload, or no valid force, and it
    retreats and stays; `reason` says why.  Between segments there is nowhere to retreat to: there overload makes it
    stay at once, and no valid force is waited for.

    Ports, one wide: `velocity` (m/s, mean since the last sample), `force` (N, 2 wide: against the feed and across it),
    `is_valid` (1 while the force is to be believed), `is_running` in; `reference` (m/s, asked of the robot), `wanted`
    (m/s, v_d), `estimated` (m/s), `resultant` (N, f_sN), `kappa` and `kappa_deviation` (m/(N s)), `beta` and
    `beta_deviation` (1), `phase`, `notice` (bits, which `feed_notices` has in words) and `ripple` (Hz, as it is
    sampled; 0 where none is taken out) out.

    Parameters
    ----------
    settings : ForceFeed
    model : InnovationModel
        From velocity asked of the robot to its velocity, m/s, at the rate of the graph.

    Source
    ------
    Sörnmo 2015, eqs. (7.4) to (7.26).

    Departs
    -------
    (7.25), (7.26): C is block diagonal, so that the filter falls apart into observer, kappa and beta; kappa's equation
    has the mean of the force over the sample, and both filters take what is really left over for noise where that is
    more.  (7.9): the force that is controlled is the size, without the sign of f_x, which noise turns where the force
    is almost across.  (7.18) to (7.22): the gains are renewed where kappa or beta have changed enough, and the integral
    takes the difference; between two renewals the integral of the error alone decides the mean force.  v_init is not
    added to v_d but is its first value.  Approach, contact, limits, retreat and what is noticed are not in the text.
    """

    inputs = (Port("velocity", "m/s"), Port("force", "N", 2), Port("is_valid"), Port("is_running"))
    outputs = (
        Port("reference", "m/s"), Port("wanted", "m/s"), Port("estimated", "m/s"), Port("resultant", "N"),
        Port("kappa", "m/(N s)"), Port("kappa_deviation", "m/(N s)"), Port("beta"), Port("beta_deviation"),
        Port("phase"), Port("notice"), Port("ripple", "Hz"),
    )  # fmt: skip

    def __init__(self, settings: ForceFeed, model: InnovationModel) -> None:
        self.settings, self.model = settings, model
        self.loop: VelocityLoop = velocity_loop(model, velocity_weights(settings))

    def prepare(self, rate: float, frames: int) -> None:
        """Be idle, and know only the first guesses."""
        if rate != self.model.rate:
            raise ValueError(f"the velocity model is of {self.model.rate:g} samples/s, must be of {rate:g}")
        self._feeds = np.zeros(1, record.FEED)  # numba takes a plain array quickly, a recarray slowly
        self._feed: Record = self._feeds.view(np.recarray)[0]
        feed, settings = self._feed, self.settings
        pack_outer(feed.outer, settings, self.loop.lag, rate)
        pack_cutting(feed.cutting, settings, rate)
        feed.brake.samples = half_followed(self.model)
        self.loop.pack(feed.loop, -settings.retreat, settings.highest, rate)
        _pack(feed, settings, rate)

    def process(
        self,
        velocity: np.ndarray,
        force: np.ndarray,
        is_valid: np.ndarray,
        is_running: np.ndarray,
        reference: np.ndarray,
        wanted: np.ndarray,
        estimated: np.ndarray,
        resultant: np.ndarray,
        kappa: np.ndarray,
        kappa_deviation: np.ndarray,
        beta: np.ndarray,
        beta_deviation: np.ndarray,
        phase: np.ndarray,
        notice: np.ndarray,
        ripple: np.ndarray,
    ) -> None:
        """Control one frame."""
        seen = velocity, force, is_valid, is_running
        made = (
            reference, wanted, estimated, resultant, kappa, kappa_deviation, beta, beta_deviation,
            phase, notice, ripple,
        )  # fmt: skip
        kernel.run(seen, made, self._feeds)

    @property
    def reason(self) -> str:
        """Why it retreats or has retreated, or nothing, as where it was asked to."""
        settings = self.settings
        return {
            record.FINE: "",
            record.LEAVING: "",
            record.OVERLOAD: f"the force is beyond force.overload, {settings.overload:g} N",
            record.UNFAMILIAR: (
                f"for its feed the force must be beyond force.overload, {settings.overload:g} N, by what is known of "
                "the material: the force sensor's scale?"
            ),
            record.CHATTERING: (
                f"the tool still chatters {settings.chattering:g} s after the feed was lowered for the last time: mill "
                "less deep, or at another speed of the spindle"
            ),
            record.STUCK: f"the force has been exactly the same for {settings.stuck:g} s",
            record.SENSOR: f"there is no valid force for {settings.blind:g} s",
        }[int(self._feed.reason)]

    @property
    def notice(self) -> int:
        """What has been noticed in this segment, as bits: as the port of that name."""
        return int(self._feed.notice)

    @property
    def ripple(self) -> float:
        """Frequency of the ripple, Hz, as it is sampled: that of its alias where it is above half the rate."""
        return float(self._feed.waves.omega / (2.0 * math.pi * self._feed.loop.period))

    def retreat(self) -> None:
        """Go back along what is cut and stay, for want of nothing (between ticks); as any retreat once it has begun."""
        if self._feed.phase < record.RETREATING:
            watch.retreat(self._feed, record.LEAVING)

    @property
    def is_idle(self) -> bool:
        """Whether no segment is milled."""
        return bool(self._feed.phase == record.IDLE)

    @property
    def has_retreated(self) -> bool:
        """Whether it stays where it has retreated to."""
        return bool(self._feed.phase == record.RETREATED)


def velocity_weights(settings: ForceFeed) -> VelocityWeights:
    """Return how the inner loop is weighed."""
    return VelocityWeights(settings.velocity_integral, settings.velocity_effort, settings.doubt)


def pack_outer(outer: Record, settings: ForceFeed, lag: float, rate: float) -> None:
    """Fill a record of `OUTER`, for a velocity loop of `lag` (s)."""
    outer.stiffness, outer.lag, outer.period = settings.stiffness, 1.0 / lag, 1.0 / rate
    outer.integral, outer.velocity, outer.control = settings.integral**-2, 0.0, settings.effort**2


def pack_cutting(cutting: Record, settings: ForceFeed, rate: float) -> None:
    """Fill a record of `CUTTING` with the estimator's settings and the first guesses."""
    cutting.stiffness, cutting.period, cutting.gate = settings.stiffness, 1.0 / rate, settings.contact
    cutting.force_noise, cutting.velocity_noise = settings.force_noise**2, settings.velocity_noise**2
    cutting.kappa_drift, cutting.beta_drift = settings.kappa_drift**2 / rate, settings.beta_drift**2 / rate
    cutting.least, cutting.most = LEAST_KAPPA, MOST_KAPPA
    cutting.guess = settings.kappa
    cutting.kappa, cutting.kappa_variance = settings.kappa, settings.kappa_deviation**2
    cutting.beta, cutting.beta_variance = settings.beta, settings.beta_deviation**2


def pack_waves(waves: Record, settings: ForceFeed, rate: float) -> None:
    """Fill a record of `WAVES` with what it is set to."""
    omega = 2.0 * math.pi * record.SPACING / rate
    waves.decay, waves.slow, waves.turn = math.exp(-1.0 / (RINGING * rate)), -math.expm1(-1.0 / (RINGING * rate)), omega
    waves.cosine[:], waves.sine[:] = (f(omega * np.arange(1, record.BINS + 1)) for f in (np.cos, np.sin))
    waves.floor, waves.noise, waves.share = 0.5 * settings.force, NOISE * settings.force_noise, settings.ripple


def half_followed(model: InnovationModel) -> int:
    """Return after how many samples a step of the velocity asked for is followed by half."""
    share = model.simulate(np.ones((round(model.rate), 1)))[:, 0]
    return int(np.argmax(share >= 0.5 * share[-1]))


def pack_brake(feed: Record, settings: ForceFeed, rate: float) -> None:
    """Fill what brakes the feed, and what is known of kappa, in a record of `FEED`."""
    brake = feed.brake
    brake.share, brake.slow, brake.noise = settings.brake, -math.expm1(-1.0 / (USUAL * rate)), settings.force_noise
    feed.familiar, feed.familiar_samples = settings.familiar, round(UNUSUAL * rate)


def _pack(feed: Record, settings: ForceFeed, rate: float) -> None:
    """Fill a record of `FEED` with what it is set to."""
    gentle = settings.start == "gentle"
    feed.force, feed.initial, feed.most = settings.force, settings.initial, settings.highest
    feed.rise = math.exp(1.0 / (rate * settings.rise)) if gentle else 1.0
    feed.enough = settings.enough * settings.force if gentle else np.inf
    feed.approach = settings.approach if gentle else settings.initial
    feed.risen = settings.highest if gentle else settings.initial
    feed.step = settings.acceleration / rate
    feed.contact, feed.contact_samples = settings.contact, TOUCHED
    feed.lost_samples = max(1, round(settings.lost * rate))
    feed.activation, feed.hesitation = settings.activation**2, round(settings.hesitation * rate)
    feed.kappa_doubt, feed.beta_doubt = settings.kappa_deviation**2, settings.beta_deviation**2
    feed.careful_lag, feed.careful_integral = 1.0 / settings.careful_lag, settings.careful_integral**-2
    feed.chatter_share, feed.stuck_samples = settings.chatter, max(1, round(settings.stuck * rate))
    feed.chatter_samples = max(1, round(settings.chattering * rate))
    feed.law.ratio, feed.law.is_adapted = settings.renewal, settings.adapted
    feed.law.fixed_kappa, feed.law.fixed_widening = settings.kappa, math.hypot(1.0, settings.beta)
    feed.follow.forget, feed.follow.floor = -math.expm1(-1.0 / (FORGET * rate)), FLOOR
    feed.follow.patience = round(PATIENCE * rate)
    pack_waves(feed.waves, settings, rate)
    pack_brake(feed, settings, rate)
    feed.overload, feed.overload_samples = settings.overload, STRAINED
    feed.blind_samples = max(1, round(settings.blind * rate))
    feed.retreat, feed.distance = settings.retreat, settings.distance
