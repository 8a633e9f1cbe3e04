"""The models of a cell that mills, and the laws that follow from them, method by method."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from stagectl.experiments.trials.done import DoneTrial
from stagectl.experiments.trials.guarded_path import refuse_guarded
from stagectl.experiments.trials.lookback import Step
from stagectl.experiments.trials.methods import Milled, method_of
from stagectl.experiments.trials.signals import ANGLE, torque_log
from stagectl.experiments.trials.tool_path import RATE, refuse_large, refuse_outside
from stagectl.experiments.trials.trial import Trial
from stagectl.robot.config import CellConfig
from stagectl.robot.milling.convergence import Contraction, Doubt, cautious, contraction
from stagectl.robot.milling.learning import PathLaw, ProcessModel, correction, predicted
from stagectl.robot.milling.lost_motion import LostMotion
from stagectl.robot.milling.measured_cut import MeasuredCut
from stagectl.robot.milling.milling_models import TOOL, MillingModels
from stagectl.robot.milling.step_size import witnessed
from stagectl.robot.milling.trial_error import TrialSignals, kinematic_error, measured_cut, tool_position
from stagectl.robot.milling.witness import refuse_other_compliance, refuse_other_force, refuse_other_robot
from stagectl.robot.milling.zero_phase import filtered

Forces = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""From motor angles (rad) and torques (N m), shapes (N, 6), to the force on the tool, shape (N, 3), N; NaN in a gap."""


