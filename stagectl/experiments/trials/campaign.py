"""Trials one after another: free space is learned first, then the pocket, by one method or by several."""

import re
from collections.abc import Callable, Generator, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np

from stagectl.experiments.trials.done import DoneTrial
from stagectl.experiments.trials.laws import Learner
from stagectl.experiments.trials.lookback import WORSE, Lookback, size
from stagectl.experiments.trials.methods import FREE_SPACE, method_of
from stagectl.experiments.trials.signals import touched_block, touched_off, tracker_late
from stagectl.experiments.trials.trial import Trial

Steps = Generator[tuple[str, Trial], DoneTrial]
"""Gives a trial and its name, one after another, and is sent what came of each."""
BLOCK = 100
"""Trials of a method: each method mills blocks of its own."""
FREE, FIRST = "free", "milled-0"
"""Names of trials in the air, and of the one in material that no method has learned from yet."""


def learn_free_space(first: Trial, learner: Learner) -> Generator[tuple[str, Trial], DoneTrial, Trial]:
    """Run the path in the air, and learn it; return the first trial in material, u_0 = u_c.

    Parameters
    ----------
    first : Trial
    learner : Learner
        Gets the trials.
    """
    trial, least = replace(first, sent=FREE_SPACE.law.first(first.path) + learner.carried(first)), np.inf
    for number in range(learner.cell.learning.free):
        done = yield f"{FREE}-{number}", trial
        if number == 0:  # where the tool rests is where the tracker has the workpiece, and where that is clamped
            trial = replace(trial, late=tracker_late(trial, done.records))
            touched = touched_off(trial, done.records), touched_block(trial, done.records)
            trial = replace(trial, zero=touched[0], block=touched[1])
            done = DoneTrial(done.name, trial, done.records)
            learner.refuse_other_robot(done)
        least = refuse_worse(done, least)
        learner.free.append(done)
        step = learner.next_path(learner.free, None)
        step = learner.judged(done, step) if number == 0 else step
        trial = trial.again(step.sent, False, step.foreseen)
    learner.free.append((yield f"{FREE}-{learner.cell.learning.free}", trial))
    refuse_worse(learner.free[-1], least)
    return trial.again(trial.sent, True)


def refuse_worse(free: DoneTrial, least: float) -> float:
    """Refuse, by ValueError, trials in the air that get worse: nothing is milled then; return the least error, m.

    Parameters
    ----------
    free : DoneTrial
    least : float, m
        Of those before.
    """
    found = size(free)
    if found > WORSE * least:
        raise ValueError(
            f"{free.name}: in air cuts the tool is {1e6 * found:.0f} µm off its path after learning, {1e6 * least:.0f} "
            "before: G_R is of another robot, calibrate again; nothing is milled"
        )
    return min(found, least)


def learn_pocket(first: DoneTrial, learner: Learner, method: int, iterations: int) -> Steps:
    """Learn from a trial in material, again and again; back to the best path where one has made it worse.

    Parameters
    ----------
    first : DoneTrial
        Iteration 0.
    learner : Learner
    method : int
    iterations : int

    Raises
    ------
    ValueError : as `Learner.next_path`; force and G_K, of methods that need both, that are not of this robot.
    """
    if method_of(method).is_by_force:
        learner.refuse_other_compliance(first, method)
    back = Lookback(first)
    for iteration in range(1, iterations + 1):
        step = learner.next_path(back.kept, method).part(back.share)
        if step.witnessed == 0.0:
            learner.note(
                f"method-{method}-{iteration}: learning ends: the tracker foresees nothing to be won by what "
                f"{back.kept[-1].name} has shown method {method}"
            )
            return
        trial = first.trial.again(step.sent, True, step.foreseen)
        trial = replace(trial, number=BLOCK * method + first.trial.number + iteration)
        said = back.take((yield f"method-{method}-{iteration}", trial))
        if said:
            learner.note(said)
        if back.is_over:
            return


def learn(first: Trial, learner: Learner, methods: Sequence[int], iterations: int) -> Steps:
    """Learn free space, mill, and learn the pocket by each method from the same first trial.

    Of several methods one that is refused is left out: `Learner.leave_out` is told, and the others are learned by.

    Parameters
    ----------
    first : Trial
    learner : Learner
    methods : sequence of int
    iterations : int

    Raises
    ------
    ValueError : in the air, as `learn_free_space`; as `learn_pocket` where there is one method.
    """
    milled = yield FIRST, (yield from learn_free_space(first, learner))
    for method in methods:
        try:
            yield from learn_pocket(milled, learner, method, iterations)
        except ValueError as fault:
            if len(methods) == 1:
                raise
            learner.leave_out(method, str(fault))


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
    """Return the Euclidean norm of each trial's slow errors, m, as trials are judged by."""
    return [size(each) for each in done]
