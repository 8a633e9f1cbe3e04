"""Whether a response is that of the rig whose model is believed; where it is not, what has been changed about it.

A channel that is turned round, exchanged, silent, too loud or late leaves another trace than a machine that has moved
or a model that is poor: with that one change the same model explains the response again.
"""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import combinations, permutations

import numpy as np
from scipy.optimize import linear_sum_assignment

from vibractl.decibels import FAINT

OFF = 0.5
"""Of an output, rms over its lines and re the smaller of response and prediction: the model does not explain it."""
LEFT = 0.35
"""Part of that, rms over the outputs that are off, which a change may leave for it to be what has happened."""
UNHEARD = 0.6
"""Part of what those outputs have heard that it may leave, unless they are silent; where it takes n unlike sizes of
channels, that over the root of n: so many gains fit to a poor model what no change has done."""
UNLIKE = 1.25
"""Times as large as the next smaller one, from where on a size is another."""
ALIKE = 2.0
"""Two changes of which one leaves not so many times more than the other may both be what has happened."""
FLOOR = 0.1
"""Of the rms prediction, below which a line counts less."""
FEWEST = 10
"""Lines; from fewer, changes cannot be told from each other."""
KIN = 0.8
"""Likeness of what two sensors are to hear, from which they cannot be told from each other."""
LATEST = 0.03
"""s that a channel may be late or early."""
SILENT, SMALLER, LARGER = 0.1, 0.75, 1.33
"""Gains, 1, beyond which a channel is said to be silent or another in size."""
_TINY = np.finfo(float).tiny
MOST_ARRANGED = 4
"""Coils that are tried in every order; of more, two are exchanged."""


@dataclass(frozen=True)
class Change:
    """What explains a response that the model does not.

    Parameters
    ----------
    text : str
        Names the channels; where two changes explain it alike, both.
    off : float, 1
        What the model leaves unexplained of the outputs that are off, rms, re the smaller of response and prediction.
    left : float, 1
        What is left of what they have heard with the change, rms.
    """

    text: str
    off: float
    left: float


@dataclass(frozen=True)
class _Explanation:
    """Which channel each one is, with which gain and how late; `left` is the energy it leaves, by output."""

    kind: str
    source: tuple[int, ...]
    gain: np.ndarray
    late: np.ndarray
    left: np.ndarray


def change_of(response: np.ndarray, drive: np.ndarray, heard: np.ndarray, frequency: np.ndarray) -> Change | None:
    """Return what has been changed about a rig since its model was made, as one response shows it; None for nothing.

    Parameters
    ----------
    response : complex array, shape (lines, outputs, inputs), m/s^2 per V
        G as it is believed.
    drive : complex array, shape (lines, inputs), V s
    heard : complex array, shape (lines, outputs), m/s^2 s
    frequency : array, shape (lines,), Hz
    """
    response, heard, predicted = _weighted(response, drive, heard)
    error, smaller = _mismatch(heard, predicted)
    is_off = error > OFF**2 * smaller
    if len(frequency) < FEWEST or not is_off.any():
        return None
    simple = [*_sensors(predicted, heard), *_coils(response, drive, heard)]
    alike = _alike(simple, _late(predicted, heard, frequency), is_off)
    here, there = (float(_energy(lines)[is_off].sum()) for lines in (heard, predicted))
    off = float(error[is_off].sum()) / max(float(smaller[is_off].sum()), _TINY)
    left = float(alike[0].left[is_off].sum()) / max(here, _TINY)
    unheard = UNHEARD / np.sqrt(max(1, _sizes(alike[0])))
    if left > LEFT**2 * off or (left > unheard**2 and here > SILENT**2 * there):
        return None
    text = ", or: ".join(_simplest(alike))
    return Change(text, float(np.sqrt(off)), float(np.sqrt(left))) if text else None


