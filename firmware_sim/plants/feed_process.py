"""A tool fed into a workpiece whose kappa and beta change with time: the simulation of Sörnmo 2015, fig. 7.5."""

from dataclasses import dataclass
from math import pi

import numpy as np

from firmware_sim.plants import feed_process_kernel as kernel
from firmware_sim.plants.options import option, refuse_rate, refuse_wrong_options

STEP = 4e-4
"""s, longest within."""
DRAWN = 20_000
"""Samples of noise, which then come again."""


@dataclass(eq=False, kw_only=True)
class FeedOptions:
    """Which process; defaults of Sörnmo 2015, sec. 7.3, where it prints them.

    Parameters
    ----------
    seed : int
    corner, mode : float, Hz
        Of the robot: a low-pass, and behind it a mode
    damping : float, 1
        of this damping; assumed, as guided motion has them.
    stiffness : float, N/m, K_f
    kappa, kappa_swing, kappa_step : float, m/(N s)
        At rest, amplitude of its sine, and by what it steps
    kappa_at : float, s
        then.
    beta, beta_swing, beta_step, beta_at : float, 1 and s
        The same of beta.
    frequency : float, Hz, of both sines
    force_noise, position_noise : float, N and m, rms of the sensors

    Raises
    ------
    ValueError : an option outside its range, by name.
    """

    seed: int = option(1, "", 0)
    corner: float = option(20.0, "Hz", 0.5, 200.0)
    mode: float = option(12.0, "Hz", 0.5, 100.0)
    damping: float = option(0.5, "1", 0.02, 2.0)
    stiffness: float = option(75e3, "N/m", 1e3, 1e7)
    kappa: float = option(4e-4, "m/(N s)", 1e-5, 0.1)
    kappa_swing: float = option(1e-4, "m/(N s)", 0.0, 0.1)
    kappa_step: float = option(1e-4, "m/(N s)", -0.1, 0.1)
    kappa_at: float = option(6.0, "s", 0.0)
    beta: float = option(0.5, "1", -5.0, 5.0)
    beta_swing: float = option(0.1, "1", 0.0, 5.0)
    beta_step: float = option(0.1, "1", -5.0, 5.0)
    beta_at: float = option(9.0, "s", 0.0)
    frequency: float = option(0.2, "Hz", 0.0, 100.0)
    force_noise: float = option(0.15, "N", 0.0, 100.0)
    position_noise: float = option(1e-6, "m", 0.0, 1e-3)

    def __post_init__(self) -> None:
        """Refuse what is out of range."""
        refuse_wrong_options(self)
        if not self.kappa_swing + max(0.0, -self.kappa_step) < self.kappa:
            raise ValueError(
                f"simulator.options.kappa_swing is {self.kappa_swing} m/(N s) and kappa_step {self.kappa_step}, must "
                f"leave something of kappa, {self.kappa}"
            )


@dataclass(eq=False)
class FeedProcess(FeedOptions):
    """A robot that follows a velocity, and the force that its tool meets along and across it.

    The force is K_f (p - kappa times the integral of the force), and beta times that across the feed; it never pulls.
    The tool is at the workpiece at the beginning.

    It does not model: teeth, engagement, an end of the workpiece, delays.

    Parameters
    ----------
    rate : float, samples/s, 50 to 10 000

    Others: those of `FeedOptions`.

    Source
    ------
    Sörnmo 2015, eqs. (7.4) to (7.9).

    Raises
    ------
    ValueError : an option outside its range, by name.
    """

    rate: float

    def __post_init__(self) -> None:
        """Draw its noise."""
        super().__post_init__()
        refuse_rate(self.rate, 50, 10_000, "the simulated feed")
        steps = max(1, int(np.ceil(1.0 / (self.rate * STEP))))
        self._feed = feed = np.zeros(1, kernel.FEED)
        for name in ("corner", "mode", "frequency"):
            feed[name] = 2.0 * pi * getattr(self, name)
        for name in ("damping", "stiffness", "force_noise", "position_noise"):
            feed[name] = getattr(self, name)
        feed["kappa"] = self.kappa, self.kappa_swing, self.kappa_step, self.kappa_at
        feed["beta"] = self.beta, self.beta_swing, self.beta_step, self.beta_at
        feed["period"], feed["steps"] = 1.0 / (self.rate * steps), steps
        self._noise = np.random.default_rng([self.seed, 75]).standard_normal((DRAWN, 3))

    def run(
        self,
        asked: np.ndarray,
        velocity: np.ndarray,
        force: np.ndarray,
        true_force: np.ndarray,
        kappa: np.ndarray,
        beta: np.ndarray,
    ) -> None:
        """Go on for one frame.

        Parameters
        ----------
        asked : array, shape (frames, 1), m/s
            Velocity that is wanted.
        velocity : array, shape (frames, 1), m/s, filled in place
            As measured: the mean over the sample.
        force, true_force : arrays, shape (frames, 2), N, filled in place
            Against the feed and across it at the end of the sample, as measured and as it is.
        kappa, beta : arrays, shape (frames, 1), m/(N s) and 1, filled in place
            As they are.
        """
        kernel.run(asked, velocity, force, true_force, kappa, beta, self._noise, self._feed)
