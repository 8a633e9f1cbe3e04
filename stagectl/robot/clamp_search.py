"""The clamping procedure as a block: soft servo, clamp, clamp check, zero-torque search, alternating motions."""

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.robot import clamp_search_kernel as kernel
from stagectl.robot.clamp_procedure import KINDS, ClampProcedure

_CAUSES = {
    kernel.NUMBER: "angle or torque of joint {joint} is not a number",
    kernel.PORT: "the robot port is at fault",
    kernel.TORQUE: "the torque of joint {joint} is beyond its limit of {torque:g} N m",
    kernel.TRAVEL: "the clamp slips: joint {joint} has moved by more than {travel:g} mrad",
    kernel.REACH: "the reference of joint {joint} is {reach:g} mrad off and its torque is not reached: is it clamped?",
    kernel.NO_ZERO: "no zero torque was found within {rounds} rounds, last at joint {joint}",
    kernel.NO_ANSWER: "step {kind!r} was not answered within {patience:g} s",
    kernel.OPENED: "the clamp has opened",
    kernel.OUTSIDE: "{reason}",
}


class ClampSearch(Block):
    """Take an arm through the clamping procedure, a step after the other, and stop safely where something is wrong.

    It starts from the arm's measured angles.  A fault latches: references stay where they are, or, where a torque was
    too large in the clamp, go back to where there was little; soft servo and clamp stay as they are for a person to
    look at.  `prepare` begins anew.

    Ports: `angle` (rad) and `torque` (N m) of the motors on the joints' side, one wide a joint; `softened`, `clamped`,
    `fault` (1 for yes) in; `reference` (rad), one wide a joint, `soft`, `clamp` (1 for on) and `joint` (the one that
    is moved to and fro, from 1; else 0) out.

    Parameters
    ----------
    procedure : ClampProcedure

    Source
    ------
    Sornmo 2015, 4.3, Clamping Procedure.

    Departs
    -------
    A clamp check before the search; motions turn by torque, not by distance, so that a stiff joint is not overloaded
    and a soft one is not left in its backlash.
    """

    def __init__(self, procedure: ClampProcedure) -> None:
        joints = procedure.arm.joints
        self.inputs = (
            Port("angle", "rad", joints),
            Port("torque", "N m", joints),
            Port("softened"),
            Port("clamped"),
            Port("fault"),
        )
        self.outputs = (Port("reference", "rad", joints), Port("soft"), Port("clamp"), Port("joint"))
        self.procedure = procedure
        self.steps = procedure.steps()
        self._reason = ""
        self._program = np.array([[KINDS.index(step.kind), step.joint] for step in self.steps])
        self._targets = np.zeros((len(self.steps), joints))
        for place, step in enumerate(self.steps):
            self._targets[place] = step.target or 0.0
        self._joints, self._state = np.zeros(joints, kernel.JOINT), np.zeros(1, kernel.STATE)

    def prepare(self, rate: float, frames: int) -> None:
        """Begin with the first step."""
        limits, joints, state = self.procedure.limits, self._joints, self._state
        joints[:], state[:], self._reason = np.zeros(1, joints.dtype), np.zeros(1, state.dtype), ""
        joints["speed"], joints["most"], joints["turn"] = np.divide(limits.speed, rate), limits.torque, limits.turn
        joints["proof"], joints["quiet_below"], joints["travels"] = limits.proof, limits.quiet, limits.travel
        joints["reaches"], joints["first_step"] = limits.reach, limits.search_step
        state["steps"], state["rounds"], state["pushes"] = len(self.steps), limits.rounds, 2 * limits.cycles + 1
        state["approach"], state["settle"] = limits.approach / rate, max(1, round(limits.settle * rate))
        state["patience"] = round(limits.patience * rate)

    def process(
        self,
        angle: np.ndarray,
        torque: np.ndarray,
        softened: np.ndarray,
        clamped: np.ndarray,
        fault: np.ndarray,
        reference: np.ndarray,
        soft: np.ndarray,
        clamp: np.ndarray,
        joint: np.ndarray,
    ) -> None:
        """Go on for one frame."""
        seen, asked = (angle, torque, softened, clamped, fault), (reference, soft, clamp, joint)
        kernel.run(seen, asked, self._program, self._targets, self._joints, self._state)

    def pause(self) -> None:
        """Stay where it is (between ticks); limits are watched on."""
        self._state["paused"] = True

    def resume(self) -> None:
        """Go on after a pause (between ticks)."""
        self._state["paused"] = False

    def abort(self, reason: str) -> None:
        """Hold, for a reason from outside (between ticks)."""
        if self.cause is None:
            self._reason = reason
            kernel.abort(self._state[0], kernel.OUTSIDE, 0)

    @property
    def step(self) -> int:
        """The step it is at, from 0; their number when all are done."""
        return int(self._state["step"][0])

    @property
    def cycles(self) -> int:
        """How often the joint that is moved to and fro has gone both ways."""
        return int(self._state["part"][0]) // 2 if self.step < len(self.steps) else 0

    @property
    def done(self) -> bool:
        """Whether all steps are done."""
        return self.step == len(self.steps)

    @property
    def cause(self) -> str | None:
        """Why it was aborted, or None."""
        cause, place, limits = int(self._state["cause"][0]), int(self._state["joint"][0]), self.procedure.limits
        if cause == 0:
            return None
        number = min(place, self.procedure.arm.joints - 1)
        return _CAUSES[cause].format(
            joint=place + 1,
            torque=limits.torque[number],
            travel=1e3 * limits.travel[number],
            reach=1e3 * limits.reach[number],
            rounds=limits.rounds,
            kind=KINDS[place],
            patience=limits.patience,
            reason=self._reason,
        )
