"""The lost motion of joints that turn around, fed forward: backlash, and the wind-up that friction makes."""

from dataclasses import dataclass

import numpy as np

from stagectl.robot.arm import Arm
from stagectl.robot.kinematics import jacobian
from stagectl.robot.milling.agreement import agreement
from stagectl.robot.milling.trial_error import TrialSignals, slow
from stagectl.robot.milling.witness import ALIKE, BENDS


@dataclass(frozen=True, eq=False)
class LostMotion:
    """How far joints' links stay behind their motors to either side, where friction drags them.

    Parameters
    ----------
    half : array, shape (6,), rad
        Half of the backlash, and Coulomb's torque over the gear's stiffness; 0 of a joint that is left out.

    Source
    ------
    Sörnmo 2015, ch. 4: backlash and stiffness of a clamped joint.  The link follows as a play operator of its motor:
    Tao and Kokotovic 1996, Adaptive Control of Systems with Actuator and Sensor Nonlinearities, ch. 2.
    """

    half: np.ndarray

    def lead(self, angle: np.ndarray) -> np.ndarray:
        """Return by what motors are before their links, shape (N, 6), rad; none as the trial begins.

        Parameters
        ----------
        angle : array, shape (N, 6), rad
            Of the motors, or of the links: in the lead of either the other's is the same but for its crossing.
        """
        found, now = np.zeros_like(angle), np.zeros(len(self.half))
        for n, turn in enumerate(np.diff(angle, axis=0), start=1):
            now = np.clip(now + turn, -self.half, self.half)
            found[n] = now
        return found

    def carried(self, angle: np.ndarray, rate: float, cutoff: float, fastest: np.ndarray) -> np.ndarray:
        """Return what a path carries beside its joint angles, shape (N, 6), rad.

        Parameters
        ----------
        angle : array, shape (N, 6), rad
            Of the path that is wanted.
        rate : float, samples/s
        cutoff : float, Hz
            A gap is crossed as fast as this low-pass without phase has it.
        fastest : array, shape (6,), rad/s
            A joint that would be faster with it carries as much less.
        """
        lead = slow(self.lead(angle), cutoff, rate)
        speed, more = (np.abs(np.diff(each, axis=0)).max(axis=0) * rate for each in (angle, lead))
        room = np.clip((fastest - speed) / np.maximum(more, np.finfo(float).tiny), 0.0, 1.0)
        return np.asarray(room * lead)

    def refusal(self, arm: Arm, angle: np.ndarray, signals: TrialSignals, inside: np.ndarray, rate: float) -> str:
        """Return why a trial in the air does not show it, or nothing: the tracker is the witness.

        Parameters
        ----------
        arm : Arm
            With its tool.
        angle : array, shape (N, 6), rad
            Of the motors.
        signals : TrialSignals
            Seen by the tracker.
        inside : array, shape (N,)
            Which samples count.
        rate : float, samples/s
        """
        assert signals.seen is not None
        behind = -np.einsum("nij,nj->ni", jacobian(arm, angle)[:, :3], self.lead(angle))
        found = agreement((signals.seen - signals.joints)[inside], behind[inside], rate)
        if found.correlation >= ALIKE and BENDS[0] <= found.slope <= BENDS[1]:
            return ""
        return (
            f"the tracker saw the tool off the motors by {found.slope:.2f} times what backlash and friction have it "
            f"(correlation {found.correlation:.2f}), must be {BENDS[0]:g} to {BENDS[1]:g} (and {ALIKE:g}): the links "
            "do not follow their motors as friction would drag them, it is taken out of the path again"
        )
