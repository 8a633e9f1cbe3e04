"""What the page draws of trials: errors of each iteration, the path, the error along it, and the force on the tool."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from rigkit.experiment.strips import TIME, thinned
from rigkit.service.show import Axis, Curves, Panel, Table, Trace
from stagectl.devices.signals import AXES
from stagectl.experiments.trials.campaign import FIRST, grouped
from stagectl.experiments.trials.done import DoneTrial
from stagectl.experiments.trials.report import ACCURACY, HEAD, figures, trial_rows
from stagectl.experiments.trials.signals import rest, torque_log
from stagectl.experiments.trials.tool_path import RATE
from stagectl.robot.milling.torque_file import read_force_model

MAGNIFIED = 10.0
"""Times by which errors are drawn beside the path."""


def panels(trials: Sequence[DoneTrial], model: Path) -> dict[str, Panel]:
    """Draw the last trial, and what there is of all, by the panels' names.

    Parameters
    ----------
    trials : sequence of DoneTrial
        That came to their end, in the order of their numbers; one at least.
    model : Path
        File of the milling models: where it knows the motors' torques, the force that they tell is drawn as well.
    """
    (free, learned), done = grouped(trials), trials[-1]
    found: dict[str, Panel] = {"path": path(done), "error": along(done)}
    found["trials"] = Table("Trials", HEAD, tuple(trial_rows(figures(free, learned))))
    if free:
        found["free_space"] = errors("Free space", dict(enumerate(free)))
    if done.trial.is_milled:
        first = next((each for each in trials if each.name == FIRST), None)
        found["convergence"] = convergence(learned, first)
        found |= _forces(done, free, model)
    return found


def _forces(done: DoneTrial, free: Sequence[DoneTrial], model: Path) -> Iterator[tuple[str, Curves]]:
    """Draw the force on the tool along each axis: by the sensor, and where it can be by the motors' torques."""
    sensed = done.signals.force
    assert sensed is not None
    estimated = _estimated(done, free, model)
    for axis, name in enumerate(AXES):
        columns = (np.arange(len(sensed)) / RATE, sensed[:, axis], *(each[:, axis] for each in estimated))
        time, force, *motors = thinned(*columns)
        traces = [Trace("sensor", time, force)]
        if motors:
            traces.append(Trace("motors' torques", time, motors[0], low=motors[1], high=motors[2]))
        title = f"Force on the tool along {name}, {done.name}"
        yield f"cutting_force_{name}", Curves(title, TIME, Axis("force", "N"), tuple(traces))


def _estimated(done: DoneTrial, free: Sequence[DoneTrial], model: Path) -> tuple[np.ndarray, ...]:
    """Return force, low and high by the motors' torques, (N, 3), N, less those in the air; nothing without a model.

    Where nothing is determined the interval goes as far as a force of either sign can that the sensor can show.
    """
    cell = done.trial.cell
    try:
        known = read_force_model(model, done.trial.arm, cell.force_estimate)
    except ValueError:
        return ()
    told, *air = (known.estimate(*torque_log(each.trial, each.records), RATE) for each in (done, *free))
    bare = np.mean([each.force for each in air], axis=0)
    bare = bare + np.nanmean((told.force - bare)[rest(done.trial)], axis=0)
    most = np.array(cell.force_sensor.range_force)
    low, high = (np.clip(each - bare, -most, most) for each in (told.low, told.high))
    return told.force - bare, np.where(np.isnan(low), -most, low), np.where(np.isnan(high), most, high)


def convergence(learned: dict[int, list[DoneTrial]], first: DoneTrial | None) -> Curves:
    """Draw the mean absolute errors of each iteration: along each axis for one method, their norm for several.

    Parameters
    ----------
    learned : dict of int to list of DoneTrial
        By method, iteration 0 first; empty before the first iteration.
    first : DoneTrial or None
        Iteration 0.
    """
    shown = learned or ({0: [first]} if first else {})
    if len(shown) == 1:
        return errors("Errors of each iteration", dict(enumerate(next(iter(shown.values())))))
    longest = max(map(len, shown.values()), default=1)
    traces = tuple(
        Trace(f"method {method}", np.arange(len(done)), np.array([float(np.linalg.norm(each.mae)) for each in done]))
        for method, done in shown.items()
    )
    return _over_trials("Errors of each iteration, norm", (*traces, _accuracy(0, longest - 1)))


def errors(title: str, done: dict[int, DoneTrial]) -> Curves:
    """Draw the mean absolute errors of trials along each axis, as the tracker saw them, and their norm."""
    number, sizes = np.array(list(done)), np.array([each.mae for each in done.values()])
    columns = (*sizes.T, np.linalg.norm(sizes, axis=1))
    traces = (Trace(name, number, each) for name, each in zip((*AXES, "norm"), columns, strict=True))
    return _over_trials(title, (*traces, _accuracy(int(number[0]), int(number[-1]))))


def _accuracy(first: int, last: int) -> Trace:
    return Trace("tracker's accuracy", np.array([first, max(last, first + 1)]), np.full(2, ACCURACY), "reference")


def _over_trials(title: str, traces: tuple[Trace, ...]) -> Curves:
    return Curves(title, Axis("trial", "1"), Axis("mean absolute error", "m"), traces)


def path(done: DoneTrial) -> Curves:
    """Draw the path wanted, and where the tracker saw the tool with the error magnified, in the pocket's walls."""
    wanted, pocket = done.trial.path.wanted, done.trial.path.pocket
    counted = done.trial.path.milled
    seen = wanted - MAGNIFIED * done.error
    across, along = (0.5 * side for side in pocket.size)
    walls = Trace("walls", across * np.array([-1, 1, 1, -1, -1]), along * np.array([-1, -1, 1, 1, -1]), "reference")
    x, y, seen_x, seen_y = thinned(*wanted[counted, :2].T, *seen[counted, :2].T)
    lines = Trace("desired", x, y, "reference"), Trace(f"measured, error times {MAGNIFIED:g}", seen_x, seen_y)
    return Curves(f"Path, {done.name}", Axis("x", "m"), Axis("y", "m"), (walls, *lines))


def along(done: DoneTrial) -> Curves:
    """Draw the error along the path, as the tracker saw it."""
    time, *columns = thinned(np.arange(len(done.error)) / RATE, *done.error.T)
    traces = tuple(Trace(name, time, each) for name, each in zip(AXES, columns, strict=True))
    return Curves(f"Error along the path, {done.name}", TIME, Axis("error", "m"), traces)
