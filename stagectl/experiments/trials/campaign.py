"""Trials one after another: free space is learned first, then the pocket, by one method or by several."""

import re
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np

from stagectl.experiments.trials.done import DoneTrial
from stagectl.experiments.trials.signals import torque_log, touched_block, touched_off, tracker_late
from stagectl.experiments.trials.tool_path import RATE, refuse_large, refuse_outside
from stagectl.experiments.trials.trial import Trial
from stagectl.robot.config import CellConfig
from stagectl.robot.milling.convergence import Contraction, Doubt, cautious, contraction
from stagectl.robot.milling.learning import LearningLaw, ProcessModel, predicted, update
from stagectl.robot.milling.measured_cut import MeasuredCut
from stagectl.robot.milling.milling_models import MillingModels
from stagectl.robot.milling.step_size import heeding
from stagectl.robot.milling.trial_error import TrialSignals, kinematic_error, measured_cut, tool_position

Steps = Generator[tuple[str, Trial], DoneTrial]
"""Gives a trial and its name, one after another, and is sent what came of each."""
BLOCK = 100
"""Trials of a method: each method mills blocks of its own."""
Forces = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""From motor angles (rad) and torques (N m), shapes (N, 6), to the force on the tool, shape (N, 3), N; NaN in a gap."""
FREE, FIRST = "free", "milled-0"
"""Names of trials in the air, and of the one in material that no method has learned from yet."""
SIDE = {None: "tool", 1: "tool", 2: "motors", 3: "motors"}
"""Which G_R a method inverts: the one to what its error is made of; None is free space."""
FORCE = {1: "measured", 2: "measured", 3: "estimated"}
"""Which force the process model of a method belongs to."""


@dataclass(eq=False)
class Learner:
    """The models, the laws that follow from them, and what is known of free space.

    Parameters
    ----------
    cell : CellConfig
    models : MillingModels
    forces : Forces or None
        Method 3 needs it.
    """

    cell: CellConfig
    models: MillingModels
    forces: Forces | None = None
    free: list[DoneTrial] = field(default_factory=list)

    def law(self, method: int | None) -> LearningLaw:
        """Return the law of a method, or of free space, as cautious as the doubt about its models asks for."""
        learning = self.cell.learning
        whole = LearningLaw(
            self.models.robot[SIDE[method]].axes, self._process(method), learning.cutoff, learning.highest,
            learning.gain, learning.inverse, learning.epsilon,
        )  # fmt: skip
        return cautious(whole, self._doubt(method))

    def contraction(self, method: int | None) -> Contraction:
        """Return by what errors shrink under a method, for all that the models may be instead."""
        return contraction(self.law(method), self._doubt(method))

    def _process(self, method: int | None) -> ProcessModel | None:
        if method is None:
            return None
        if FORCE[method] not in self.models.process:
            raise ValueError(f"method {method} needs G_M and G_K of the {FORCE[method]} force, the model has none")
        return self.models.process[FORCE[method]].model

    def _cut(
        self, trial: TrialSignals, method: int | None, process: ProcessModel | None, kinematic: np.ndarray | None
    ) -> MeasuredCut | None:
        """Return how the cut answered along a trial; None where the law goes by G_M, or by no process."""
        if method is None or process is None or kinematic is None or self.cell.learning.cut == "model":
            return None
        return measured_cut(trial, method, RATE, process, kinematic)

    def _doubt(self, method: int | None) -> Doubt:
        return self.models.doubt(SIDE[method], None if method is None else FORCE[method])

    def next_path(self, done: Sequence[DoneTrial], method: int | None) -> np.ndarray:
        """Return the path of the next trial, shape (N, 3), m.

        Parameters
        ----------
        done : sequence of DoneTrial
            The trials so far: the last one is learned from, the one before tells how much of a correction proves right.
        method : int or None
            None for free space.

        Raises
        ------
        ValueError : a law that may diverge, a signal that is missing, a path that leaves the workpiece.
        """
        kinematic = None if method is None else kinematic_error([each.signals for each in self.free])
        return self.corrected(done[-1].trial, [self.signals(each, method) for each in done], method, kinematic)

    def corrected(
        self, trial: Trial, signals: Sequence[TrialSignals], method: int | None, kinematic: np.ndarray | None
    ) -> np.ndarray:
        """Return the path of the trial after those with these signals, shape (N, 3), m.

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
        cuts = [self._cut(each, method, process, kinematic) for each in signals[-2:]]
        law = heeding(law, [each.sent for each in signals], where, cuts[0])
        sent = update(signals[-1].sent, trial.path.wanted - where[-1], law, cuts[-1])
        come = predicted(where[-1], sent - signals[-1].sent, law)
        refuse_outside(trial.path.pocket, trial.path.wanted, come, self.cell.learning.stray)
        refuse_large(trial.path.wanted, sent, self.cell.learning.correction)
        return sent

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


