"""The torque-position map of the joint that is being moved, with the model that fits it so far, for the page."""

from concurrent.futures import Executor, Future

import numpy as np

from calibration.joint_clamping.extraction import extract
from calibration.joint_clamping.joint_model import JointModel
from calibration.joint_clamping.torque_map import TorqueMap, TorqueMapError
from rigkit.service.rig import Desk
from rigkit.service.show import Axis, Curves, Trace
from stagectl.wire.robot import RATE

POINTS = 1_500
"""Drawn of a map."""
LOOKS = 100
"""Places at which the spring is drawn."""
FITTED_FROM = 2
"""Cycles: the model is fitted to as many and more."""

Growing = tuple[int, int, np.ndarray, np.ndarray]
"""Joint from 0, cycles, and angle and torque so far, as `ClampRun.growing` has them."""


class LiveMap:
    """Draws maps on a desk, each over the angle from its mean; a model is fitted as each cycle ends.

    Parameters
    ----------
    desk : Desk
    work : Executor
        Fits; where a robot waits for this process, in another one.
    """

    def __init__(self, desk: Desk, work: Executor) -> None:
        self._desk, self._work = desk, work
        self._joint, self._cycles = -1, 0
        self._fit: Future[JointModel | None] | None = None
        self._model: JointModel | None = None

    def draw(self, growing: Growing | None) -> None:
        """Draw what has come of the joint that is moved now; nothing where none is."""
        if growing is None or len(growing[2]) < 2:
            return
        joint, cycles, angle, torque = growing
        if joint != self._joint:
            self._joint, self._cycles, self._fit, self._model = joint, 0, None, None
        if cycles > self._cycles and cycles >= FITTED_FROM and self._fit is None:
            self._cycles, self._fit = cycles, self._work.submit(fitted, angle.astype(float), torque.astype(float))
        if self._fit is not None and self._fit.done():
            self._model, self._fit = self._fit.result() or self._model, None
        self.show(joint, f"{cycles} cycles", angle, torque, self._model)

    def show(self, joint: int, told: str, angle: np.ndarray, torque: np.ndarray, model: JointModel | None) -> None:
        """Draw a map, with a model where there is one.

        Parameters
        ----------
        joint : int
            From 0.
        told : str
            Behind the joint's number in the title.
        angle, torque : arrays, shape (samples,), rad and N m
        model : JointModel or None
        """
        middle, step = float(angle.mean()), max(1, len(angle) // POINTS)
        traces = [Trace("measured", angle[::step] - middle, torque[::step])]
        if model is not None:
            places = np.linspace(angle.min(), angle.max(), LOOKS)
            traces.append(Trace("spring, fitted", places - middle, model.spring_torque(places), "reference"))
            told += f", backlash {model.backlash_said}"
        axes = Axis("motor's angle from its mean", "rad"), Axis("torque", "N m")
        self._desk.show(f"map_{joint + 1}", Curves(f"Joint {joint + 1}: {told}", *axes, tuple(traces)))


def fitted(angle: np.ndarray, torque: np.ndarray) -> JointModel | None:
    """Return the model of a map as far as it has come, or None where it has none yet.

    Parameters
    ----------
    angle, torque : arrays, shape (samples,), rad and N m
    """
    try:
        return extract(TorqueMap(angle, torque, RATE))
    except TorqueMapError:
        return None