def mismatch(response: np.ndarray, drive: np.ndarray, heard: np.ndarray) -> float:
    """Return by how much a response is not what G says, 1: of the worst output, re the smaller of both.

    Parameters
    ----------
    response : complex array, shape (lines, outputs, inputs), m/s^2 per V
    drive : complex array, shape (lines, inputs), V s
    heard : complex array, shape (lines, outputs), m/s^2 s
    """
    _, heard, predicted = _weighted(response, drive, heard)
    return difference(predicted, heard)


def difference(before: np.ndarray, heard: np.ndarray) -> float:
    """Return by how much a response is not another, 1: of the worst output, re the smaller of both.

    Parameters
    ----------
    before, heard : complex arrays, shape (lines, outputs), m/s^2 s
    """
    error, smaller = _mismatch(heard, before)
    return float(np.sqrt((error / np.maximum(smaller, _TINY)).max()))


def unexplained(response: np.ndarray, drive: np.ndarray, heard: np.ndarray) -> float:
    """Return what G leaves unexplained of a response, 1, rms over lines and outputs, of what is heard.

    Parameters
    ----------
    response : complex array, shape (lines, outputs, inputs), m/s^2 per V
    drive : complex array, shape (lines, inputs), V s
    heard : complex array, shape (lines, outputs), m/s^2 s
    """
    left = heard - (response @ drive[..., None])[..., 0]
    return float(np.linalg.norm(left) / max(float(np.linalg.norm(heard)), FAINT))


def _alike(simple: list[_Explanation], late: _Explanation, is_off: np.ndarray) -> list[_Explanation]:
    """Return what explains the outputs (outputs,) that are off best, and what does so alike, the best first."""

    def left(each: _Explanation) -> float:
        return float(each.left[is_off].sum())

    least = min(map(left, simple))
    if left(late) * ALIKE**2 < least:
        return [late]
    return sorted((each for each in simple if left(each) <= ALIKE**2 * least), key=left)