def learn_free_space(first: Trial, learner: Learner) -> Generator[tuple[str, Trial], DoneTrial, Trial]:
    """Run the path in the air, and learn it; return the first trial in material, u_0 = u_c.

    Parameters
    ----------
    first : Trial
    learner : Learner
        Gets the trials.
    """
    trial = first
    for number in range(learner.cell.learning.free):
        done = yield f"{FREE}-{number}", trial
        if number == 0:  # where the tool rests is where the tracker has the workpiece, and where that is clamped
            trial = replace(trial, late=tracker_late(trial, done.records))
            touched = touched_off(trial, done.records), touched_block(trial, done.records)
            trial = replace(trial, zero=touched[0], block=touched[1])
            done = DoneTrial(done.name, trial, done.records)
        learner.free.append(done)
        trial = trial.again(learner.next_path([done], None), False)
    learner.free.append((yield f"{FREE}-{learner.cell.learning.free}", trial))
    return trial.again(trial.sent, True)


def learn_pocket(first: DoneTrial, learner: Learner, method: int, iterations: int) -> Steps:
    """Learn from a trial in material, again and again.

    Parameters
    ----------
    first : DoneTrial
        Iteration 0.
    learner : Learner
    method : int
    iterations : int
    """
    done = [first]
    for iteration in range(1, iterations + 1):
        sent = learner.next_path(done, method)
        trial = replace(first.trial.again(sent, True), number=BLOCK * method + first.trial.number + iteration)
        done.append((yield f"method-{method}-{iteration}", trial))


def learn(first: Trial, learner: Learner, methods: Sequence[int], iterations: int) -> Steps:
    """Learn free space, mill, and learn the pocket by each method from the same first trial.

    Parameters
    ----------
    first : Trial
    learner : Learner
    methods : sequence of int
    iterations : int
    """
    milled = yield FIRST, (yield from learn_free_space(first, learner))
    for method in methods:
        yield from learn_pocket(milled, learner, method, iterations)


def names_of(free: int, methods: Sequence[int], iterations: int) -> list[str]:
    """Return the names of all trials of `learn`, in order.

    Parameters
    ----------
    free : int
        `learning.free`.
    methods : sequence of int
    iterations : int
    """
    learned = [f"method-{method}-{iteration}" for method in methods for iteration in range(1, iterations + 1)]
    return [*(f"{FREE}-{number}" for number in range(free + 1)), FIRST, *learned]


Result = TypeVar("Result")


def carried_out(
    steps: Generator[tuple[str, Trial], DoneTrial, Result], run: Callable[[str, Trial], DoneTrial]
) -> Result:
    """Run one trial after another; return what they are for.

    Parameters
    ----------
    steps : generator
        As `learn_free_space`, or one of `Steps`.
    run : callable(name, Trial) -> DoneTrial
        Raises where a trial does not come to its end.
    """
    try:
        asked = next(steps)
        while True:
            asked = steps.send(run(*asked))
    except StopIteration as end:
        result: Result = end.value
        return result


def grouped(trials: Sequence[DoneTrial]) -> tuple[list[DoneTrial], dict[int, list[DoneTrial]]]:
    """Return trials in the air, and those of each method with iteration 0 first.

    Parameters
    ----------
    trials : sequence of DoneTrial
        That came to their end, in the order of their numbers.
    """
    free = [each for each in trials if re.fullmatch(rf"{FREE}-\d+", each.name)]
    first = [each for each in trials if each.name == FIRST]
    learned: dict[int, list[DoneTrial]] = {}
    for each in trials:
        if found := re.fullmatch(r"method-(\d)-\d+", each.name):
            learned.setdefault(int(found[1]), list(first)).append(each)
    if free and free[-1].trial.zero is not None:  # the first was run before it was known where the tracker has the work
        last = free[-1].trial
        free[0] = replace(free[0], trial=replace(free[0].trial, zero=last.zero, block=last.block, late=last.late))
    return free, learned


def norms(done: Sequence[DoneTrial]) -> list[float]:
    """Return the Euclidean norm of each trial's mean absolute errors, m, as in Table 5.1."""
    return [float(np.linalg.norm(each.mae)) for each in done]


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
