"""Milling a toroid in steel: where the tool is in the workpiece that a robot holds, and the force between both."""

from dataclasses import dataclass

import numpy as np

from firmware_sim.plants import toroid_cut_kernel as kernel
from firmware_sim.plants.milling_disturbance import (
    CHATTER,
    CHIP_LOAD,
    RUNOUT,
    SPINDLE,
    TEETH,
    TOOTH_OVERTONE,
    TOOTH_PASSING,
    wander,
)
from firmware_sim.plants.options import option, refuse_rate, refuse_wrong_options

SHARES = (0.92, 0.34, 0.19)
"""Of the force, along normal, feed and tool axis: a slot's mean forces are as K_tc to K_rc to 4 K_ac / pi [Altintas,
Manufacturing Automation, 2nd ed., sec. 2.8], here with K_rc = 0.37 K_tc and K_ac = 0.16 K_tc, assumed for steel."""
EDGE = 0.2
"""Part of the force that does not grow with the feed: rubbing of the edges; assumed."""
FEED_TIME = 5e-3
"""s, over which the feed is seen: some teeth."""


@dataclass(eq=False, kw_only=True)
class ToroidOptions:
    """Which toroid, and how hard it is to cut; defaults of Sörnmo 2015, sec. 2.6.

    Parameters
    ----------
    seed : int
    radius, depth, tool : float, m, of the path, of the cut, and the tool's diameter
    feed : float, m/s, at which the force is `force`
    force : float, N, of the full cut
    start : float, s, until then the tool is touched off
    seconds : float, s, after which the ripple of the force comes again

    Raises
    ------
    ValueError : an option outside its range, by name.
    """

    seed: int = option(1, "", 0)
    radius: float = option(35e-3, "m", 5e-3, 0.5)
    depth: float = option(0.5e-3, "m", 1e-5, 0.01)
    tool: float = option(8e-3, "m", 1e-4, 0.05)
    feed: float = option(5e-3, "m/s", 1e-4, 0.1)
    force: float = option(100.0, "N", 0.0, 1e4)
    start: float = option(0.0, "s", 0.0, 60.0)
    seconds: float = option(50.0, "s", 0.1, 600.0)

    def __post_init__(self) -> None:
        """Refuse what is out of range."""
        refuse_wrong_options(self)


@dataclass(eq=False)
class ToroidCut(ToroidOptions):
    """A tool along x that mills a circle in y and z, counterclockwise from the top, into a workpiece on a robot.

    Until `start` the tool stands on the workpiece's surface at the top of the circle: that offset is touched off.  From
    then on the force has a part along the path's normal, one against the feed and one along the axis; it grows with
    feed and depth as they are, comes and goes with the tool's diameter at either end of the circle, and pulses with
    teeth and spindle.  The robot's tool point is the toroid's centre.

    It does not model: forces that answer vibrations of an earlier tooth (regenerative chatter), a tool that bends or
    wears, walls that are already cut away by a former error, chips, heat; nor the form of the face beside the cut.

    Parameters
    ----------
    rate : float, samples/s, 1000 to 1e5

    Others: those of `ToroidOptions`.

    Source
    ------
    Sörnmo 2015, sec. 2.6; ripple as in `MillingDisturbance`.

    Raises
    ------
    ValueError : an option outside its range, by name.
    """

    rate: float

    SPAN = 0.5e-3
    """s, over which poses and forces are averaged, for a robot that is simulated in steps of so much."""

    def __post_init__(self) -> None:
        """Draw the ripple."""
        super().__post_init__()
        refuse_rate(self.rate, 1_000, 1e5, "the simulated cut")
        span = max(1, round(self.SPAN * self.rate))
        smooth = 1.0 - np.exp(-1.0 / (FEED_TIME * self.rate))
        self._cut = cut = np.zeros(1, kernel.CUT)
        for name in ("radius", "depth", "tool", "feed", "force", "rate"):
            cut[name] = getattr(self, name)
        cut["start"], cut["smooth"], cut["edge"], cut["shares"] = round(self.start * self.rate), smooth, EDGE, SHARES
        self._ripple, self._ring = _ripple(self), np.zeros((span, 19))

    def run(
        self,
        tool: np.ndarray,
        workpiece: np.ndarray,
        orientation: np.ndarray,
        force: np.ndarray,
        moment: np.ndarray,
        plate_force: np.ndarray,
        cut: np.ndarray,
        face: np.ndarray,
    ) -> None:
        """Go on for one frame.

        Parameters
        ----------
        tool, workpiece : arrays, shape (frames, 3), m
            Where the stage has the tool, and the robot's tool point; axes of the base.
        orientation : array, shape (frames, 4), 1
            Of the robot's tool, w x y z.
        force, moment : arrays, shape (frames, 3), N and N m, filled in place
            On the robot's tool point, averaged over `SPAN` twice; axes of the base.
        plate_force : array, shape (frames, 3), N, filled in place
            On the tool.
        cut : array, shape (frames, 3), m, filled in place
            Where the tool is in the workpiece, from the toroid's centre; x is how much too deep.
        face : array, shape (frames, 3), m, filled in place
            How the workpiece's face beside the tool moves towards it: along x; nothing along y and z.
        """
        seen, told = (tool, workpiece, orientation), (force, moment, plate_force, cut, face)
        kernel.run(seen, told, self._ripple, self._ring, self._cut)


def _ripple(cut: ToroidCut) -> np.ndarray:
    """Return by what the mean forces are multiplied, sample by sample, shape (samples, 3), 1."""
    rng = np.random.default_rng([cut.seed, 26])
    time = np.arange(max(1, round(cut.seconds * cut.rate))) / cut.rate
    ripple = np.ones((len(time), 3)) + CHIP_LOAD * wander(time, rng)[:, None]
    for frequency, amplitude in (
        (TEETH * SPINDLE, TOOTH_PASSING),
        (2 * TEETH * SPINDLE, TOOTH_OVERTONE),
        (SPINDLE, RUNOUT),
    ):
        phase = rng.uniform(0, 2 * np.pi, 3)
        if frequency < cut.rate / 2:
            ripple += amplitude * np.sin(2 * np.pi * frequency * time[:, None] + phase)
    ripple += CHATTER * rng.standard_normal((len(time), 3))
    return np.asarray(ripple)