def _weighted(response: np.ndarray, drive: np.ndarray, heard: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return G, what is heard and what is predicted, each line by its weight."""
    predicted = (response @ drive[..., None])[..., 0]
    weight = _weight(predicted)
    return weight[..., None] * response, weight * heard, weight * predicted


def _mismatch(heard: np.ndarray, predicted: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the energies of each output's error, and of the smaller of what is heard and predicted: (outputs,)."""
    return _energy(heard - predicted), np.minimum(_energy(predicted), _energy(heard))


def _weight(predicted: np.ndarray) -> np.ndarray:
    """Return weights (lines, 1) by which resonances, where a model is worst, count no more than other lines."""
    energy = (np.abs(predicted) ** 2).sum(axis=1, keepdims=True)
    weight: np.ndarray = 1 / np.sqrt(np.maximum(energy, max(FLOOR**2 * energy.mean(), _TINY)))
    return weight


def _energy(lines: np.ndarray) -> np.ndarray:
    """Return the energy of each channel of lines (lines, channels)."""
    energy: np.ndarray = (np.abs(lines) ** 2).sum(axis=0)
    return energy


def _sensors(predicted: np.ndarray, heard: np.ndarray) -> Iterator[_Explanation]:
    """Explain by the sensors' gains, each in its place; and by which is which as well where they hear unlike things."""
    cross = (predicted.conj().T @ heard).real.T
    late = np.zeros(cross.shape)
    yield _assigned(cross, predicted, heard, late, np.arange(len(cross)))
    size = np.maximum(np.sqrt(_energy(predicted)), _TINY)
    same = np.abs(predicted.conj().T @ predicted) / size / size[:, None]
    if np.all(same <= KIN + np.eye(len(same))):
        yield _assigned(cross, predicted, heard, late)


def _late(predicted: np.ndarray, heard: np.ndarray, frequency: np.ndarray) -> _Explanation:
    """Explain by the sensors' gains and by how late each is."""
    finest = 1 / (64 * frequency.max())
    late = finest * np.arange(-int(LATEST / finest), int(LATEST / finest) + 1)
    turn = np.exp(2j * np.pi * frequency[:, None] * late)
    every = np.einsum("fk,fk,ft->kt", predicted.conj(), heard, turn, optimize=True).real
    best = np.abs(every).argmax(axis=-1)
    rows = np.arange(len(every))
    return _assigned(np.diag(every[rows, best]), predicted, heard, np.diag(late[best]), rows)


def _assigned(
    cross: np.ndarray, predicted: np.ndarray, heard: np.ndarray, late: np.ndarray, source: np.ndarray | None = None
) -> _Explanation:
    """Give each output (rows) a predicted one (columns): that of which it has most, where `source` does not say."""
    size = np.maximum(_energy(predicted), _TINY)
    explained, rows = cross**2 / size, np.arange(len(cross))
    columns = linear_sum_assignment(-explained)[1] if source is None else source
    left = np.maximum(_energy(heard) - explained[rows, columns], 0.0)  # rounding
    gain = cross[rows, columns] / size[columns]
    return _Explanation("response", tuple(map(int, columns)), gain, late[rows, columns], left)


def _coils(response: np.ndarray, drive: np.ndarray, heard: np.ndarray) -> Iterator[_Explanation]:
    """Explain by the coils' gains, each in its place; and by which coil is which as well."""
    every = [_ordered(response, drive, heard, order) for order in _orders(drive.shape[1])]
    yield every[0]
    yield min(every, key=lambda each: float(each.left.sum()))


def _ordered(response: np.ndarray, drive: np.ndarray, heard: np.ndarray, order: tuple[int, ...]) -> _Explanation:
    inputs = len(order)
    parts, wanted = (response * drive[:, None, order]).reshape(-1, inputs), heard.reshape(-1)
    gain = np.linalg.lstsq((parts.conj().T @ parts).real, (parts.conj().T @ wanted).real)[0]
    left = _energy(heard - (response @ (gain * drive[:, order])[..., None])[..., 0])
    return _Explanation("drive", order, gain, np.zeros(inputs), left)


def _orders(inputs: int) -> Iterator[tuple[int, ...]]:
    """Yield the orders of coils that are tried, as they are first."""
    if inputs <= MOST_ARRANGED:
        yield from permutations(range(inputs))
        return
    yield tuple(range(inputs))
    for one, other in combinations(range(inputs), 2):
        order = list(range(inputs))
        order[one], order[other] = other, one
        yield tuple(order)


def _simplest(alike: Iterable[_Explanation]) -> list[str]:
    """Return what those say that say least, each once."""
    texts = {text: len(re.split("[;,]", text)) for each in alike if (text := _told(each))}
    return [text for text, parts in texts.items() if parts == min(texts.values())]


def _sizes(found: _Explanation) -> int:
    """Return how many unlike sizes of channels it takes."""
    sizes = np.sort([size for size in np.abs(found.gain) if size >= SILENT and not SMALLER <= size <= LARGER])
    return int(np.sum(sizes[1:] > UNLIKE * sizes[:-1])) + 1 if len(sizes) else 0


def _told(found: _Explanation) -> str:
    """Say what is not as it was, channel by channel; empty where all is."""
    every = [", ".join(_told_of(found, number)) for number in range(len(found.source))]
    if len(every) > 1 and every[0] and len(set(every)) == 1:
        return f"every {found.kind} {every[0]}"
    return "; ".join(f"{found.kind} {number} {text}" for number, text in enumerate(every, start=1) if text)


def _told_of(found: _Explanation, number: int) -> Iterator[str]:
    gain, late = float(found.gain[number]), float(found.late[number])
    if abs(gain) < SILENT:
        yield "is silent"
        return
    if found.source[number] != number:
        yield f"is where {found.kind} {found.source[number] + 1} was"
    if gain < 0:
        yield "is turned round (its polarity)"
    if not SMALLER <= abs(gain) <= LARGER:
        yield f"is {abs(gain):.2g} times as large"
    if late:
        yield f"comes {abs(1e3 * late):.1f} ms {'late' if late > 0 else 'early'}"
