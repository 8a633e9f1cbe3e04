"""Adaptive force control by the feed, as a block: the tool goes as fast as the force that is wanted allows."""

import math

import numpy as np

from calibration.state_space.model import InnovationModel
from ctlblocks.block import Block, Port
from stagectl.robot.feed_config import ForceFeed
from stagectl.robot.milling import cutting_estimate_kernel as cutting
from stagectl.robot.milling import feed_force_kernel as kernel
from stagectl.robot.milling import force_gain_kernel as outer
from stagectl.robot.milling import velocity_loop_kernel as inner
from stagectl.robot.milling.velocity_loop import VelocityLoop, VelocityWeights, velocity_loop

PHASES = ("idle", "approaching", "estimating", "controlling", "retreating", "retreated")
"""What the port `phase` shows, by number."""
STRAINED = 2
"""Samples of overload at which it retreats; one may be a spark of the sensor."""
TOUCHED = 2
"""Samples of contact."""
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
    `beta_deviation` (1), `phase` out.

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
    has the mean of the force over the sample.  The outer loop works from sample to sample, so that gains that are
    solved anew make no step.  v_init is not added to v_d but is its first value.  Approach, contact, limits and
    retreat are not in the text.
    """

    inputs = (Port("velocity", "m/s"), Port("force", "N", 2), Port("is_valid"), Port("is_running"))
    outputs = (
        Port("reference", "m/s"), Port("wanted", "m/s"), Port("estimated", "m/s"), Port("resultant", "N"),
        Port("kappa", "m/(N s)"), Port("kappa_deviation", "m/(N s)"), Port("beta"), Port("beta_deviation"),
        Port("phase"),
    )  # fmt: skip

    def __init__(self, settings: ForceFeed, model: InnovationModel) -> None:
        self.settings, self.model = settings, model
        self.loop: VelocityLoop = velocity_loop(model, velocity_weights(settings))

    def prepare(self, rate: float, frames: int) -> None:
        """Be idle, and know only the first guesses."""
        if rate != self.model.rate:
            raise ValueError(f"the velocity model is of {self.model.rate:g} samples/s, must be of {rate:g}")
        settings, loop = self.settings, self.loop
        self._learning = learning(settings, rate)
        self._settings = _packed(settings, self._learning, rate)
        self._weights = weights(settings, loop.lag, rate)
        self._fixed = np.array([settings.kappa, math.hypot(1.0, settings.beta)])
        self._matrices = np.vstack([loop.transition, loop.inlet, loop.outlet, loop.gain, loop.feedback])
        self._loop = np.zeros(inner.SETTINGS)
        self._loop[:] = loop.integral, loop.forward, -settings.retreat, settings.highest, 1.0 / rate
        self._state, self._observed, self._work = np.zeros(kernel.STATE), np.zeros(loop.states), np.zeros(loop.states)
        self._estimate = np.zeros(cutting.STATE)
        self._estimate[:4] = settings.kappa, settings.kappa_deviation**2, settings.beta, settings.beta_deviation**2

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
    ) -> None:
        """Control one frame."""
        kernel.run(
            velocity, force, is_valid, is_running,
            reference, wanted, estimated, resultant, kappa, kappa_deviation, beta, beta_deviation, phase,
            self._state, self._settings, self._weights, self._fixed, self._estimate, self._learning,
            self._observed, self._work, self._matrices, self._loop,
        )  # fmt: skip

    @property
    def reason(self) -> str:
        """Why it retreats or has retreated, or nothing, as where it was asked to."""
        settings = self.settings
        return {
            kernel.FINE: "",
            kernel.LEAVING: "",
            kernel.OVERLOAD: f"the force is beyond force.overload, {settings.overload:g} N",
            kernel.SENSOR: f"there is no valid force for {settings.blind:g} s",
        }[int(self._state[kernel.REASON])]

    def retreat(self) -> None:
        """Go back along what is cut and stay, for want of nothing (between ticks); as any retreat once it has begun."""
        if self._state[kernel.PHASE] < kernel.RETREATING:
            kernel.retreat(self._state, kernel.LEAVING)

    @property
    def is_idle(self) -> bool:
        """Whether no segment is milled."""
        return bool(self._state[kernel.PHASE] == kernel.IDLE)

    @property
    def has_retreated(self) -> bool:
        """Whether it stays where it has retreated to."""
        return bool(self._state[kernel.PHASE] == kernel.RETREATED)


def velocity_weights(settings: ForceFeed) -> VelocityWeights:
    """Return how the inner loop is weighed."""
    return VelocityWeights(settings.velocity_integral, settings.velocity_effort, settings.doubt)


def weights(settings: ForceFeed, lag: float, rate: float) -> np.ndarray:
    """Return the outer problem as `force_gain_kernel` reads it, shape (settings,), for a loop of `lag` (s)."""
    packed = np.zeros(outer.SETTINGS)
    packed[:] = settings.stiffness, 1.0 / lag, settings.integral**-2, 0.0, settings.effort**2, 1.0 / rate
    return packed


def learning(settings: ForceFeed, rate: float) -> np.ndarray:
    """Return the estimator's settings as `cutting_estimate_kernel` reads them, shape (settings,)."""
    packed = np.zeros(cutting.SETTINGS)
    packed[:] = (
        settings.stiffness, 1.0 / rate, settings.force_noise**2, settings.velocity_noise**2,
        settings.kappa_drift**2 / rate, settings.beta_drift**2 / rate, settings.contact, LEAST_KAPPA, MOST_KAPPA,
    )  # fmt: skip
    return packed


def _settled(noise: float, drift: float, regressor: float) -> float:
    """Return the variance that a random walk's filter comes to at a constant regressor."""
    return 0.5 * (math.sqrt(drift**2 + 4.0 * drift * noise / regressor**2) - drift)


def _packed(settings: ForceFeed, known: np.ndarray, rate: float) -> np.ndarray:
    wide = math.hypot(1.0, settings.beta)
    slope = known[cutting.PERIOD] * known[cutting.STIFFNESS]
    noise = 2.0 * known[cutting.FORCE_NOISE] / slope**2 + wide**2 * known[cutting.VELOCITY_NOISE]
    along = settings.force / wide
    gentle = settings.start == "gentle"
    packed = np.zeros(kernel.SETTINGS)
    packed[:] = (
        settings.force, settings.initial, math.exp(1.0 / (rate * settings.rise)) if gentle else 1.0,
        settings.enough * settings.force if gentle else np.inf, settings.contact, TOUCHED,
        max(1, round(settings.lost * rate)), settings.approach if gentle else settings.initial, settings.highest,
        settings.acceleration / rate,
        settings.overload, STRAINED, max(1, round(settings.blind * rate)), settings.retreat, settings.distance,
        settings.activation**2 * _settled(noise, known[cutting.KAPPA_DRIFT], settings.force),
        settings.activation**2 * _settled(known[cutting.FORCE_NOISE] * wide**2, known[cutting.BETA_DRIFT], along),
        settings.kappa_deviation**2, settings.beta_deviation**2, float(settings.adapted),
        settings.highest if gentle else settings.initial,
    )  # fmt: skip
    return packed
