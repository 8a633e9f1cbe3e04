"""Dead time: how many samples pass until an output hears of an input, and models that have it as states."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve

from calibration.state_space.model import InnovationModel
from calibration.subspace.lagged import OWN, SAMPLES, lagged

LONGEST = 100
"""Lags of the inputs, at most, that each output is explained by at once."""
FARTHEST, PART = 2000, 2
"""Lags at which an input is looked for, at most, and of which part of the shortest record."""
ROWS = 20
"""Samples that are wanted for each coefficient."""
HEARD = 5.0
"""Standard errors beyond which a coefficient is no chance: one in a million."""
LEAST = 3
"""Samples below which a delay is left to the states of the model."""


@dataclass(frozen=True)
class Delays:
    """How long each output takes to hear of each input.

    Parameters
    ----------
    samples : array of int, shape (p, m)
        -1 where it never does within the lags that were looked at.
    certainty : array, shape (p, m), 1
        The coefficient there over its standard error; the largest one where none is beyond `HEARD`.
    reach : int, samples
        The longest lag that was looked at.
    """

    samples: np.ndarray
    certainty: np.ndarray
    reach: int

    @property
    def unheard(self) -> tuple[str, ...]:
        """Say of which inputs no output hears."""
        silent = np.flatnonzero(np.all(self.samples < 0, axis=0))
        return tuple(
            f"no output hears of input {number + 1} within {self.reach} samples: what is identified of it is noise, or "
            "it comes later than that"
            for number in silent
        )

    @property
    def of_inputs(self) -> tuple[int, ...]:
        """Samples by which each input comes late at all outputs; 0 where that is too little, or nobody hears it."""
        heard = np.where(self.samples < 0, np.iinfo(int).max, self.samples).min(axis=0)
        known: np.ndarray = np.any(self.samples >= 0, axis=0)
        return tuple(
            int(late) if is_known and late >= LEAST else 0 for late, is_known in zip(heard, known, strict=True)
        )


def delays(drives: Sequence[np.ndarray], responses: Sequence[np.ndarray]) -> Delays | None:
    """Find the first lag of each input that tells something of each output, beside all other lags.

    Each output by itself is explained by its past and that of the others, which takes the colour of the noise away, and
    by the inputs' lags from 0 on.  Of an input that no output hears of so soon, later lags are looked at in its place.
    None where records are too short, or inputs too poor, to tell lags apart.

    Parameters
    ----------
    drives : sequence of arrays, each of shape (N, m), any unit
        Without their mean.
    responses : sequence of arrays, each of shape (N, p), any unit

    Source
    ------
    Ljung 1999, System Identification, 2nd ed., sections 4.2 and 16.4 (delays from ARX models).
    """
    inputs, outputs = drives[0].shape[1], responses[0].shape[1]
    if not inputs:
        return None
    total = min(SAMPLES, sum(len(drive) for drive in drives))
    lags = min(LONGEST, (total // ROWS - OWN * outputs) // inputs - 1)
    if lags < 2 * LEAST or (told := _told(drives, responses, lags)) is None:
        return None
    found = _first(told, 0)
    farthest = min(FARTHEST, min(len(drive) for drive in drives) // PART - lags)
    reach = lags
    for late in range(lags + 1, farthest + 1, lags + 1):
        unheard = ~np.any(found.samples >= 0, axis=0)
        if not unheard.any() or (told := _told(*advanced(drives, responses, late * unheard), lags)) is None:
            break
        further, reach = _first(told, late), late + lags
        samples = np.where(unheard, further.samples, found.samples)
        found = Delays(samples, np.where(unheard, further.certainty, found.certainty), lags)
    return replace(found, reach=reach)


def _told(drives: Sequence[np.ndarray], responses: Sequence[np.ndarray], lags: int) -> np.ndarray | None:
    """Return each lag's coefficient over its standard error, (p, m, lags + 1); none where lags cannot be told apart."""
    inputs, outputs = drives[0].shape[1], responses[0].shape[1]
    regressors, wanted, _ = lagged(drives, responses, lags)
    products = regressors.T @ regressors
    scale = np.sqrt(np.diag(products))
    if len(regressors) < 2 * len(products) or not np.all(scale > 0):
        return None
    try:
        factor = cho_factor(products / np.outer(scale, scale))
    except LinAlgError:
        return None
    found = cho_solve(factor, regressors.T @ wanted / scale[:, None])
    inverse = np.diag(cho_solve(factor, np.eye(len(products))))
    left = wanted - (regressors / scale) @ found
    size = np.sqrt(np.mean(left**2, axis=0) * len(left) / (len(left) - len(products)))
    sure = np.abs(found) / (np.sqrt(np.maximum(inverse, 0.0))[:, None] * size)
    return np.asarray(sure[OWN * outputs :].reshape(lags + 1, inputs, outputs).transpose(2, 1, 0))


def _first(told: np.ndarray, late: int) -> Delays:
    """Return the first lags that are no chance, of inputs that come so late."""
    first = np.argmax(told > HEARD, axis=2)
    is_heard = (told > HEARD).any(axis=2)
    certainty = np.where(is_heard, np.take_along_axis(told, first[..., None], axis=2)[..., 0], told.max(axis=2))
    return Delays(np.where(is_heard, late + first, -1), certainty, told.shape[2] - 1)


def advanced(
    drives: Sequence[np.ndarray], responses: Sequence[np.ndarray], late: Sequence[int]
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Return records in which every output hears of the inputs at once: inputs moved, both cut at the beginning.

    Parameters
    ----------
    drives : sequence of arrays, each of shape (N, m), any unit
    responses : sequence of arrays, each of shape (N, p), any unit
    late : sequence of int, samples
        By which each input comes late, fewer than any record has samples.
    """
    longest = max(late, default=0)
    if not longest:
        return list(drives), list(responses)
    moved = [
        np.stack([drive[longest - each : len(drive) - each, channel] for channel, each in enumerate(late)], axis=1)
        for drive in drives
    ]
    return moved, [response[longest:] for response in responses]


def held_back(drive: np.ndarray, late: Sequence[int]) -> np.ndarray:
    """Return inputs as they are heard, zero before anything is, shape (N, m), their units.

    Parameters
    ----------
    drive : array, shape (N, m), any unit
    late : sequence of int, samples
    """
    heard = np.zeros(drive.shape)
    for channel, each in enumerate(late):
        heard[each:, channel] = drive[: len(drive) - each, channel]
    return heard


def delayed(model: InnovationModel, late: Sequence[int]) -> InnovationModel:
    """Return a model whose inputs come late: as many states more as there are samples of delay, that hold them.

    Parameters
    ----------
    model : InnovationModel
    late : sequence of int, samples
        For each input.
    """
    if not any(late):
        return model
    order, held = model.order, sum(late)
    transition, inlet = np.zeros((order + held, order + held)), np.zeros((order + held, model.inputs))
    outlet, direct = np.zeros((model.outputs, order + held)), np.zeros((model.outputs, model.inputs))
    transition[:order, :order], outlet[:, :order] = model.A, model.C
    first = order
    for channel, each in enumerate(late):
        if not each:
            inlet[:order, channel], direct[:, channel] = model.B[:, channel], model.D[:, channel]
            continue
        inlet[first, channel] = 1.0
        transition[first + 1 : first + each, first : first + each - 1] = np.eye(each - 1)
        last = first + each - 1
        transition[:order, last], outlet[:, last] = model.B[:, channel], model.D[:, channel]
        first += each
    gain = np.concatenate([model.K, np.zeros((held, model.outputs))])
    return replace(model, A=transition, B=inlet, C=outlet, D=direct, K=gain)
