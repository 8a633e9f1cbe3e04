"""A linear structure by its poles: what forces do to displacements, for any damping and with first-order parts."""

from dataclasses import dataclass, replace

import numpy as np


@dataclass(frozen=True)
class Structure:
    """A structure between forces and displacements, as a sum over its poles.

    A force F and a displacement x are related by x/F = sum over the poles of (r / (s - p) + r* / (s - p*)) / 2 with
    r = outlet x inlet; for a real pole the two halves are the same.  That is (Re(r) s - Re(r p*)) / (s^2 - 2 Re(p) s +
    |p|^2).

    Parameters
    ----------
    poles : complex array, shape (modes,), rad/s
        Those with a positive imaginary part, and the real ones.
    inlet : complex array, shape (forces, modes), m/s per N
        What a force does to each pole's state.
    outlet : complex array, shape (forces, modes), 1
        The displacement at which each force acts.
    sensors : complex array, shape (sensors, modes), 1
        The displacement under each accelerometer.
    """

    poles: np.ndarray
    inlet: np.ndarray
    outlet: np.ndarray
    sensors: np.ndarray

    @property
    def frequency(self) -> np.ndarray:
        """Hz, of each oscillation, shape (oscillations,)."""
        frequency: np.ndarray = np.abs(self._ringing) / (2 * np.pi)
        return frequency

    @property
    def damping(self) -> np.ndarray:
        """Ratio, 1, of each oscillation, shape (oscillations,)."""
        ratio: np.ndarray = -self._ringing.real / np.abs(self._ringing)
        return ratio

    @property
    def _ringing(self) -> np.ndarray:
        ringing: np.ndarray = self.poles[self.poles.imag > 0]
        return ringing

    def response(self, omega: np.ndarray, order: int, inputs: int) -> tuple[np.ndarray, np.ndarray]:
        """Return what the first forces do, at all the forces' places and at the sensors.

        Parameters
        ----------
        omega : array, shape (bins,), rad/s
        order : int
            Of the derivative: 0 for displacements, 1 for velocities, 2 for accelerations.
        inputs : int
            How many of the forces.

        Returns
        -------
        complex arrays, shapes (bins, forces, inputs) and (bins, sensors, inputs), m/s^order per N
        """
        s = 1j * omega[:, None]
        shared = s**order / (s**2 - 2 * self.poles.real * s + np.abs(self.poles) ** 2)

        def through(outlet: np.ndarray) -> np.ndarray:
            residue = outlet[:, None, :] * self.inlet[None, :inputs, :]
            slope, rest = residue.real, -(residue * self.poles.conj()).real
            modes, shape = len(self.poles), (-1, len(outlet), inputs)
            steep, flat = (each.reshape(-1, modes).T for each in (slope, rest))
            whole: np.ndarray = (s * (shared @ steep) + shared @ flat).reshape(shape)
            return whole

        return through(self.outlet), through(self.sensors)

    def kept(self, modes: np.ndarray) -> "Structure":
        """Return the structure with these modes only, an index or bool array of shape (modes,)."""
        return Structure(self.poles[modes], self.inlet[:, modes], self.outlet[:, modes], self.sensors[:, modes])

    def moved(self, factor: np.ndarray) -> "Structure":
        """Return the structure with its poles times `factor`, shape (modes,), 1: other stiffness, the same masses."""
        return replace(self, poles=self.poles * factor, inlet=self.inlet / factor)

    def resized(self, factor: float) -> "Structure":
        """Return a structure of the same form and stuff whose frequencies are `factor` times as high: it is smaller."""
        return Structure(
            self.poles * factor,
            self.inlet * factor**0.5,
            self.outlet * factor**1.5,
            self.sensors * factor**1.5,
        )


def from_modes(frequency: np.ndarray, damping: np.ndarray, forces: np.ndarray, sensors: np.ndarray) -> Structure:
    """Return a structure of mass-normalised modes that are damped one by one.

    Parameters
    ----------
    frequency : array, shape (modes,), Hz
    damping : array, shape (modes,), 1
        Ratios, below 1.
    forces : array, shape (forces, modes), 1/sqrt(kg)
    sensors : array, shape (sensors, modes), 1/sqrt(kg)
    """
    omega = 2 * np.pi * frequency
    ringing = omega * np.sqrt(1 - damping**2)
    return Structure(-damping * omega + 1j * ringing, forces / (1j * ringing), forces + 0j, sensors + 0j)


def from_state_space(dynamics: np.ndarray, inlet: np.ndarray, outlet: np.ndarray, sensors: np.ndarray) -> Structure:
    """Return a structure of any dynamics x' = A x + B F, by its eigenvalues, which must be distinct.

    Parameters
    ----------
    dynamics : array, shape (states, states), 1/s
    inlet : array, shape (states, forces), any unit
    outlet : array, shape (forces, states), any unit
        Displacement at each force.
    sensors : array, shape (sensors, states), any unit
        Displacement at each accelerometer.
    """
    poles, right = np.linalg.eig(dynamics)
    order = np.lexsort((poles.real, np.abs(poles)))
    modes = order[poles[order].imag >= 0]
    weight = np.where(poles[modes].imag > 0, 2.0, 1.0)
    left = np.linalg.solve(right, inlet.astype(complex))
    return Structure(
        poles[modes] + 0j, left[modes].T, outlet @ right[:, modes] * weight, sensors @ right[:, modes] * weight
    )