@dataclass(eq=False)
class Learner:
    """The models, the laws that follow from them, and what is known of free space.

    Parameters
    ----------
    cell : CellConfig
    models : MillingModels
    forces : Forces or None
        Method 3 needs it.
    note : callable(str)
        Told where learning turns back, or ends early.
    leave_out : callable(int, str)
        Told of a method that is refused, and why, where there are others.
    lost : LostMotion or None
        What the path carries from the first trial on.
    """

    cell: CellConfig
    models: MillingModels
    forces: Forces | None = None
    free: list[DoneTrial] = field(default_factory=list)
    note: Callable[[str], object] = lambda _: None
    leave_out: Callable[[int, str], object] = lambda *_: None
    lost: LostMotion | None = None

    def carried(self, first: Trial) -> np.ndarray:
        """Return what the first path carries beside the one that is wanted, shape (N, 3), m: joints' lost motion."""
        if self.lost is None:
            return np.zeros_like(first.path.wanted)
        fastest = self.cell.limits.speed * first.arm.speed
        angle = first.path.joints(first.arm, first.path.wanted)
        more = self.lost.carried(angle, RATE, self.cell.learning.cutoff, fastest)
        return np.asarray(first.path.in_workpiece(first.arm, angle + more) - first.path.wanted)

    def judged(self, free: DoneTrial, step: Step) -> Step:
        """Return the step after the first trial in the air, without what its path carried if the tracker denies that.

        Parameters
        ----------
        free : DoneTrial
        step : Step
            As learned from it.
        """
        if self.lost is None:
            return step
        angle, inside = free.records["trial"].select(ANGLE.channels).data, free.trial.path.milled
        why = self.lost.refusal(free.trial.arm, angle, free.signals, inside, RATE)
        if not why:
            return step
        self.note(f"{free.name}: {why}")
        left = self.unlearned(free.trial, None)
        return replace(step, sent=step.sent - left, come=predicted(step.come, -left, self.law(None)))

    def unlearned(self, first: Trial, method: int | None) -> np.ndarray:
        """Return what is left of what the first path carries once a method, or free space, has learned: (N, 3), m."""
        law, carried = self.law(method), self.carried(first)
        return np.asarray(carried - correction(predicted(np.zeros_like(carried), carried, law), law))

    def law(self, method: int | None) -> PathLaw:
        """Return the law of a method, or of free space, as cautious as the doubt about its models asks for."""
        learning = self.cell.learning
        whole = PathLaw(
            self.models.robot[method_of(method).side].axes, self._process(method), learning.cutoff, learning.highest,
            learning.gain, learning.inverse, learning.epsilon,
        )  # fmt: skip
        return cautious(whole, self._doubt(method))

    def contraction(self, method: int | None) -> Contraction:
        """Return by what errors shrink under a method, for all that the models may be instead."""
        return contraction(self.law(method), self._doubt(method))

    def _process(self, method: int | None) -> ProcessModel | None:
        if method is None:
            return None
        force = method_of(method).force
        if force not in self.models.process:
            raise ValueError(f"method {method} needs G_M and G_K of the {force} force, the model has none")
        return self.models.process[force].model

    def _cut(
        self, trial: TrialSignals, method: int | None, process: ProcessModel | None, kinematic: np.ndarray | None
    ) -> MeasuredCut | None:
        """Return how the cut answered along a trial; None where the law goes by G_M, or by no process."""
        if method is None or process is None or kinematic is None or self.cell.learning.cut == "model":
            return None
        return measured_cut(trial, method, RATE, process, kinematic)

    def _doubt(self, method: int | None) -> Doubt:
        how = method_of(method)
        return self.models.doubt(how.side, how.force or None)

    def refuse_other_robot(self, free: DoneTrial) -> None:
        """Refuse, by ValueError, a G_R by which the robot has not gone in the air."""
        signals = free.signals
        refuse_other_robot(signals.sent, signals.joints, self.models.robot["motors"].axes, free.name)

    def refuse_other_compliance(self, milled: DoneTrial, method: int) -> None:
        """Refuse, by ValueError, force and G_K of a method that do not make what the tracker has seen."""
        kinematic = kinematic_error([each.signals for each in self.free])
        inside = milled.trial.path.milled
        self.refuse_other_force(self.signals(milled, method), kinematic, method, inside, milled.name)

    def refuse_other_force(
        self, signals: TrialSignals, kinematic: np.ndarray, method: int, inside: np.ndarray, source: str
    ) -> None:
        """Refuse, by ValueError, a force that does not go with G_K and the tracker, or without a tracker with G_M.

        Parameters
        ----------
        signals : TrialSignals
            Of a trial in material.
        kinematic : array, shape (N, 3), m
            d_e.
        method : int
            That knows of the tool's place by the force.
        inside : array, shape (N,)
            Which samples are in the material.
        source : str
            What is told of.
        """
        process = self._process(method)
        assert process is not None
        assert signals.force is not None
        bent = process.deflection(signals.force, RATE)
        if signals.seen is not None:
            refuse_other_compliance((signals.seen - signals.joints - kinematic)[inside], bent[inside], RATE, source)
            return
        foreseen = filtered(signals.joints + kinematic + bent, RATE, process.force.frequency_response)
        refuse_other_force(signals.force[inside], foreseen[inside], RATE, source)

    def next_path(self, done: Sequence[DoneTrial], method: int | None) -> Step:
        """Return the path of the next trial, and where it is foreseen to take the tool.

        Parameters
        ----------
        done : sequence of DoneTrial
            The trials so far: the last one is learned from, all of them tell how much of a correction proves right.
        method : int or None
            None for free space.

        Raises
        ------
        ValueError : a law that may diverge, a signal that is missing, a path that leaves the workpiece or its limits.
        """
        kinematic = None if method is None else kinematic_error([each.signals for each in self.free])
        return self.corrected(done[-1].trial, [self.signals(each, method) for each in done], method, kinematic)

    def corrected(
        self, trial: Trial, signals: Sequence[TrialSignals], method: int | None, kinematic: np.ndarray | None
    ) -> Step:
        """Return the path of the trial after those with these signals, and where it is foreseen to take the tool.

        Parameters
        ----------
        trial : Trial
            The last one.
        signals : sequence of TrialSignals
        method : int or None
        kinematic : array, shape (N, 3), m, or None
            d_e; methods 2 and 3 need it, and 1 to see how the cut answers place by place: else it goes by G_M.

        Raises
        ------
        ValueError : as `next_path`.
        """
        self.contraction(method).refuse_divergence()
        law, process = self.law(method), self._process(method)
        where = [tool_position(each, method or 1, RATE, process, kinematic) for each in signals]
        cuts = [self._cut(each, method, process, kinematic) for each in signals]
        seen = self._witness(signals, method)
        beside = seen if method_of(method).is_by_force else []  # method 1 learns from what was seen
        milled = Milled(trial.path.wanted, [each.sent for each in signals], where, cuts, self._air(method), beside)
        sent = method_of(method).law.next(law, milled)
        part = self._witnessed(trial, signals[-1], sent, law) if seen else 1.0
        sent = signals[-1].sent + part * (sent - signals[-1].sent)
        come = predicted(where[-1], sent - signals[-1].sent, law)
        refuse_outside(trial.path.pocket, trial.path.wanted, come, self.cell.learning.stray)
        refuse_large(trial.path.wanted, sent, self.cell.learning.correction)
        refuse_guarded(trial, sent)
        return Step(signals[-1].sent, sent, where[-1], come, trial.path.wanted, trial.path.milled, part)

    def _witness(self, signals: Sequence[TrialSignals], method: int | None) -> list[np.ndarray]:
        """Return where the tracker saw the tool in material, if it saw every trial."""
        seen = [each.seen for each in signals if each.seen is not None]
        return seen if method is not None and len(seen) == len(signals) else []

    def _witnessed(self, trial: Trial, last: TrialSignals, sent: np.ndarray, law: PathLaw) -> float:
        """Return the part of a correction that makes smaller what the tracker saw of the last trial."""
        assert last.seen is not None
        tool, inside = replace(law, axes=self.models.robot[TOOL].axes), trial.path.milled
        change = filtered(sent - last.sent, RATE, tool.plant)
        return witnessed((trial.path.wanted - last.seen)[inside], change[inside], law)

    def _air(self, method: int | None) -> tuple[list[np.ndarray], list[np.ndarray]]:
        """Return the paths in the air, and where the tracker saw the tool, for a method; none in the air."""
        free = [each.signals for each in self.free] if method is not None else []
        return [each.sent for each in free], [each.seen for each in free if each.seen is not None]

    def signals(self, done: DoneTrial, method: int | None) -> TrialSignals:
        """Return a trial's signals, with the force that a method has."""
        if method != 3:
            return done.signals
        return replace(done.signals, force=self.estimated(done))

    def estimated(self, done: DoneTrial) -> np.ndarray:
        """Return the force on the tool from the motors' torques, less what the same path takes in the air: (N, 3), N.

        Parameters
        ----------
        done : DoneTrial

        Raises
        ------
        ValueError : no model of the torques, or a force that is not determined somewhere.
        """
        told = [
            determined(self.forces, *torque_log(each.trial, each.records), each.name) for each in (done, *self.free)
        ]
        return np.asarray(told[0] - np.mean(told[1:], axis=0))


def determined(forces: Forces | None, angle: np.ndarray, torque: np.ndarray, name: str) -> np.ndarray:
    """Return the force on the tool from motors' torques in every sample of a trial, shape (N, 3), N.

    Parameters
    ----------
    forces : Forces or None
    angle, torque : arrays, shape (N, 6), rad and N m
    name : str
        Of the trial, for what is refused.

    Raises
    ------
    ValueError : no model of the torques, or a sample in which the force is not determined.
    """
    if forces is None:
        raise ValueError("method 3 needs gravity and friction of the joints, the model has none")
    estimate = forces(angle, torque)
    lost = np.flatnonzero(~np.isfinite(estimate).all(axis=1))
    if len(lost):
        raise ValueError(
            f"{name}: the force is not determined at {lost[0] / RATE:.4g} s: torques are missing there, or a joint is "
            "faster than its friction is known"
        )
    return estimate
