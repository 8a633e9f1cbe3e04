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
"""Lags at which an input is looked for, at most, and of which part of the longest record."""
ROWS = 20
"""Samples that are wanted for each coefficient."""
EDGE = 0.5
"""Part of the lags that are looked at beyond which the first one may stand for later ones."""
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
    is_heard : array of bool, shape (m,)
        Whether some output hears of an input at all, by all lags together.
    """

    samples: np.ndarray
    certainty: np.ndarray
    reach: int
    is_heard: np.ndarray

    @property
    def unheard(self) -> tuple[str, ...]:
        """Say of which inputs no output hears."""
        silent = np.flatnonzero(np.all(self.samples < 0, axis=0) & ~self.is_heard)
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
    What is heard first at the end of what was looked at may come later, of inputs that change slowly: then lags about
    it are looked at.  None where records are too short, or inputs too poor, to tell lags apart.

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
    late = np.zeros(inputs, int)
    if lags < 2 * LEAST or (told := _heard(drives, responses, lags, late)) is None:
        return None
    found, reach, settled = told, lags, np.zeros(inputs, bool)
    farthest = min(FARTHEST, max(len(drive) for drive in drives) // PART) - lags
    while True:
        first = np.where(found.samples < 0, np.iinfo(int).max, found.samples).min(axis=0)
        silent = np.all(found.samples < 0, axis=0)
        at_end = ~silent & ~settled & (first > late + EDGE * lags)
        further = late + np.where(silent, lags + 1, np.where(at_end, lags // 2, 0))
        further = np.where(further <= farthest, further, late)
        if np.array_equal(further, late) or (told := _heard(drives, responses, lags, further)) is None:
            return replace(found, reach=reach)
        settled |= at_end & np.all(told.samples < 0, axis=0)  # it was heard there after all
        moved = (further > late) & ~settled
        found = Delays(
            np.where(moved, told.samples, found.samples),
            np.where(moved, told.certainty, found.certainty),
            lags,
            found.is_heard | told.is_heard,
        )
        late, reach = np.where(moved, further, late), max(reach, int(further.max()) + lags)


def _heard(drives: Sequence[np.ndarray], responses: Sequence[np.ndarray], lags: int, late: np.ndarray) -> Delays | None:
    """Look at so many lags of each input, from one of each on; none where they cannot be told apart."""
    inputs, outputs = drives[0].shape[1], responses[0].shape[1]
    long = [number for number, drive in enumerate(drives) if len(drive) > late.max() + lags]
    if not long:
        return None
    moved = advanced([drives[number] for number in long], [responses[number] for number in long], late.tolist())
    regressors, wanted, _ = lagged(*moved, lags)
    products = regressors.T @ regressors
    scale = np.sqrt(np.diag(products))
    if len(regressors) < 2 * len(products) or not np.all(scale > 0):
        return None
    try:
        factor = cho_factor(products / np.outer(scale, scale))
    except LinAlgError:
        return None
    found = cho_solve(factor, regressors.T @ wanted / scale[:, None])
    inverse = cho_solve(factor, np.eye(len(products)))
    left = wanted - (regressors / scale) @ found
    size = np.sqrt(np.mean(left**2, axis=0) * len(left) / (len(left) - len(products)))
    sure = np.abs(found) / (np.sqrt(np.maximum(np.diag(inverse), 0.0))[:, None] * size)
    told = sure[OWN * outputs :].reshape(lags + 1, inputs, outputs).transpose(2, 1, 0)
    first = np.argmax(told > HEARD, axis=2)
    is_heard = (told > HEARD).any(axis=2)
    certainty = np.where(is_heard, np.take_along_axis(told, first[..., None], axis=2)[..., 0], told.max(axis=2))
    samples = np.where(is_heard, late + first, -1)
    return Delays(samples, certainty, lags, _at_all(found, inverse, size, lags, inputs))


def _at_all(found: np.ndarray, inverse: np.ndarray, size: np.ndarray, lags: int, inputs: int) -> np.ndarray:
    """Say of which inputs some output hears at lags of which no one by itself is sure: by all together, (inputs,)."""
    own, count = len(found) - (lags + 1) * inputs, lags + 1
    heard = np.zeros(inputs, bool)
    for channel in range(inputs):
        at = own + np.arange(count) * inputs + channel
        power = np.sum(found[at] * np.linalg.lstsq(inverse[np.ix_(at, at)], found[at], rcond=1e-12)[0], axis=0)
        heard[channel] = np.any(power / np.maximum(size, 1e-300) ** 2 > count + HEARD * np.sqrt(2 * count) + HEARD**2)
    return heard


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
