"""Iterative learning control of a milled path, (5.8) and (5.11): one law, whatever the error was measured with."""

from dataclasses import dataclass, replace

import numpy as np

from calibration.state_space.model import InnovationModel
from stagectl.robot.milling.axis_model import AxisModel, robot_response
from stagectl.robot.milling.measured_cut import MeasuredCut
from stagectl.robot.milling.model_inverse import inverse
from stagectl.robot.milling.zero_phase import filtered, low_pass
from stagectl.robot.pocket_config import Inverse

AXES = 3


@dataclass(frozen=True, eq=False)
class ProcessModel:
    """What milling adds to the robot: f = G_M y_n and d = G_K f.

    Parameters
    ----------
    force : InnovationModel, three inputs and outputs
        G_M, from the tool's position (m) to the force on it (N).
    compliance : InnovationModel, three inputs and outputs
        G_K, from the force on the tool (N) to its deflection (m).

    Source
    ------
    Sörnmo 2015, eq. (5.1).
    """

    force: InnovationModel
    compliance: InnovationModel

    def __post_init__(self) -> None:
        """Refuse models of other signals."""
        for name, model in (("force", self.force), ("compliance", self.compliance)):
            if (model.inputs, model.outputs) != (AXES, AXES):
                raise ValueError(f"the {name} model is {model.outputs} x {model.inputs}, must be 3 x 3")

    def coupling(self, frequency: np.ndarray) -> np.ndarray:
        """Return G_K G_M, complex, shape (bins, 3, 3), 1, at frequencies, shape (bins,), Hz."""
        found: np.ndarray = self.compliance.frequency_response(frequency) @ self.force.frequency_response(frequency)
        return found

    def deflection(self, load: np.ndarray, rate: float) -> np.ndarray:
        """Return G_K f over a whole trial, shape (N, 3), m, for the force on the tool.

        Parameters
        ----------
        load : array, shape (N, 3), N
        rate : float, samples/s
        """
        return filtered(load, rate, self.compliance.frequency_response)


@dataclass(frozen=True, eq=False)
class PathLaw:
    """u_{k+1} = u_k + Q L (I - G_K G_M) e_k.

    Without a process it is the law of free space (5.8), with one that of milling (5.11).  Methods 1 to 3 share it and
    differ in e alone.

    Parameters
    ----------
    axes : three AxisModel
        G_R of x, y and z.
    process : ProcessModel or None
    cutoff : float, Hz
        Of Q, a low-pass without phase.
    highest : float, Hz
        Nothing is learned above, since no model knows anything there.
    gain : float, 1
        Factor on the correction; 1 for all of it at once.
    kind : "regularised" or "mirrored"
        How L inverts G_R.
    epsilon : float, 1
        Of the regularised inverse.
    share : float, 0 to 1
        Part of G_K G_M that is undone.
    caution : (array, array), shapes (bins,) and (bins, 3), Hz and 1, or None
        By what Q is multiplied beside, at frequencies that rise, along each direction.

    Source
    ------
    Sörnmo 2015, eqs (5.8) and (5.11).

    Departs
    -------
    (5.11) undoes all of G_K G_M.  But where the path meets no material there is none to undo, and an error would grow;
    `share` says how much is undone everywhere.
    """

    axes: tuple[AxisModel, ...]
    process: ProcessModel | None = None
    cutoff: float = 10.0
    highest: float = 25.0
    gain: float = 1.0
    kind: Inverse = "regularised"
    epsilon: float = 1e-3
    share: float = 1.0
    caution: tuple[np.ndarray, np.ndarray] | None = None

    def passed(self, frequency: np.ndarray) -> np.ndarray:
        """Return Q times the gain, real, shape (bins, 3), 1, at frequencies, shape (bins,), Hz."""
        passed = self.gain * low_pass(frequency, self.cutoff, highest=self.highest)
        return np.asarray(passed[:, None] * self._caution_at(frequency))

    def more_cautious(self, frequency: np.ndarray, part: np.ndarray) -> "PathLaw":
        """Return a law whose Q is multiplied by `part` at most, shapes (bins,) and (bins, 3), Hz rising and 1."""
        return replace(self, caution=(frequency, np.minimum(part, self._caution_at(frequency))))

    def step(self, frequency: np.ndarray) -> np.ndarray:
        """Return Q L (I - G_K G_M), complex, shape (bins, 3, 3), 1, at frequencies, shape (bins,), Hz."""
        rows = np.stack([inverse(axis, frequency, self.kind, self.epsilon) for axis in self.axes], axis=-1)
        found: np.ndarray = (self.passed(frequency) * rows)[..., None] * (
            np.eye(AXES) - self.share * self._coupling(frequency)
        )
        return found

    def plant(self, frequency: np.ndarray) -> np.ndarray:
        """Return (I - G_K G_M)^-1 G_R of (5.10), complex, shape (bins, 3, 3), 1, at frequencies, shape (bins,), Hz."""
        found: np.ndarray = np.linalg.solve(
            np.eye(AXES) - self._coupling(frequency), robot_response(self.axes, frequency)
        )
        return found

    def _caution_at(self, frequency: np.ndarray) -> np.ndarray:
        if self.caution is None:
            return np.ones((len(frequency), AXES))
        known, parts = self.caution
        return np.stack([np.interp(frequency, known, each) for each in parts.T], axis=-1)

    def _coupling(self, frequency: np.ndarray) -> np.ndarray:
        if self.process is None:
            return np.zeros((len(frequency), AXES, AXES), complex)
        return self.process.coupling(frequency)


def update(sent: np.ndarray, error: np.ndarray, law: PathLaw, cut: MeasuredCut | None = None) -> np.ndarray:
    """Return the path to send in the next trial, u_{k+1}, shape (N, 3), m.

    Parameters
    ----------
    sent : array, shape (N, 3), m
        u_k, the path sent in this one.
    error : array, shape (N, 3), m
        e_k, sample by sample beside it.
    law : PathLaw
    cut : MeasuredCut, optional
        Stands for G_K G_M of the law.

    Raises
    ------
    ValueError : lengths that differ, or a value that is not finite.
    """
    sent, error = np.asarray(sent, float), np.asarray(error, float)
    if sent.shape != error.shape:
        raise ValueError(f"the path sent has shape {sent.shape} and the error {error.shape}, must be alike")
    return np.asarray(sent + correction(error, law, cut))


def correction(error: np.ndarray, law: PathLaw, cut: MeasuredCut | None = None) -> np.ndarray:
    """Return Q L (I - G_K G_M) e, shape (N, 3), m.

    Parameters
    ----------
    error : array, shape (N, 3), m
    law : PathLaw
    cut : MeasuredCut, optional
        Stands for G_K G_M of the law.
    """
    rate = law.axes[0].rate
    if cut is None:
        return filtered(error, rate, law.step)
    return filtered(error - cut.deflection(error, rate), rate, replace(law, process=None).step)


def predicted(position: np.ndarray, change: np.ndarray, law: PathLaw) -> np.ndarray:
    """Return where the tool is to go in the next trial, shape (N, 3), m, by (5.10).

    Parameters
    ----------
    position : array, shape (N, 3), m
        y_n of this trial, measured or estimated.
    change : array, shape (N, 3), m
        u_{k+1} - u_k.
    law : PathLaw
    """
    return np.asarray(position + filtered(change, law.axes[0].rate, law.plant))
