"""By what the force of a cut changes with the tool's velocity, sample by sample, as a trial shows it."""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d

from calibration.state_space.model import InnovationModel
from stagectl.robot.milling.zero_phase import filtered, low_pass

WINDOW = 0.1
"""s, standard deviation of the window over which force and velocity are held against each other."""
SLOWEST = 2e-3
"""m/s: a tool as slow as that has half the gain that one at speed would have had."""
CUTOFF = 10.0
"""Hz, of what is looked at: above is the tracker's noise."""


@dataclass(frozen=True, eq=False)
class MeasuredCut:
    """What milling adds to the robot at each sample of a trial, as that trial has shown it.

    Parameters
    ----------
    gain : array, shape (N, 3, 3), N s/m, or s
        As `cutting_gain` finds it, of the force, or of the deflection itself.
    compliance : InnovationModel, optional
        G_K, which makes a deflection of the force.
    """

    gain: np.ndarray
    compliance: InnovationModel | None = None

    def deflection(self, change: np.ndarray, rate: float) -> np.ndarray:
        """Return what a change of the tool's position does to it by way of the cut, shape (N, 3), m.

        Parameters
        ----------
        change : array, shape (N, 3), m
        rate : float, samples/s
        """
        answer = np.einsum("nij,nj->ni", self.gain, velocity(change, rate))
        return answer if self.compliance is None else filtered(answer, rate, self.compliance.frequency_response)


def cutting_gain(load: np.ndarray, position: np.ndarray, rate: float) -> np.ndarray:
    """Return the force, or deflection, that a change of velocity makes, shape (N, 3, 3), N s/m or s, sample by sample.

    The chip is as thick as the tool is fast, and its force turns with the way the tool goes: f = g v, where f and v are
    complex, x + iy, and g is what they are to each other over `WINDOW`, by least squares.  In a slot g is the same
    whichever way it goes; at a flank it is less, and where nothing is cut it is 0.  Along z the force follows the speed
    along the path, and a speed along z makes none.  A deflection does the same as far as the arm is as soft one way as
    the other, and slower than its modes.

    Parameters
    ----------
    load : array, shape (N, 3), N or m
        On the tool, or by which it is bent, beyond what there is in the air.
    position : array, shape (N, 3), m
        Of the tool.
    rate : float, samples/s

    Raises
    ------
    ValueError : a value that is not finite.
    """
    speed, force = velocity(position, rate), filtered(load, rate, _smooth)
    way, push = speed[:, 0] + 1j * speed[:, 1], force[:, 0] + 1j * force[:, 1]
    power = _over_window(np.abs(way) ** 2, rate) + SLOWEST**2
    plane, down = (_over_window(each * way.conj(), rate) / power for each in (push, force[:, 2]))
    found = np.zeros((len(load), 3, 3))
    found[:, 0, 0] = found[:, 1, 1] = plane.real
    found[:, 1, 0], found[:, 0, 1] = plane.imag, -plane.imag
    found[:, 2, 0], found[:, 2, 1] = down.real, -down.imag
    return found


def velocity(position: np.ndarray, rate: float) -> np.ndarray:
    """Return the velocity of a whole trial up to `CUTOFF`, without phase, shape (N, 3), m/s.

    Parameters
    ----------
    position : array, shape (N, 3), m
    rate : float, samples/s
    """
    return filtered(position, rate, lambda frequency: 2j * np.pi * frequency[:, None, None] * _smooth(frequency))


def _smooth(frequency: np.ndarray) -> np.ndarray:
    return np.asarray(low_pass(frequency, CUTOFF)[:, None, None] * np.eye(3))


def _over_window(signal: np.ndarray, rate: float) -> np.ndarray:
    return np.asarray(gaussian_filter1d(signal, WINDOW * rate, mode="nearest"))
