"""The coordinates in which a fit steps: elements in parallel, and how the numbers of their parallel form follow."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag

from calibration.prediction_error.element import Element, Steps, balanced, every_step, gain_steps
from calibration.prediction_error.parallel_form import ParallelForm, decomposed, joined

Rule = Callable[[Element], tuple[Element, np.ndarray, Steps]]
"""Chooses an element's basis, x = T (new state), and its steps."""


def free(element: Element) -> tuple[Element, np.ndarray, Steps]:
    """Let everything step that changes what the element does, from balanced states."""
    element, basis = balanced(element)
    return element, basis, every_step(element)


def gain_only(element: Element) -> tuple[Element, np.ndarray, Steps]:
    """Let the Kalman gain step, from the states as they are."""
    return element, np.eye(len(element.a)), gain_steps(element)


@dataclass(frozen=True, eq=False)
class Coordinates:
    """Elements in parallel with a direct path, and the steps around them.

    Parameters
    ----------
    elements : tuple of Element
    steps : tuple of Steps
    direct : array, shape (outputs, direct inputs), any unit
    form : ParallelForm
        The same system.
    bases : tuple of arrays, shape (n, n), 1
        x = T (sections' states), of each element.
    slopes : array, shape (parameters, free), any unit
        How the form's numbers follow a step: the elements' steps, then the direct path's numbers.
    turns : tuple of arrays, shape (free of the element, n, n), 1
        How the sections' states turn with a step.
    """

    elements: tuple[Element, ...]
    steps: tuple[Steps, ...]
    direct: np.ndarray
    form: ParallelForm
    bases: tuple[np.ndarray, ...]
    slopes: np.ndarray
    turns: tuple[np.ndarray, ...]

    def moved(self, step: np.ndarray) -> tuple[list[Element], np.ndarray]:
        """Return elements and direct path after a step.

        Parameters
        ----------
        step : array, shape (free,), any unit
        """
        parts = self._parts(step)
        elements = [e.moved(s, part) for e, s, part in zip(self.elements, self.steps, parts, strict=False)]
        return elements, self.direct + parts[-1].reshape(self.direct.shape)

    def states_moved(self, state: np.ndarray, state_step: np.ndarray, step: np.ndarray) -> list[np.ndarray]:
        """Return the elements' states, each of shape (n,), that a step leaves behind.

        Parameters
        ----------
        state, state_step : arrays, shape (all states,), 1
            Of the sections.
        step : array, shape (free,), any unit
        """
        found, at = [], 0
        for basis, turns, part in zip(self.bases, self.turns, self._parts(step), strict=False):
            here = slice(at, at := at + len(basis))
            turned = state[here] + state_step[here] + np.tensordot(part, turns, 1) @ state[here]
            found.append(basis @ turned)
        return found

    def _parts(self, step: np.ndarray) -> list[np.ndarray]:
        return np.split(step, np.cumsum([len(steps.a) for steps in self.steps]))


def around(
    elements: Sequence[Element], direct: np.ndarray, states: Sequence[Sequence[np.ndarray]], rule: Rule
) -> tuple[Coordinates, list[np.ndarray]]:
    """Lay coordinates around elements; return them and the sections' states, each of shape (all states,).

    Parameters
    ----------
    elements : sequence of Element
    direct : array, shape (outputs, direct inputs), any unit
    states : sequence of sequences of arrays, shape (n,), 1
        Record by record, element by element.
    rule : function
    """
    chosen, bases, steps, forms, slopes, turns = [], [], [], [], [], []
    moved = [list(record) for record in states]
    for number, element in enumerate(elements):
        element, change, free_steps = rule(element)
        form, basis = decomposed(element.a, element.b, element.c, element.first)
        slope, turn = _followed(form, basis, free_steps)
        for record in moved:
            record[number] = np.linalg.solve(change @ basis, record[number])
        chosen.append(element)
        bases.append(basis)
        steps.append(free_steps)
        forms.append(form)
        slopes.append(slope)
        turns.append(turn)
    form = joined(forms, direct)
    together = np.asarray(block_diag(*slopes, np.eye(direct.size)))
    found = Coordinates(tuple(chosen), tuple(steps), direct, form, tuple(bases), together, tuple(turns))
    return found, [np.concatenate([np.zeros(0), *record]) for record in moved]


def _followed(form: ParallelForm, basis: np.ndarray, steps: Steps) -> tuple[np.ndarray, np.ndarray]:
    """Return how a form's numbers follow steps, shape (parameters, free), and how its states turn, (free, n, n).

    To first order: the steps in the sections' basis, then the change of basis I + X that brings the state matrix back
    to the sections' shape.
    """
    a, b, c = np.linalg.solve(basis, steps.a @ basis), np.linalg.solve(basis, steps.b), steps.c @ basis
    table, count = form.sections.table, len(steps.a)
    outputs, order = c.shape[1:]
    turn, slopes = np.zeros((count, order, order)), np.zeros((count, form.sections.parameters))
    blocks = [_section(form, row) for row in range(len(table))]
    for i, (size, at, _, _, p) in enumerate(table):
        here = slice(at, at + size)
        for j, (other, start, *_) in enumerate(table):
            there = slice(start, start + other)
            if i != j:
                turn[:, here, there] = _sylvester(blocks[i][0], blocks[j][0], -a[:, here, there])
        if size == 1:
            slopes[:, p] = a[:, at, at]
        else:
            slopes[:, p], slopes[:, p + 1], turn[:, here, here] = _within(blocks[i][0], a[:, here, here])
    b = b - turn @ np.concatenate([block for _, block, _ in blocks])
    c = c + np.concatenate([block for *_, block in blocks], axis=1) @ turn
    for size, at, first, last, p in table:
        here, middle = slice(at, at + size), p + size * (1 + last - first)
        slopes[:, p + size : middle] = b[:, here].transpose(0, 2, 1).reshape(count, -1)
        slopes[:, middle : middle + size * outputs] = c[:, :, here].reshape(count, -1)
    return slopes.T, turn


def _section(form: ParallelForm, row: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return state, input and output matrix of one section."""
    size, _, first, last, p = form.sections.table[row]
    middle, values = p + size * (1 + last - first), form.values
    a = values[p : p + 1].reshape(1, 1)
    if size == 2:
        a = np.array([[values[p], form.coupling[row]], [-values[p + 1], values[p]]])
    inlet = values[p + size : middle].reshape(-1, size).T
    return a, inlet, values[middle : middle + size * form.sections.outputs].reshape(-1, size)


def _sylvester(left: np.ndarray, right: np.ndarray, target: np.ndarray) -> np.ndarray:
    """Solve left X - X right = target for each of `target`, shape (count, rows, columns)."""
    operator = np.kron(left, np.eye(len(right))) - np.kron(np.eye(len(left)), right.T)
    solved: np.ndarray = np.linalg.solve(operator, target.reshape(len(target), -1).T).T.reshape(target.shape)
    return solved


def _within(block: np.ndarray, step: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return by how much sigma and bend of a section follow steps, shape (count, 2, 2), and its turn, (count, 2, 2)."""
    h, bend = block[0, 1], -block[1, 0]
    turn = np.zeros_like(step)
    turn[:, 1, 0] = (step[:, 1, 1] - step[:, 0, 0]) / (2 * h)
    turn[:, 1, 1] = -step[:, 0, 1] / h
    return (step[:, 0, 0] + step[:, 1, 1]) / 2, bend * step[:, 0, 1] / h - step[:, 1, 0], turn
